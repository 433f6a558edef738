"""Baking from the panel, preferences and the cache, in Blender; what is told of materials beyond their tables."""
import contextlib
import time
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pytest
from blender_help.materials import make

pytestmark = [pytest.mark.blender, pytest.mark.versions]

from blender_help.recorder import Recorder, context_for, drawn, operators, texts

from addon.brdf import MODELS
from addon.forms.albedo import bake, sizes, tables

SHORT = {"resolution": "draft", "highest": 4.0}


@pytest.fixture
def bpy():
    import bpy

    import addon

    addon.register()
    yield bpy
    for material in list(bpy.data.materials):
        bpy.data.materials.remove(material)
    addon.unregister()


@pytest.fixture
def folder(bpy, table_folder):
    """A folder with copies of the shipped tables, in use."""
    for table in tables.TABLES.values():
        (table_folder / table.path.name).write_bytes((tables.PACKAGED / table.path.name).read_bytes())
    tables.forget()
    return table_folder


@pytest.fixture
def quick(monkeypatch):
    """Bakes of rows that cost nothing: those of the shipped table, or 0.5."""
    monkeypatch.setattr(bake, "bake_row", lambda job: np.full((job[0].columns.columns, 4), 0.5))
    monkeypatch.setattr(bake, "measure_row", lambda job: 2.5e-3)


@contextlib.contextmanager
def in_folder(folder, monkeypatch):
    """The bake's folder stays the test's own: without an extension there is no other."""
    from addon.blender.host import table_folder

    monkeypatch.setattr(table_folder, "choose_folder", lambda: tables.use_folder(folder))
    yield


# Bakes


def test_a_bake_of_one_model_at_a_range(folder, monkeypatch, quick, capfd):
    import bpy

    from addon.blender.host import table_job

    others = {path.name: path.read_bytes() for path in folder.iterdir() if not path.name.startswith("phong")}
    with in_folder(folder, monkeypatch):
        assert bpy.ops.plausible.bake_luts(models={"pumped_phong"}, **SHORT) == {"FINISHED"}
    assert table_job.job.names == ["phong_plain", "phong_controlled"]
    for name in table_job.job.names:
        table = tables.in_use(name)
        assert table == sizes.sized(tables.TABLES[name], sizes.Size("draft", 1.0, 4.0))
    assert all((folder / name).read_bytes() == data for name, data in others.items())
    said = capfd.readouterr().out
    assert "within 0.25 % between nodes" in said and "Drafts are inexact" in said and "Update Materials" in said


@pytest.mark.parametrize("given, words", [
    ({"models": set()}, "No model is chosen"),
    ({"lowest": 30.0, "highest": 40.0}, "range: 30 .. 40 is not allowed"),
])
def test_what_cannot_be_baked_is_said(folder, given, words):
    import bpy

    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    for operator in (bpy.ops.plausible.bake_luts, bpy.ops.plausible.choose_bake):
        with pytest.raises(RuntimeError, match=words):
            operator(**given)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_full_disk_is_said_in_words(folder, monkeypatch, quick):
    import bpy

    def full(self, target):
        raise OSError(28, "No space left on device", str(self))

    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    with in_folder(folder, monkeypatch):
        monkeypatch.setattr("pathlib.Path.replace", full)
        with pytest.raises(RuntimeError, match="bake failed: .*No space left on device. Tables that were not complete"):
            bpy.ops.plausible.bake_luts(models={"pumped_phong"})
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_read_only_folder_is_said_in_words(folder, monkeypatch):
    import os

    import bpy

    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with in_folder(folder, monkeypatch), pytest.raises(RuntimeError, match="read-only; choose another"):
        bpy.ops.plausible.bake_luts(models={"pumped_phong"})


