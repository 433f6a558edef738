"""Tables of other resolutions and ranges: what a file tells of its axes, what follows it, what a bake costs and errs.

Truth is the albedo itself, integrated where no node lies.
"""
import dataclasses
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from addon import cli
from addon.backends.osl import assembler
from addon.brdf import MODELS
from addon.forms.albedo import axes, bake, sizes, tables, tabulated
from addon.forms.albedo.tables import TABLES, TableError
from addon.forms.albedo.tabulated import TABULATED
from addon.models import exr, lobes, pump_stages
from addon.models.errors import ParameterError

ROOT = Path(__file__).resolve().parents[1]
SMALL = tables.Table("phong", False, axes.ColumnAxis(24, 5.0, 0.0), axes.RowAxis(6, 0.1, 0.5))


@pytest.fixture
def small(table_folder, monkeypatch):
    """A small table in the place of the real ones, nowhere yet."""
    monkeypatch.setattr(tables, "TABLES", {SMALL.name: SMALL})
    return SMALL


def bake_small(**size):
    list(bake.bake(workers=1, size=sizes.Size(**size)))
    return tables.in_use(SMALL.name)


# Axes


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("resolution", sizes.RESOLUTIONS)
@pytest.mark.parametrize("ends", [(1.0, 1000.0), (50.0, 100000.0), (1.0, 2.0)])
def test_rows_of_a_part_are_at_their_numbers(name, resolution, ends):
    table = sizes.sized(TABLES[name], sizes.Size(resolution, *ends))
    exponents = table.rows.exponents()
    assert (exponents[0], exponents[-1]) == table.covering(*ends) and np.all(np.diff(exponents) > 0.0)
    np.testing.assert_allclose([table.rows.position(n) for n in exponents], np.arange(len(exponents)), atol=1e-7)
    assert table.rows.position(0.01) < 1e-9 and table.rows.position(1e9) == pytest.approx(len(exponents) - 1)
    assert table.stamp != TABLES[name].stamp
    for end in ends:  # of a table of volumes, too, whose rows are those of n + 1
        assert tables.covers(table.span, end)
    assert not tables.covers(table.span, 1.01 * ends[1]) or ends[1] == 100000.0


def test_the_standard_size_is_what_is_declared():
    for table in TABLES.values():
        assert sizes.sized(table, sizes.STANDARD) == table and tables.in_use(table.name) == table
        assert "lowest" not in repr(table), "shipped files are stamped without a range"


@pytest.mark.parametrize("resolution, factor", [("draft", 0.25), ("standard", 1.0), ("fine", 2.25)])
def test_a_resolution_is_a_number_of_nodes(resolution, factor):
    chosen = sizes.Size(resolution)
    for table in TABLES.values():
        parts = sizes.bytes_of(sizes.sized(table, chosen)) / sizes.bytes_of(table)
        assert parts == pytest.approx(factor, rel=0.02)
    seconds, standard = (sum(sizes.seconds_of(sizes.sized(table, size)) for table in TABLES.values())
                         for size in (chosen, sizes.STANDARD))
    assert seconds / standard == pytest.approx(sizes.RESOLUTIONS[resolution].cost, rel=0.15)


@pytest.mark.parametrize("given, parameter, code, named", [
    ({"resolution": "coarse"}, "resolution", "choice", "'coarse'"), ({"lowest": 0.5}, "range", "range", "0.5"),
    ({"highest": 2e5}, "range", "range", "200000"), ({"lowest": 60.0, "highest": 100.0}, "range", "range", "60 .. 100"),
    ({"lowest": float("nan")}, "range", "range", "nan"), ({"highest": float("inf")}, "range", "range", "inf"),
])
def test_sizes_that_are_refused(given, parameter, code, named):
    with pytest.raises(ParameterError, match=re.escape(named)) as caught:
        sizes.Size(**given)
    assert (caught.value.parameter, caught.value.code) == (parameter, code)


# Errors


@pytest.mark.parametrize("resolution, low, high", [
    ("draft", 1e-3, 5e-3), ("standard", 4e-4, 1e-3), ("fine", 2e-4, 7e-4)])
def test_errors_are_what_resolutions_say(resolution, low, high):
    """In the last cell, which is Phong's worst, and neither far below what is said nor above."""
    table = sizes.sized(TABLES["phong_plain"], sizes.Size(resolution))
    nodes = np.zeros((table.height, table.columns.columns, 4))
    for row in (table.height - 2, table.height - 1):
        nodes[row] = bake.bake_row((table, row))
    assert low < bake.measure_row((table, nodes, table.height - 2)) < high
    assert sizes.bound(resolution, bake.INTERPOLATION_BOUND) == pytest.approx(high)


def test_a_shorter_range_is_finer(small):
    def error(size):
        table = bake_small(**size)
        n, mu = 41.0, np.array([0.05, 0.2, 0.4])
        read = axes.read(tables.load(table), table.columns, table.rows, mu, n)[:, 0]
        return np.abs(read / pump_stages.albedos(lobes.PHONG, n, mu, False)[:, 0] - 1.0).max()

    whole, part = error({}), error({"lowest": 30.0, "highest": 60.0})
    assert part < 0.3 * whole and whole > 1e-3


