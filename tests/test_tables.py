"""Albedo tables: their axes, their files, and what a missing, damaged or stale file is answered with."""
import dataclasses

import numpy as np
import pytest

from addon import brdf
from addon.forms.albedo import axes, tables
from addon.forms.albedo.axes import ColumnAxis, RowAxis
from addon.forms.albedo.tables import TABLES, Table, TableError
from addon.forms.albedo.tabulated import TABULATED
from addon.models import exr

NAMES = list(TABLES)
SMALL = Table("phong", False, ColumnAxis(9, 5.0, 0.0), RowAxis(4, 0.1, 0.5))


def impostor(table=SMALL):
    """Nodes that are legal albedos, all different."""
    shape = (table.rows.rows, table.columns.columns, 4)
    return np.linspace(0.1, 0.99, np.prod(shape)).reshape(shape).astype(np.float32)


@pytest.fixture
def small(table_folder, monkeypatch):
    """A small table in the place of the real ones, written whole."""
    monkeypatch.setattr(tables, "TABLES", {SMALL.name: SMALL})
    exr.write(SMALL.path, tables.marked(SMALL, impostor()), {})
    tables.forget()
    return SMALL


# Axes


@pytest.mark.parametrize("name", NAMES)
def test_position_of_every_node_is_its_number(name):
    table = TABLES[name]
    exponents = table.rows.exponents()
    assert exponents[0] == 1.0 and exponents[-1] == 100000.0 and np.all(np.diff(exponents) > 0.0)
    for row, n in enumerate(exponents):
        assert table.rows.position(n) == pytest.approx(row, abs=1e-8)
    for n in (1.0, 1.3, 40.0, 2500.0, 100000.0):
        mu = table.columns.cosines(n)
        assert mu[0] == 0.0 and mu[-1] == 1.0 and np.all(np.diff(mu) > 0.0)
        np.testing.assert_allclose(table.columns.position(mu, n), np.arange(len(mu)), atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_positions_rise_and_are_held_to_the_table(name):
    table = TABLES[name]
    rows = [table.rows.position(n) for n in np.geomspace(1.0, 1e5, 500)]
    assert np.all(np.diff(rows) > 0.0)
    columns = table.columns.position(np.linspace(0.0, 1.0, 2000), 50.0)
    assert np.all(np.diff(columns) > 0.0)
    assert table.rows.position(0.1) == 0.0 and table.rows.position(1e9) == pytest.approx(table.rows.rows - 1)
    np.testing.assert_array_equal(table.columns.position([-0.5, 1.5], 50.0), [0.0, table.columns.columns - 1])


def test_columns_are_dense_where_albedos_change():
    """At every exponent the lobe's width at grazing, and Blinn's also at the normal, gets its share of the columns."""
    for n in (100.0, 10000.0):
        phong = TABLES["phong_plain"].columns.cosines(n)
        assert 0.3 < (phong < 1.0 / np.sqrt(n)).mean() < 0.55  # evenly laid, 0.1 and 0.01
        blinn = np.arccos(TABLES["blinn_plain"].columns.cosines(n))
        assert 0.15 < (blinn < 3.0 / np.sqrt(n)).mean() < 0.35  # evenly laid over the angle, 0.19 and 0.019


@pytest.mark.parametrize("name", NAMES)
def test_reading_is_exact_at_the_nodes(name):
    table = TABLES[name]
    nodes = tables.load(table)
    if isinstance(table, tables.VolumeTable):
        _assert_volumes_are_read(table, nodes)
        return
    for row in (0, 1, table.rows.rows // 2, table.rows.rows - 1):
        n = table.rows.exponents()[row]
        value = tables.albedos(table.lobe, table.control, table.columns.cosines(n), n)
        np.testing.assert_allclose(value, nodes[row], rtol=1e-6)


def _assert_volumes_are_read(table, nodes):
    """At every radius but 0, which no lump has."""
    for layer in range(1, table.layers):
        for row in (0, 7, table.rows.rows - 1):
            m, radius = table.rows.exponents()[row], table.radii[layer]
            distance = table.columns.cosines(m) * radius
            mu = np.sqrt(1.0 - (1.0 - distance) ** 2)
            value = tables.volumes(mu, np.full_like(mu, m - 1.0), np.full_like(mu, radius))
            kept = nodes[layer // 4 * table.rows.rows + row, :, layer % 4]
            np.testing.assert_allclose(value, kept, rtol=1e-5)


def test_reading_blends_two_rows_and_two_columns():
    """Half-way in the laws of the axes is the mean of the four nodes around."""
    nodes = impostor().astype(np.float64)
    columns, rows = SMALL.columns, SMALL.rows
    low, high = rows.exponents()[1:3]
    n = (0.5 * (low**-rows.law + high**-rows.law)) ** (-1.0 / rows.law)
    mu = columns.cosines(n)
    value = axes.read(nodes, columns, rows, 0.5 * (mu[3:4] + mu[4:5]), n)[0]
    np.testing.assert_allclose(value, nodes[1:3, 3:5].mean(axis=(0, 1)), rtol=1e-9)
    assert np.abs(value - nodes[1, 3]).min() > 1e-3


# Files


@pytest.mark.parametrize("name", NAMES)
def test_marker_rows(name):
    """What a shader checks: (-1, stamp, 0 at the top or 1 at the bottom, format) in every column."""
    table = TABLES[name]
    image, _ = exr.read(table.path)
    assert image.shape == (table.height + 2, table.columns.columns, 4) and image.dtype == np.float32
    np.testing.assert_array_equal(image[0], np.tile(np.float32([-1.0, table.stamp, 0.0, 1.0]), (image.shape[1], 1)))
    np.testing.assert_array_equal(image[-1], np.tile(np.float32([-1.0, table.stamp, 1.0, 1.0]), (image.shape[1], 1)))
    assert 0.0 <= table.stamp < 1.0 and np.float32(table.stamp) == table.stamp
    assert image[1:-1].min() > 0.0


@pytest.mark.parametrize("change", [
    {"lobe": "blinn"}, {"control": True},
    {"columns": ColumnAxis(10, 5.0, 0.0)}, {"columns": ColumnAxis(9, 4.0, 0.0)}, {"columns": ColumnAxis(9, 5.0, 1.0)},
    {"rows": RowAxis(5, 0.1, 0.5)}, {"rows": RowAxis(4, 0.11, 0.5)}, {"rows": RowAxis(4, 0.1, 0.75)},
])
def test_stamp_changes_with_the_axes(change, monkeypatch):
    assert dataclasses.replace(SMALL).stamp == SMALL.stamp
    assert dataclasses.replace(SMALL, **change).stamp != SMALL.stamp
    before = SMALL.stamp
    monkeypatch.setattr(tables, "FORMAT", tables.FORMAT + 1)
    assert SMALL.stamp != before


def test_stamps_differ_and_the_shipped_files_are_small():
    assert len({table.stamp for table in TABLES.values()}) == len(TABLES)
    files = [table.path for table in TABLES.values()] + [tables.folder() / "base_lobes.json"]
    texels = sum((table.rows.rows + 2) * table.columns.columns * 16 for table in TABLES.values())
    assert texels < sum(path.stat().st_size for path in files) < 4e6


def test_a_whole_table_loads_once(small):
    nodes = tables.load(small)
    np.testing.assert_array_equal(nodes, impostor())
    assert tables.load(small) is nodes
    exr.write(small.path, tables.marked(small, 0.5 * impostor()), {})
    assert tables.load(small) is nodes
    tables.forget()
    np.testing.assert_array_equal(tables.load(small), 0.5 * impostor())


def damaged(kind, table):
    """Damage the file of a table in one way."""
    whole = tables.marked(table, impostor(table))
    data = table.path.read_bytes()
    if kind == "missing":
        table.path.unlink()
    elif kind == "folder":
        table.path.unlink()
        table.path.mkdir()
    elif kind == "empty":
        table.path.write_bytes(b"")
    elif kind == "truncated":
        table.path.write_bytes(data[:-1])
    elif kind == "header only":
        table.path.write_bytes(data[:100])
    elif kind == "longer":
        table.path.write_bytes(data + b"\0")
    elif kind == "not an image":
        table.path.write_bytes(b"\x89PNG\r\n\x1a\n" + data[8:])
    else:
        if kind == "resized":
            whole = whole[:, :-1]
        elif kind == "row lost":
            whole = np.delete(whole, 2, axis=0)
        elif kind == "stale":
            whole = tables.marked(dataclasses.replace(table, rows=RowAxis(4, 0.2, 0.5)), impostor(table))
        elif kind == "upside down":
            whole = whole[::-1]
        elif kind == "one marker altered":
            whole[-1, 3, 1] += np.float32(2.0**-16)
        else:
            whole[3, 4, 2] = {"NaN": np.nan, "infinite": np.inf, "negative": -0.1, "zero": 0.0, "too large": 1.5}[kind]
        exr.write(table.path, whole, {})


CODES = {
    "missing": "missing", "folder": "unreadable", "resized": "resized", "row lost": "resized",
    **dict.fromkeys(("empty", "truncated", "header only", "longer", "not an image"), "image"),
    **dict.fromkeys(("stale", "upside down", "one marker altered"), "stale"),
    **dict.fromkeys(("NaN", "infinite", "negative", "zero", "too large"), "albedos"),
}


@pytest.mark.parametrize("kind", CODES)
def test_what_is_wrong_with_a_table_is_said(kind, small):
    damaged(kind, small)
    tables.forget()
    model = brdf.MODELS["pumped_phong"]
    with pytest.raises(TableError) as caught:
        model.with_albedos(TABULATED).albedo(0.5, control=False)
    message = str(caught.value)
    assert str(small.path) in message and "plausible bake" in message and "\n" not in message
    assert caught.value.path == small.path and caught.value.code == CODES[kind]
    # What reads no table goes on.
    assert model.with_albedos(TABULATED).albedo(0.5, control=False, pumps=0.0)[0] > 0.0
    assert model.albedo(0.5, control=False)[0] > 0.0


def test_use_folder_can_be_taken_back(small, table_folder):
    assert tables.folder() == table_folder and small.path.parent == table_folder
    tables.use_folder(None)
    assert (tables.folder() / "phong_plain.exr").is_file() and tables.folder() != table_folder


# EXR, against another implementation


PIXELS = np.random.default_rng(1).normal(size=(5, 7, 4)).astype(np.float32)


def test_openimageio_reads_what_we_write(tmp_path):
    oiio = pytest.importorskip("OpenImageIO")
    path = tmp_path / "ours.exr"
    exr.write(path, PIXELS, {"plausible:model": "näme", "plausible:error": "1e-5"})
    image = oiio.ImageInput.open(str(path))
    assert image, oiio.geterror()
    spec = image.spec()
    assert (spec.width, spec.height, spec.nchannels) == (7, 5, 4) and str(spec.format) == "float"
    assert list(spec.channelnames) == ["R", "G", "B", "A"]
    np.testing.assert_array_equal(np.asarray(image.read_image("float")).reshape(5, 7, 4), PIXELS)
    assert spec.getattribute("plausible:model") == "näme"
    assert spec.getattribute("plausible:error") == "1e-5"
    image.close()


def test_we_read_what_openimageio_writes(tmp_path):
    oiio = pytest.importorskip("OpenImageIO")
    path = tmp_path / "theirs.exr"
    for compression in ("none", "zip"):
        spec = oiio.ImageSpec(7, 5, 4, "float")
        spec.attribute("compression", compression)
        spec.attribute("plausible:model", "theirs")
        image = oiio.ImageOutput.create(str(path))
        assert image.open(str(path), spec) and image.write_image(PIXELS) and image.close()
        if compression == "none":
            pixels, metadata = exr.read(path)
            np.testing.assert_array_equal(pixels, PIXELS)
            assert metadata["plausible:model"] == "theirs"
        else:
            with pytest.raises(exr.ExrError) as caught:
                exr.read(path)
            assert caught.value.code == "format" and str(path) in str(caught.value)


def test_every_truncation_is_an_exr_error():
    data = exr.encode(PIXELS, {"key": "value"})
    np.testing.assert_array_equal(exr.decode(data)[0], PIXELS)
    for length in range(len(data)):
        with pytest.raises(exr.ExrError):
            exr.decode(data[:length])


def test_shipped_tables_open_elsewhere():
    oiio = pytest.importorskip("OpenImageIO")
    for table in TABLES.values():
        pixels = oiio.ImageBuf(str(table.path)).get_pixels(oiio.FLOAT)
        np.testing.assert_array_equal(pixels[1:-1], tables.load(table).astype(np.float32))


def test_a_failed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "table.exr"
    exr.write(path, PIXELS, {})
    before = path.read_bytes()

    class Unprintable:
        def __str__(self):
            raise RuntimeError("no")

    with pytest.raises(RuntimeError):
        exr.write(path, PIXELS, {"key": Unprintable()})
    assert path.read_bytes() == before and [p.name for p in tmp_path.iterdir()] == ["table.exr"]