def test_escape_cancels_and_leaves_every_table(folder, monkeypatch):
    """The modal operator's own steps, with a window manager that keeps what it is given."""
    from addon.blender.host import table_folder, table_job
    from addon.blender.ui.operators import table_bake

    texts_set, before = [], {path.name: path.read_bytes() for path in folder.iterdir()}
    monkeypatch.setattr(table_folder, "choose_folder", lambda: tables.use_folder(folder))
    manager = SimpleNamespace(event_timer_add=lambda *a, **k: "timer", event_timer_remove=texts_set.append,
                              progress_begin=lambda *a: None, progress_update=lambda share: None,
                              progress_end=lambda: texts_set.append("end"), modal_handler_add=lambda op: None,
                              windows=[])
    context = SimpleNamespace(window_manager=manager, window=None,
                              workspace=SimpleNamespace(status_text_set=texts_set.append))
    cls = table_bake.PLAUSIBLE_OT_bake_luts
    reports = []
    names = ("_start", "_leave", "_end", "chosen")
    operator = SimpleNamespace(models={"pumped_blinn"}, resolution="standard", lowest=1.0, highest=1e5,
                               report=lambda kind, text: reports.append(text))
    for name in names:
        setattr(operator, name, getattr(cls, name).__get__(operator))
    assert cls.invoke(operator, context, None) == {"RUNNING_MODAL"}
    tick, escape = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")
    while table_job.job.done < 2:
        time.sleep(0.01)
    assert cls.modal(operator, context, tick) == {"PASS_THROUGH"}
    assert "Baking blinn plain" in texts_set[-1] and "Esc: cancel" in texts_set[-1]
    assert cls.modal(operator, context, escape) == {"RUNNING_MODAL"}, "nobody else sees this Escape"
    table_job.job.wait()
    assert cls.modal(operator, context, tick) == {"CANCELLED"}
    assert texts_set[-3:] == ["timer", "end", None] and "cancelled" in reports[-1]
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_the_dialog_states_cost_and_error(bpy):
    from addon.blender.ui.operators import table_bake

    def told(**given):
        choice = SimpleNamespace(**{"models": {"pumped_phong"}, "resolution": "standard", "lowest": 1.0, "highest": 1e5,
                                    **given})
        choice.chosen = lambda: table_bake._Choice.chosen(choice)
        return " ".join(text for text, _ in table_bake.cost_texts(choice))

    assert "2 tables, 387 KB" in told() and "Albedos within 0.1 %" in told() and "striped" not in told()
    assert "Inexact: albedos within 0.5 %" in told(resolution="draft") and "2 tables, 97 KB" in told(resolution="draft")
    assert "beyond 1 to 1000 render striped" in told(highest=1000.0)
    assert "No model is chosen" in told(models=set()) and "30 .. 40" in told(lowest=30.0, highest=40.0)


def test_the_dialog_draws(bpy):
    from addon.blender.ui.operators import table_bake

    log = []
    rna = bpy.ops.plausible.choose_bake.get_rna_type()
    choice = SimpleNamespace(layout=Recorder(log), bl_rna=rna, models={"pumped_phong"}, resolution="draft", lowest=1.0,
                             highest=1e5)
    choice.chosen = lambda: table_bake._Choice.chosen(choice)
    table_bake.PLAUSIBLE_OT_choose_bake.draw(choice, context_for(bpy))
    assert [given["property"] for kind, given in log if kind == "prop"] == ["models", "resolution", "lowest", "highest"]
    assert {item.identifier for item in rna.properties["models"].enum_items} == {m.id for m in sizes.readers()}


def test_the_panel_tells_what_the_tables_are(folder, monkeypatch, quick):
    import bpy

    context = context_for(bpy, make("pumped_phong"))
    assert "Phong plain: Standard, 144 × 64, exponents 1 to 100000, within 0.047 %" in texts(drawn(context))
    with in_folder(folder, monkeypatch):
        bpy.ops.plausible.bake_luts(models={"pumped_phong"}, **SHORT)
    log = drawn(context)
    assert "Phong plain: Draft, 72 × 32, exponents 1 to 4, within 0.25 %" in texts(log)
    assert "Blinn plain" not in texts(log), "the material's model reads no other"