def test_the_measured_error_is_that_of_the_check(small):
    """Of a table so small that every cell is measured or is near one that is; and a draft is told by its file."""
    bake_small(resolution="draft", lowest=2.0, highest=50.0)
    stated = tables.stated_error(SMALL.name)
    report = list(bake.check(workers=1))[-1][-1]
    assert stated == pytest.approx(report["interpolation_error"], rel=0.3)
    assert tables.resolution(SMALL.name) == "draft" and report["interpolation_bound"] == 5e-3
    assert not report["ok"] and report["node_error"] < bake.NODE_BOUND


# Files


def test_a_file_tells_its_axes_and_all_follow(small, monkeypatch):
    table = bake_small(resolution="draft", lowest=2.0, highest=500.0)
    assert table == dataclasses.replace(SMALL, columns=axes.ColumnAxis(12, 5.0, 0.0),
                                        rows=axes.RowAxis(3, 0.1, 0.5, 2.0, 500.0))
    mu = table.columns.cosines(500.0)
    truth = pump_stages.albedos(lobes.PHONG, 500.0, mu, False)
    np.testing.assert_allclose(tables.albedos("phong", False, mu, 500.0), truth, rtol=2e-5)
    model = MODELS["pumped_phong"]
    plain = dataclasses.replace(model, parameters=tuple(p for p in model.parameters if p.id != "control"))
    text = assembler.assemble(plain)
    assert f"Axes(12, 5.0, 0.0, 3, 0.1, 0.5, {table.stamp!r}, 0, 3, 2.0, 500.0)" in text
    with pytest.raises(TableError) as caught:
        tables.load(SMALL)
    assert caught.value.code == "axes"


@pytest.mark.parametrize("told", [
    "no json", "[]", "{}", '{"columns": 24}', '{"columns": 24, "rows": 6, "lowest": 1, "highest": 1e5, "extra": 1}',
    '{"columns": 1000000, "rows": 6, "lowest": 1.0, "highest": 1000.0}',
    '{"columns": 24.5, "rows": 6, "lowest": 1.0, "highest": 1000.0}',
    '{"columns": 24, "rows": true, "lowest": 1.0, "highest": 1000.0}',
    '{"columns": 24, "rows": 6, "lowest": NaN, "highest": 1000.0}',
    '{"columns": 24, "rows": 6, "lowest": "x", "highest": 1000.0}',
    '{"columns": 24, "rows": 6, "lowest": 10.0, "highest": 1.0}',
])
def test_axes_that_cannot_be_are_refused(small, told):
    nodes = np.full((6, 24, 4), 0.5)
    exr.write(small.path, tables.marked(small, nodes), {tables.AXES: told})
    with pytest.raises(TableError) as caught:
        tables.in_use(small.name)
    assert caught.value.code == "impossible" and caught.value.path == small.path


def test_axes_that_the_markers_contradict_are_stale(small):
    told = json.dumps({"columns": 24, "rows": 6, "lowest": 1.0, "highest": 1000.0})
    exr.write(small.path, tables.marked(small, np.full((6, 24, 4), 0.5)), {tables.AXES: told})
    with pytest.raises(TableError) as caught:
        tables.in_use(small.name)
    assert caught.value.code == "stale"


def test_exponents_beyond_a_table_are_refused(small):
    bake_small(lowest=2.0, highest=500.0)
    model = MODELS["pumped_phong"].with_albedos(TABULATED)
    for exponent in (1.9, 501.0):
        with pytest.raises(TableError, match=f"exponent: {exponent:g} is outside 2 .. 500") as caught:
            model.albedo([0.5], exponent=exponent, control=False)
        assert caught.value.code == "range" and caught.value.path == small.path
    for exponent in (2.0, 500.0, 500.00003):  # the last is what single precision may make of it
        assert 0.5 < model.albedo([0.5], exponent=exponent, control=False)[0] < 1.0
    assert model.albedo([0.5], exponent=1.0, pumps=0.0)[0] > 0.0, "what reads no table has no range"
    assert MODELS["pumped_phong"].albedo([0.5], exponent=501.0, control=False)[0] > 0.5, "nor has what is integrated"


def test_models_say_where_they_read_tables():
    pumped, fit = MODELS["pumped_phong"], MODELS["edwards_fit"]
    assert tabulated.readings(pumped, pumped.resolve({"roughness": 0.5})) == [("phong_controlled", pytest.approx(30.0))]
    assert tabulated.readings(pumped, pumped.resolve({"control": False})) == [("phong_plain", 20.0)]
    assert tabulated.readings(pumped, pumped.resolve({"pumps": 0.0})) == tabulated.readings(MODELS["phong"], {}) == []
    disk = MODELS["reciprocal_disk"]
    assert tabulated.readings(disk, disk.resolve({})) == [("disk_plain", 20.0)]
    assert tabulated.readings(fit, fit.resolve({})) == [("disk_volume", 50.0), ("disk_volume", 10.0)]
    assert tabulated.readings(fit, fit.resolve({"renormalize": False})) == []
    for model in MODELS.values():
        for name, _ in tabulated.readings(model, model.resolve({})):
            assert name in tabulated.tables_of(model)


