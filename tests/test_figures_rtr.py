"""Figure 7.38 of Real-Time Rendering: the light of each highlight is what the formula says; the figure is written."""
import math

import numpy as np
import pytest

from addon import cli

pytestmark = pytest.mark.blender
RESOLUTION = (192, 192)
EXPONENTS = (25.0, 100.0)
BOUND = 0.02  # of a highlight's light: kernels leave up to 0.01 of noise here


@pytest.fixture(scope="module")
def row(tmp_path_factory):
    """The module that renders, with two columns, and its pixels (rows, columns, side, side, 3), from the top left."""
    bpy = pytest.importorskip("bpy")
    from addon.dev.demo import phong_row

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(phong_row, "EXPONENTS", EXPONENTS)
        png = phong_row.render(tmp_path_factory.mktemp("row"), RESOLUTION, 64)
        image = bpy.data.images.load(str(png.with_suffix(".exr")))
        pixels = np.array(image.pixels[:]).reshape(*RESOLUTION[::-1], -1)[::-1, :, :3]
        side = RESOLUTION[1] // 2
        yield phong_row, pixels.reshape(2, side, 2, side, 3).swapaxes(1, 2)


def expected(row, k_s, exponent, side, fine=4):
    """E (c_diff/pi + k_s (R·L)^m) (N·L) summed over the pixels of a sphere, from `fine`² points in each: (3,)."""
    x, z = np.meshgrid(*[(np.arange(fine * side) + 0.5) * row.SPACING / (fine * side) - 0.5 * row.SPACING] * 2)
    x, z = x / row.RADIUS, z / row.RADIUS
    inside = x * x + z * z < 1.0
    normal = np.stack([x, -np.sqrt(np.maximum(1.0 - x * x - z * z, 0.0)), z], axis=-1)[inside]
    light, view = np.array(row.SUN_DIRECTION) / np.linalg.norm(row.SUN_DIRECTION), np.array([0.0, -1.0, 0.0])
    up = np.maximum(normal @ light, 0.0)
    mirrored = 2.0 * (normal @ view)[:, None] * normal - view
    f = np.array(row.DIFFUSE) / math.pi + k_s * np.maximum(mirrored @ light, 0.0)[:, None] ** exponent
    return row.SUN_ENERGY * (f * up[:, None]).sum(axis=0) / fine**2


@pytest.mark.parametrize("normalized", [False, True])
@pytest.mark.parametrize("column", [0, 1])
def test_the_light_of_a_highlight(row, column, normalized):
    module, pixels = row
    m, tile = EXPONENTS[column], pixels[int(normalized), column]
    k_s = 0.05 * ((m if normalized else 25.0) + 2.0) / (2.0 * math.pi)
    assert module.scale(m, normalized) == pytest.approx(k_s)
    found, truth = tile.sum(axis=(0, 1)), expected(module, k_s, m, len(tile))
    np.testing.assert_allclose(found, truth, rtol=BOUND)
    assert truth[1] > 0.0 and truth[0] > 10.0 * truth[1]  # green is the highlight alone


def test_highlights_grow_brighter_where_normalised(row):
    """The leftmost match; below, the right one is (100+2)/(25+2) = 3.8 times as bright, but for blur; above, not."""
    (left, right), (left_normalized, right_normalized) = [[tile[..., 1].max() for tile in tiles] for tiles in row[1]]
    assert left_normalized == pytest.approx(left, rel=0.1)
    assert 0.85 < right / left < 1.1
    assert 3.2 < right_normalized / left_normalized < 4.0


def test_the_figure_is_written_as_png_and_svg(tmp_path, capsys, monkeypatch):
    pytest.importorskip("bpy")
    pytest.importorskip("matplotlib")
    from addon.dev.demo import phong_row
    from addon.dev.figures import rtr

    monkeypatch.setattr(phong_row, "EXPONENTS", EXPONENTS)
    monkeypatch.setattr(rtr, "RESOLUTION", (64, 64))
    monkeypatch.setattr(rtr, "SAMPLES", 1)
    assert cli.main(["figures", "rtr", "--output", str(tmp_path)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2
    assert (tmp_path / "rtr_phong.png").read_bytes().startswith(b"\x89PNG")
    assert b"data:image/png" in (tmp_path / "rtr_phong.svg").read_bytes()


def test_what_is_missing_is_one_line(monkeypatch, capsys, tmp_path):
    import sys

    monkeypatch.setitem(sys.modules, "bpy", None)
    assert cli.main(["figures", "rtr", "--output", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "bpy" in error and "plausible-brdf[render]" in error