# Materials beyond their tables


@lru_cache(maxsize=1)
def short_nodes(table):
    return np.stack([bake.bake_row((table, row)) for row in range(table.height)])


@pytest.fixture
def short(folder):
    """Phong's plain table for exponents from 1 to 60, as it is baked."""
    size = sizes.Size("draft", 1.0, 60.0)
    table = sizes.sized(tables.TABLES["phong_plain"], size)
    bake._write(table.path, table, short_nodes(table), 1e-3, size)
    tables.forget()
    return table


def test_a_material_beyond_its_tables_is_told(short):
    import bpy

    before = len(bpy.data.materials)
    with pytest.raises(tables.TableError, match="exponent: 61 is outside 1 .. 60"):
        make("pumped_phong", exponent=61.0, control=False)
    assert len(bpy.data.materials) == before, "no half material"
    material = make("pumped_phong", exponent=20.0, control=False)
    assert "beyond" not in texts(drawn(context_for(bpy, material)))
    material.plausible_brdf.exponent = 500.0
    log = drawn(context_for(bpy, material))
    assert "Exponent 500 is beyond the material's tables, which are for 1 to 60" in texts(log)
    assert operators(log).count("plausible.choose_bake") == 2
    for given in ({"control": True}, {"control": False, "pumps": 0.0}):  # another table, and none
        other = make("pumped_phong", exponent=20.0, **given)
        other.plausible_brdf.exponent = 500.0
        assert "beyond" not in texts(drawn(context_for(bpy, other)))
    # Tables that reach further mend it once they are compiled in.
    short.path.write_bytes((tables.PACKAGED / short.path.name).read_bytes())
    tables.forget()
    log = drawn(context_for(bpy, material))
    assert "beyond" in texts(log) and operators(log).count("plausible.update_materials") == 2
    bpy.ops.plausible.update_materials()
    assert "beyond" not in texts(drawn(context_for(bpy, material)))


@pytest.mark.parametrize("lut", ["compiled", "file"])
def test_a_short_table_renders_its_albedo_and_stripes_beyond(short, lut, capfd):
    """In the furnace at 60 degrees: inside the range and at its ends as the formula says; beyond no albedo at all."""
    from addon.blender.material import groups, materials
    from addon.measure import scene

    model = MODELS["pumped_phong"]
    material = make("pumped_phong", lut=lut, exponent=20.0, pumps=2.0, control=False)
    node = groups.find_node(material)
    with scene.MeasuringScene(material, scene.PLANE, 16) as place:
        place.sky(1.0)
        place.look_from((np.sin(np.radians(60.0)), 0.0, 0.5))
        for exponent in (1.0, 20.0, 60.0):
            materials.set_value(node, model.parameter("exponent"), exponent)
            shown = place.render(256).reshape(-1, 3)[:, 0]
            truth = model.albedo([0.5], exponent=exponent, pumps=2.0, control=False)[0]
            assert shown.mean() == pytest.approx(truth, abs=3e-3 + 4.0 * shown.std() / 16.0)
        capfd.readouterr()
        materials.set_value(node, model.parameter("exponent"), 70.0)
        pixels = place.render(1).reshape(-1, 3)
    assert not pixels[:, 1].any() and np.array_equal(pixels[:, 0], pixels[:, 2]) and pixels[:, 0].any()
    assert "not baked for this exponent" in capfd.readouterr().err


# Cache