def test_a_volume_table_is_for_what_it_says(table_folder):
    """A range of lumps ends where it says; a row less would be 4 % off."""
    table = sizes.sized(TABLES["disk_volume"], sizes.Size("draft", 1.0, 4.0))
    nodes = np.stack([bake.bake_row((table, row)) for row in range(table.height)])
    exr.write(table.path, tables.marked(table, nodes), {tables.AXES: json.dumps(table.told_axes())})
    from addon.models import disk

    mu, one = np.array([0.3, 0.5]), np.ones(2)
    view = np.stack([np.sqrt(1.0 - mu * mu), np.zeros(2)], axis=-1)
    for n in (0.0, 1.0, 4.0):
        exact = disk.Lump(np.zeros((2, 2)), np.full((2, 2), 0.8), np.full(2, n)).volume(view)
        np.testing.assert_allclose(tables.volumes(mu, n * one, 0.8 * one), exact, rtol=2e-3)
    with pytest.raises(TableError, match="outside 0 .. 4"):
        tables.volumes(mu, 4.1 * one, 0.8 * one)


# The command


def test_command_bakes_what_a_model_reads(small, monkeypatch, capsys):
    monkeypatch.setattr(sizes, "tables_of", lambda models: [SMALL.name] if models == ["pumped_phong"] else None)
    call = ["bake", "--models", "pumped_phong", "--resolution", "draft", "--range", "1", "1000", "--workers", "1"]
    assert cli.main(call) == 0
    assert "12 x 3, exponents 1 to 1000, within" in capsys.readouterr().out
    assert cli.main([*call, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["axes"] == {SMALL.name: {"columns": 12, "rows": 3, "lowest": 1.0, "highest": 1000.0}}
    assert report["interpolation_errors"][SMALL.name] == tables.stated_error(SMALL.name) > 1e-3


def test_tables_are_those_of_the_models():
    assert sizes.tables_of(["pumped_phong", "reciprocal_disk"]) == ["phong_plain", "phong_controlled", "disk_plain"]
    assert sizes.tables_of(m.id for m in sizes.readers()) and set(sizes.tables_of(
        m.id for m in sizes.readers())) == set(TABLES)


@pytest.mark.parametrize("options, words", [
    (["--models", "phong"], "phong reads no table; those that do are pumped_phong, pumped_blinn"),
    (["--models", "nothing"], "no model 'nothing'"),
    (["phong_plain", "--models", "pumped_phong"], "not both"),
    (["--range", "5", "8"], "5 .. 8"), (["--range", "0", "8"], "0 .. 8"),
])
def test_wrong_calls(options, words, capsys):
    assert cli.main(["bake", *options]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1


def test_help_states_cost_and_error(capsys):
    with pytest.raises(SystemExit):
        cli.main(["bake", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    for words in ("draft: inexact: albedos within 0.5 %, 0.25 times the numbers", "fine: albedos within 0.07 %",
                  "--range FROM TO", "render striped"):
        assert words in text


# Bakes that end early


FULL = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
from addon import cli
sys.exit(cli.main(["bake", "disk_volume", "--resolution", "draft", "--workers", "1", "--output", sys.argv[1]]))
"""
KILLED = """
import os, signal, sys
from addon.forms.albedo import bake
from addon import cli
from pathlib import Path
Path.replace = lambda self, target: os.kill(os.getpid(), signal.SIGKILL)
cli.main(["bake", "disk_volume", "--resolution", "draft", "--workers", "1", "--output", sys.argv[1]])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limits on files and no SIGKILL")
@pytest.mark.parametrize("script", [FULL, KILLED], ids=["disk full", "killed"])
def test_a_bake_that_ends_early_leaves_the_old_file(script, tmp_path):
    """A disk that takes no more than 4 KB of a file; and a process killed just before it renames."""
    old = tmp_path / "disk_volume.exr"
    old.write_bytes(TABLES["disk_volume"].path.read_bytes())
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], cwd=ROOT, capture_output=True, text=True)
    assert old.read_bytes() == TABLES["disk_volume"].path.read_bytes()
    if script is FULL:
        assert done.returncode == 2 and "File too large" in done.stderr and done.stderr.count("\n") == 1
        assert list(tmp_path.iterdir()) == [old]
    else:
        assert done.returncode == -9 and len(list(tmp_path.iterdir())) == 2


def test_what_a_killed_bake_left_is_swept(small):
    import os

    left, fresh = (small.path.with_name(f".phong_plain.exr.{i}.part") for i in (1, 2))
    left.write_bytes(b"half")
    fresh.write_bytes(b"another process is writing")
    os.utime(left, (0, 0))
    bake_small(highest=4.0)
    assert not left.exists() and fresh.exists()
