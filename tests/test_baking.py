"""Baking: the shipped tables' errors, and what happens to files when a bake succeeds, fails or is cancelled."""
import dataclasses
import json
import os

import numpy as np
import pytest
from truth import quadrature

from addon import cli
from addon.forms import workers
from addon.forms.albedo import bake, tables
from addon.forms.albedo.axes import ColumnAxis, RowAxis
from addon.forms.albedo.tables import TABLES, Table
from addon.models import exr, lobes, pump_stages

LOBES = {"phong": lobes.PHONG, "blinn": lobes.BLINN}
NAMES = list(TABLES)
SMALL = Table("phong", False, ColumnAxis(24, 5.0, 0.0), RowAxis(3, 0.1, 0.5))


@pytest.fixture
def small(table_folder, monkeypatch):
    """A small table in the place of the real ones; that so coarse a table is misread is not what is tested."""
    monkeypatch.setattr(tables, "TABLES", {SMALL.name: SMALL})
    monkeypatch.setattr(bake, "INTERPOLATION_BOUND", 10.0)
    return SMALL


def same_row(job):
    """A stand-in for bake_row that costs nothing."""
    return np.full((SMALL.columns.columns, 4), 0.25 + 0.125 * job[1])


def leftovers(folder):
    return [path.name for path in folder.iterdir() if path.name != f"{SMALL.name}.exr"]


# Accuracy


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("n", [1.0, 2.3, 20.0, 100000.0])
def test_shipped_rows_are_within_their_bounds(name, n):
    """The row at or below an exponent, grazing column included; n = 100000 means the last cell and the last row."""
    table = TABLES[name]
    nodes = tables.load(table)
    row = int(table.rows.position(n) + 1e-6)
    if row == table.rows.rows - 1:
        row -= 1
        assert bake.cell_errors(table, nodes, row + 1, refined=True)[0] <= bake.NODE_BOUND == 2e-5
    node, between = bake.cell_errors(table, nodes, row, refined=True)
    assert node <= bake.NODE_BOUND
    assert 0.0 < between <= bake.INTERPOLATION_BOUND == 1e-3


def test_cell_errors_see_a_wrong_node():
    """The other side: a node 1e-4 off, and one read 2e-3 off, are measured as such."""
    table = TABLES["phong_plain"]
    nodes = tables.load(table).copy()
    nodes[20, 7, 2] *= 1.0001
    node, between = bake.cell_errors(table, nodes, 20, refined=True)
    assert node == pytest.approx(1e-4, rel=0.1) and between <= 1e-3
    nodes[20, :, 1] *= 1.004
    assert bake.cell_errors(table, nodes, 20)[1] == pytest.approx(2e-3, rel=0.2)