def test_a_baked_model_is_baked_once(bpy, monkeypatch):
    from addon.blender.backend import osl
    from addon.blender.host import row_cache
    from addon.blender.material import baked_state, groups
    from addon.forms.rows import error as rows_error
    from addon.forms.rows import row_bake

    calls, blank = [], row_bake.blank
    monkeypatch.setattr(row_cache, "_memory", {})
    monkeypatch.setattr(row_bake, "bake", lambda model, p: calls.append("weights") or blank(model, p))
    known = rows_error.RowsError(np.zeros(1), np.array([0.012]), np.array([-0.001]))
    monkeypatch.setattr(rows_error, "error", lambda model, p: calls.append("error") or known)
    first = make("ward", roughness_u=0.2)
    second = make("ward", roughness_u=0.2)
    assert calls == ["weights", "error"]
    assert osl.Osl().program(MODELS["ward"], {"roughness_u": 0.2, "samples": 7}) and len(calls) == 2
    make("ward", roughness_u=0.21)
    assert calls == ["weights", "error"] * 2
    ours = [groups.find_node(material) for material in (first, second)]
    assert ours[0].node_tree != ours[1].node_tree and baked_state.baked_error(ours[1]) == (0.012, 0.001)


def test_memory_keeps_the_last_few(bpy, monkeypatch):
    from addon.blender.host import row_cache

    monkeypatch.setattr(row_cache, "_memory", {})
    for i in range(row_cache._IN_MEMORY):
        assert row_cache.fetch(f"{i:064x}", lambda i=i: i + 1) == i + 1
    assert row_cache.fetch("0" * 64, lambda: 99) == 1  # used again
    row_cache.fetch("f" * 64, lambda: 0)
    assert row_cache.fetch("0" * 64, lambda: 99) == 1 and row_cache.fetch(f"{1:064x}", lambda: 99) == 99


def test_keys_change_with_all_that_decides(bpy, monkeypatch, tmp_path):
    from addon.blender.host import row_cache

    model, image = MODELS["ndf_map"], tmp_path / "picture.exr"
    image.write_bytes(b"1")
    keys = [row_cache.key(model, {}, "shader"), row_cache.key(model, {}, "error"),
            row_cache.key(MODELS["ward"], {}, "shader"),
            row_cache.key(model, {"rotation": 0.25}, "shader"), row_cache.key(model, {"image": str(image)}, "shader")]
    image.write_bytes(b"22")
    keys.append(row_cache.key(model, {"image": str(image)}, "shader"))
    monkeypatch.setattr(row_cache, "_version", lambda: "another")
    keys.append(row_cache.key(model, {}, "shader"))
    assert len(set(keys)) == len(keys) and all(len(key) == 64 and set(key) <= set("0123456789abcdef") for key in keys)


def test_the_version_is_that_of_the_code(bpy, monkeypatch, tmp_path):
    from addon.blender.host import row_cache

    def version():
        row_cache._version.cache_clear()
        return row_cache._version()

    folders = [tmp_path / name for name in ("models", "rows")]
    names = ("models/a.py", "rows/fit.py", "rows/weights.h", "osl.py", "ndf_star.exr")
    for folder in folders:
        folder.mkdir()
    for name in names:
        (tmp_path / name).write_text("1")
    monkeypatch.setattr(row_cache, "_CODE", folders)
    monkeypatch.setattr(row_cache, "_FILES", [tmp_path / name for name in names[3:]])
    found = [version()]
    for name in names:
        (tmp_path / name).write_text("2")
        found.append(version())
    row_cache._version.cache_clear()
    assert len(set(found)) == len(names) + 1


def test_a_cache_that_cannot_be_written_costs_time_only(bpy, monkeypatch, capsys, tmp_path):
    from addon.blender.host import row_cache, settings

    def refused(name, create=False):
        if create:
            raise PermissionError(13, "Permission denied", str(tmp_path))
        return tmp_path

    monkeypatch.setattr(settings, "granted_folder", refused)
    monkeypatch.setattr(row_cache, "_memory", {})
    assert row_cache.fetch("a" * 64, lambda: "made") == "made"
    assert "the cache is not used" in capsys.readouterr().out


def test_without_an_extension_nothing_is_written(bpy):
    from addon.blender.host import row_cache, settings

    assert settings.granted_folder("cache", create=True) is None
    assert row_cache.on_disk() is None and row_cache.size() == 0
    assert settings.for_new(MODELS["phong"]) == {} and settings.lut_folder() == ""
