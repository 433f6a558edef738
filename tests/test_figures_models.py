"""The pictures of models' pages: their curves are the formulas', and the balls show what they are said to show."""
import math

import numpy as np
import pytest
from matplotlib import image

from addon.brdf import MODELS
from addon.dev.figures import models as figures

RADIUS = 0.47


def drawn(name, tiles=None):
    """(the axes of the albedos, those of the lobes, the axes of the balls) of a model's picture."""
    figure = figures.draw(MODELS[name], np.full((20, 60, 3), 0.5) if tiles is None else tiles, RADIUS)
    *balls, albedos, lobes = figure.axes
    assert len(balls) == 3
    return albedos, lobes, balls


def curves(axes):
    """{colour: (x, y)} of the longest line of each of the three colours."""
    longest = {}
    for line in axes.get_lines():
        if line.get_color() in figures.LINES and len(line.get_xdata()) > 10:
            longest[line.get_color()] = np.array(line.get_data())
    return [longest[colour] for colour in figures.LINES]


def test_curves_are_the_formulas():
    """Phong's lobe is a power of the cosine from the mirror direction; as DESIGN says its albedo at n = 20 is .5005 at
    60 degrees, and .8710 pumped once."""
    albedos, lobes, _ = drawn("pumped_phong")
    for (x, y), expected in zip(curves(albedos), (0.5005, 0.871), strict=False):
        assert np.interp(60.0, x, y) == pytest.approx(expected, abs=2e-3)
    x, y = curves(lobes)[0]  # before pumping, n = 20
    angle, radius = np.degrees(np.arctan2(x, y)), np.hypot(x, y)
    inside = np.abs(angle - figures.LIGHT) < 40.0
    np.testing.assert_allclose(radius[inside], np.cos(np.radians(angle[inside] - figures.LIGHT)) ** 20, atol=1e-3)


def test_lobes_are_cut_where_they_change():
    """Ward's, whose slope across the tangent varies: exp(-tan²/m_y²) seen across, along it all would be the same."""
    _, lobes, _ = drawn("ward")
    radii = [np.hypot(x, y) for x, y in curves(lobes)]
    assert np.abs(radii[0] - radii[2]).max() > 0.2
    angle = math.radians(20.0)  # of the view; the half vector leans by 12.5 degrees, the light is at 45
    m, tilt = 0.3, math.radians(12.5)
    peak = max(radii[1])
    assert peak == pytest.approx(1.0)
    at = np.degrees(np.arctan2(*curves(lobes)[1]))
    ratio = np.interp(20.0, at, radii[1]) / np.interp(45.0, at, radii[1])
    expected = math.exp(-(math.tan(tilt) / m) ** 2) * math.sqrt(math.cos(math.radians(45.0)) / math.cos(angle))
    assert ratio == pytest.approx(expected, rel=2e-3)


def test_tiles_stand_on_white():
    tiles = np.repeat(np.array([0.2, 0.5, 0.8]), 20)[None, :, None] * np.ones((20, 1, 3))
    for at, value in zip(drawn("phong", tiles)[2], (0.2, 0.5, 0.8), strict=True):
        shown = at.get_images()[0].get_array()
        np.testing.assert_allclose(shown[10, 10], value)
        np.testing.assert_allclose(shown[0, 0], 1.0)


def test_a_saved_picture_is_small(tmp_path):
    path = figures.save(figures.draw(MODELS["phong"], np.full((20, 60, 3), 0.5), RADIUS), tmp_path / "a.png")
    assert path.stat().st_size < 60e3 and [each.name for each in tmp_path.iterdir()] == ["a.png"]
    height, width, _ = image.imread(path).shape
    assert (width, height) == tuple(round(side * figures.DPI) for side in figures.SIZE)


@pytest.mark.blender
def test_balls_show_the_values(tmp_path, monkeypatch):
    """Pumped, Phong's rim is as bright as metal's; before, it is dark. From within the rim both are nearly alike."""
    pytest.importorskip("bpy")
    from addon.dev.demo import balls

    monkeypatch.setattr(balls, "SAMPLES", 16)
    side = 32
    path = balls.render(MODELS["pumped_phong"], tmp_path, side)
    pixels = image.imread(path)[..., 0]
    assert pixels.shape[:2] == (side, 3 * side)
    x = np.arange(side) + 0.5 - 0.5 * side
    from_middle = np.hypot(x, x[:, None]) / (balls.RADIUS / balls.SPACING * side)
    rims, middles = ([pixels[:, i * side:(i + 1) * side][where].mean() for i in range(3)]
                     for where in ((from_middle > 0.85) & (from_middle < 0.97), from_middle < 0.4))
    assert rims[1] > 1.15 * rims[0] and rims[2] > 0.98 * rims[1]
    assert middles[1] < 1.1 * middles[0]