@pytest.mark.parametrize("name", ["phong_plain", "phong_controlled", "blinn_plain", "blinn_controlled"])
def test_first_albedos_by_scipy(name):
    """a_0 at nodes of rows and columns all over the table, against a closed form integrated once, to about 1e-6."""
    table = TABLES[name]
    nodes, exponents = tables.load(table), table.rows.exponents()
    for row in (0, 5, table.rows.rows // 2, table.rows.rows - 10, table.rows.rows - 1):
        mu = table.columns.cosines(exponents[row])
        for column in (0, 1, 10, table.columns.columns // 2, table.columns.columns - 2, table.columns.columns - 1):
            exact = quadrature.exact_a0(table.lobe, mu[column], exponents[row])
            assert nodes[row, column, 0] == pytest.approx(exact, rel=bake.NODE_BOUND)


@pytest.mark.parametrize("lobe", LOBES)
def test_chain_begins_with_the_plain_albedo(lobe):
    """Between nodes, too; in double precision."""
    for n in (1.0, 2.4, 33.0, 5000.0, 100000.0):
        mu = np.array([0.0, 1e-4, 0.013, 0.3, 0.77, 0.9999, 1.0])
        exact = [quadrature.exact_a0(lobe, m, n) for m in mu]
        np.testing.assert_allclose(pump_stages.albedos(LOBES[lobe], n, mu, False)[:, 0], exact, rtol=5e-6)


@pytest.mark.parametrize(("lobe", "n"), [("phong", 1.0), ("phong", 9.0), ("blinn", 1.0), ("blinn", 6.0)])
def test_albedos_known_in_closed_form(lobe, n):
    """Normal incidence: Phong 1; Blinn, with h the half vector's cosine, the integral of (n+8) h^(n+1) (2 h^2 - 1)."""
    by_hand = 1.0 if lobe == "phong" else (n + 8.0) * (
        2.0 * (1.0 - 2.0 ** (-(n + 4.0) / 2.0)) / (n + 4.0) - (1.0 - 2.0 ** (-(n + 2.0) / 2.0)) / (n + 2.0))
    found = pump_stages.albedos(LOBES[lobe], n, 1.0, False)[0, 0]
    assert found == pytest.approx(by_hand, rel=1e-7)
    if lobe == "phong":  # at grazing, n = 1: 3 / (2 pi) times the integral of sin^2(theta) cos(theta) cos(phi)
        assert pump_stages.albedos(LOBES[lobe], 1.0, 0.0, False)[0, 0] == pytest.approx(1.0 / np.pi, rel=1e-7)


@pytest.mark.parametrize("name", NAMES)
def test_a_row_baked_again_is_the_same(name):
    table = TABLES[name]
    row = table.rows.rows // 3
    first, second = bake.bake_row((table, row)), bake.bake_row((table, row))
    assert first.tobytes() == second.tobytes()
    # Another processor or NumPy may round in another way than where the file was made, and the shipped files were made
    # with other nodes between the stages.
    np.testing.assert_allclose(first, tables.load(table)[row], rtol=5e-6)


# Files


def test_bake_writes_what_it_computed(small):
    steps = list(bake.bake(workers=1))
    assert steps == [(step + 1, 5, small.name) for step in range(5)], "three rows, and the two cells between them"
    image, metadata = exr.read(small.path)
    for row in range(3):
        np.testing.assert_array_equal(image[row + 1], bake.bake_row((small, row)).astype(np.float32))
    assert leftovers(small.path.parent) == []
    for key in ("model", "source", "grid", "quadrature", "error", "software"):
        assert metadata[f"plausible:{key}"]
    assert "phong" in metadata["plausible:model"] and "plain" in metadata["plausible:model"]
    assert repr(small.rows) in metadata["plausible:grid"] and "NumPy" in metadata["plausible:software"]


@pytest.mark.parametrize("name", NAMES)
def test_shipped_tables_tell_where_they_come_from(name):
    table = TABLES[name]
    _, metadata = exr.read(table.path)
    if isinstance(table, tables.VolumeTable):
        assert "volume" in metadata["plausible:model"]
    else:
        assert table.lobe in metadata["plausible:model"]
        assert ("controlled" if table.control else "plain") in metadata["plausible:model"]
    assert repr(table.columns) in metadata["plausible:grid"] and repr(table.rows) in metadata["plausible:grid"]
    assert ("Edwards" if name.startswith("disk") else "Neumann") in metadata["plausible:source"]
    assert {"plausible:quadrature", "plausible:error", "plausible:software"} <= set(metadata)
    said = float(metadata["plausible:error"].split()[1])
    assert 1e-5 < said <= bake.INTERPOLATION_BOUND


def test_a_finished_bake_is_read_at_once(small, monkeypatch):
    list(bake.bake(workers=1))
    before = tables.load(small).copy()
    monkeypatch.setattr(bake, "bake_row", same_row)
    list(bake.bake(workers=1))
    assert tables.load(small)[2, 0, 0] == 0.5 != before[2, 0, 0]


def test_cancelling_leaves_the_old_tables(small, monkeypatch):
    list(bake.bake(workers=1))
    before = small.path.read_bytes()
    monkeypatch.setattr(bake, "bake_row", same_row)
    running = bake.bake(workers=1)
    for _ in range(2):
        next(running)
    running.close()
    assert small.path.read_bytes() == before and leftovers(small.path.parent) == []
    # Not cancelled, the third row would have replaced the file.
    list(bake.bake(workers=1))
    assert small.path.read_bytes() != before


def test_an_interrupt_leaves_the_old_tables(small, monkeypatch, capsys):
    list(bake.bake(workers=1))
    before = small.path.read_bytes()

    def interrupted(job):
        if job[1] == 2:
            raise KeyboardInterrupt
        return same_row(job)

    monkeypatch.setattr(bake, "bake_row", interrupted)
    assert cli.main(["bake", "--workers", "1", "--output", str(small.path.parent)]) == 130
    assert capsys.readouterr().err == "plausible bake: cancelled\n"
    assert small.path.read_bytes() == before and leftovers(small.path.parent) == []


def test_a_failing_write_leaves_the_old_tables(small, monkeypatch):
    list(bake.bake(workers=1))
    before = small.path.read_bytes()

    def full(self, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", full)
    with pytest.raises(OSError, match="No space"):
        list(bake.bake(workers=1))
    assert small.path.read_bytes() == before and leftovers(small.path.parent) == []


def test_a_folder_that_cannot_be_written(small, monkeypatch, capsys):
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(PermissionError):
        next(bake.bake(workers=1))
    assert cli.main(["bake", "--workers", "1", "--output", str(small.path.parent)]) == 2
    error = capsys.readouterr().err
    assert str(small.path.parent) in error and "read-only" in error and "--output" in error and error.count("\n") == 1
    assert not small.path.exists() and leftovers(small.path.parent) == []


def test_a_file_in_the_folders_place(small, tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    assert cli.main(["bake", "--workers", "1", "--output", str(tmp_path / "taken")]) == 2
    error = capsys.readouterr().err
    assert str(tmp_path / "taken") in error and error.count("\n") == 1


def test_bake_makes_its_folder(small, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(bake, "bake_row", same_row)
    target = tmp_path / "new" / "luts"
    assert cli.main(["bake", "--workers", "1", "--output", str(target), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["written"] == [str(target / f"{small.name}.exr")] and report["seconds"] >= 0.0
    assert (target / f"{small.name}.exr").is_file()


# Check


def checked(folder, capsys):
    """(exit code, report of the small table, printed lines) of `plausible bake --check`."""
    call = ["bake", "--check", "--workers", "1", "--output", str(folder)]
    code = cli.main(call)
    text = capsys.readouterr().out
    assert cli.main([*call, "--json"]) == code
    (report,) = json.loads(capsys.readouterr().out)["tables"]
    return code, report, text


def test_check_passes_what_was_baked(small, capsys):
    list(bake.bake(workers=1))
    code, report, text = checked(small.path.parent, capsys)
    assert code == 0 and report["ok"] and report["table"] == small.name
    assert 0.0 < report["node_error"] <= bake.NODE_BOUND and 1e-3 < report["interpolation_error"] < 10.0
    assert text.startswith("ok") and small.name in text


@pytest.mark.parametrize("where", [(1, 0, 0), (2, 11, 2), (3, 23, 3)])
def test_check_names_a_table_with_one_wrong_texel(where, small, capsys):
    list(bake.bake(workers=1))
    image, metadata = exr.read(small.path)
    image[where] *= 1.01
    exr.write(small.path, image, metadata)
    tables.forget()
    code, report, text = checked(small.path.parent, capsys)
    assert code == 1 and not report["ok"] and report["node_error"] == pytest.approx(0.01, rel=0.01)
    assert text.startswith("FAILED") and small.name in text


@pytest.mark.parametrize("kind", ["missing", "stale", "truncated"])
def test_check_names_a_table_it_cannot_read(kind, small, capsys):
    list(bake.bake(workers=1))
    if kind == "missing":
        small.path.unlink()
    elif kind == "stale":
        other = dataclasses.replace(small, rows=RowAxis(3, 0.2, 0.5))
        exr.write(small.path, tables.marked(other, np.full((3, 24, 4), 0.5)), {})
    else:
        small.path.write_bytes(small.path.read_bytes()[:-7])
    tables.forget()
    code, report, text = checked(small.path.parent, capsys)
    assert code == 1 and not report["ok"] and kind in report["message"] and str(small.path) in text


def test_interpolation_bound_is_enforced(small, monkeypatch, capsys):
    monkeypatch.setattr(bake, "INTERPOLATION_BOUND", 1e-3)
    list(bake.bake(workers=1))
    code, report, _ = checked(small.path.parent, capsys)
    assert code == 1 and report["node_error"] <= bake.NODE_BOUND and report["interpolation_error"] > 1e-3


# Workers


# Python warns that other threads (here those of SciPy) may hold locks when it forks; no job takes any.
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_workers_keep_the_order():
    assert list(workers.mapped(abs, [-3, 2, -1], 1)) == [3, 2, 1]
    assert list(workers.mapped(abs, range(-20, 0), 2)) == list(range(20, 0, -1))
    with pytest.raises(TypeError):
        list(workers.mapped(abs, ["x"], 2))
