"""The disk's figures: their numbers against the paper's formulas, written anew here, and their files."""
import math

import numpy as np
import pytest

from addon import cli
from addon.brdf import MODELS
from addon.dev.figures import disk as figures
from addon.models import disk

TINY = {"rtol": 1e-9, "atol": 1e-9}


def lump(h, radius, n):
    """Eq. 26 about the origin."""
    inside = np.maximum(1.0 - (h**2).sum(axis=-1) / radius**2, 0.0)
    return (n + 1.0) / (math.pi * radius**2) * inside**n


def integral(y, x):
    """Trapezoids."""
    return np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x))


def on_disk(angle, radius, count=400, seed=3):
    """Random points (count, 2) of the disk at a view of `angle` degrees, from its centre out to `radius`."""
    rng = np.random.default_rng(seed)
    r, phi = radius * np.sqrt(rng.uniform(size=count)), rng.uniform(0.0, 2.0 * math.pi, count)
    return np.stack([math.sin(math.radians(angle)) + r * np.cos(phi), r * np.sin(phi)], axis=-1)


@pytest.mark.parametrize("radius", figures.RADII)
@pytest.mark.parametrize("n", figures.EXPONENTS)
def test_lump_curves_are_cuts_of_eq_26(radius, n):
    u, p = figures.lump_curve(radius, n)
    assert (u[0], u[-1]) == (-1.0, 1.0)
    np.testing.assert_allclose(p, lump(np.stack([u, 0.0 * u], axis=-1), radius, n), **TINY)
    assert p.max() == pytest.approx((n + 1.0) / (math.pi * radius**2)) and u[np.argmax(p)] == pytest.approx(0.0)
    # A round density: its volume, from the cut.
    assert math.pi * integral(p * np.abs(u), u) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("angle", figures.VIEWS)
@pytest.mark.parametrize("model", figures.PROJECTIONS)
def test_lobe_curves_are_eq_20_and_24(model, angle):
    radius, n = figures.LOBE["radius"], figures.LOBE["exponent"]
    angles, f = figures.lobe_curve(model, angle, radius_u=radius, radius_v=radius, exponent=n)
    v, a = math.radians(angle), np.radians(angles[1:-1])
    h_angle, lh = 0.5 * (a - v), np.cos(0.5 * (a + v))  # of H from the normal, towards the mirror direction; L·H
    if model == "disk_scaling":
        h = math.cos(v) * np.tan(h_angle)
        expected = lump(h[:, None], radius, n) * math.cos(v) ** 2 / (4.0 * np.cos(a) * lh * np.cos(h_angle) ** 3)
    else:
        h = np.sin(a) - math.sin(v)
        expected = lump(h[:, None], radius, n) * (2.0 + 2.0 * np.cos(a + v)) / (4.0 * lh**2)
    np.testing.assert_allclose(f[1:-1], expected, rtol=1e-6, atol=1e-8)
    assert f[0] == f[-1] == pytest.approx(0.0, abs=1e-9)


def test_lobes_show_what_the_paper_says_of_figure_7():
    """Scaling: wide, off-specular, larger towards grazing. Orthogonal: narrow, intense, about the mirror direction."""
    radius = figures.LOBE["radius"]
    given = {"radius_u": radius, "radius_v": radius, "exponent": figures.LOBE["exponent"]}
    assert radius == pytest.approx(1.0 - math.sin(math.radians(60.0)))
    peak = (given["exponent"] + 1.0) / (math.pi * radius**2)
    sizes = {}  # (area in the polar plot, width at half the peak)
    for model in figures.PROJECTIONS:
        for view in figures.VIEWS:
            angles, f = figures.lobe_curve(model, view, **given)
            sizes[model, view] = 0.5 * integral(f**2, np.radians(angles)), np.ptp(angles[f > 0.5 * f.max()])
            scaling = model == "disk_scaling"
            assert np.interp(view, angles, f) == pytest.approx(peak / 4.0 if scaling else peak, rel=1e-6)
            if scaling and view:
                assert angles[np.argmax(f)] > view + 0.5
            else:
                assert angles[np.argmax(f)] == pytest.approx(view, abs=0.11)
    for low, high in zip(figures.VIEWS[:-1], figures.VIEWS[1:], strict=True):
        assert all(sizes[model, high][0] > sizes[model, low][0] for model in figures.PROJECTIONS)
    assert all(sizes["disk_scaling", view][1] > 1.5 * sizes["disk_orthogonal", view][1] for view in figures.VIEWS)


@pytest.mark.parametrize("angle", figures.TURNS)
@pytest.mark.parametrize(("model", "projection"),
                         [("disk_scaling", disk.SCALING), ("disk_orthogonal", disk.ORTHOGONAL)])
def test_half_vectors_of_a_lump_are_the_lump(model, projection, angle):
    # At most as large as the scaling model keeps it at this view.
    radius = min(0.8, 1.0 - math.sin(math.radians(angle)))
    h = on_disk(angle, 0.999)
    found = figures.half_vector_density(model, angle, h, projection, radius_u=radius, radius_v=radius, exponent=3.0)
    np.testing.assert_allclose(found, lump(h, radius, 3.0), rtol=1e-6, atol=1e-6)
    assert np.count_nonzero(found) > 0  # some points lie inside


def test_half_vectors_of_other_models():
    # The orthogonal projection has p = f; a light is its point's distance from the disk's centre.
    h = on_disk(50.0, 0.99)
    view = np.array([math.sin(math.radians(50.0)), 0.0, math.cos(math.radians(50.0))])
    plane = h - view[:2]
    light = np.concatenate([plane, np.sqrt(1.0 - (plane**2).sum(axis=-1, keepdims=True))], axis=-1)
    blinn = 28.0 / (8.0 * math.pi) * ((view + light)[:, 2] / np.linalg.norm(view + light, axis=-1)) ** 20
    np.testing.assert_allclose(figures.half_vector_density("blinn", 50.0, h, exponent=20.0), blinn, **TINY)
    phong = 22.0 / (2.0 * math.pi) * np.maximum(light @ (view * [-1.0, -1.0, 1.0]), 0.0) ** 20
    np.testing.assert_allclose(figures.half_vector_density("phong", 50.0, h, exponent=20.0), phong, **TINY)

    # Colours are averaged; the raw data fit (eq. 35, 36) is a constant and two lumps on the disk, cut off by its rim.
    white, low = (1.0 - math.cos(math.radians(50.0))) ** 5, np.array([0.2, 0.4, 0.9])
    fresnel = np.mean(low + (1.0 - low) * white)
    given = {"base_color": tuple(low), "f90": (1.0, 1.0, 1.0), "diffuse_color": (0.3, 0.3, 0.3), "renormalize": False,
             "exponent": 40.0, "radius": 0.9, "blend": 0.25, "second_exponent": 6.0, "second_radius": 0.7}
    fit = (1.0 - fresnel) * 0.3 / math.pi + fresnel * (0.75 * lump(h, 0.9, 40.0) + 0.25 * lump(h, 0.7, 6.0))
    np.testing.assert_allclose(figures.half_vector_density("edwards_fit", 50.0, h, **given), fit, **TINY)


@pytest.mark.parametrize("projection", [disk.SCALING, disk.ORTHOGONAL])
@pytest.mark.parametrize("angle", [0.0, 60.0])
def test_the_volume_on_the_disk_is_the_albedo(projection, angle):
    step = 0.01
    image = figures.half_vector_image("phong", angle, projection, step, exponent=20.0)
    low_u, high_u, low_v, high_v = figures.WINDOW
    assert image.shape == (round((high_v - low_v) / step), round((high_u - low_u) / step))
    inside = np.isfinite(image)
    assert inside.sum() * step**2 == pytest.approx(math.pi, rel=2e-3)
    columns = inside.any(axis=0).nonzero()[0]
    assert low_u + step * (columns.mean() + 0.5) == pytest.approx(math.sin(math.radians(angle)), abs=step)
    albedo = MODELS["phong"].albedo(math.cos(math.radians(angle)), exponent=20.0)[0]
    assert np.nansum(image) * step**2 == pytest.approx(albedo, rel=5e-3)


def test_points_off_the_disk_have_no_density():
    rim = np.array([[math.sin(math.radians(30.0)) + r, 0.0] for r in (1.0, 1.2, -1.4)])
    assert np.isnan(figures.half_vector_density("blinn", 30.0, rim)).all()
    with pytest.raises(ValueError, match="no figure"):
        figures.draw("nothing")


def test_figures_are_written_as_png_and_svg(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    assert cli.main(["figures", "disk", "--output", str(tmp_path)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2 * len(figures.SET)
    for name in figures.SET:
        png, svg = ((tmp_path / f"disk_{name}.{ending}").read_bytes() for ending in ("png", "svg"))
        assert png.startswith(b"\x89PNG") and len(png) > 20000
        assert b"<svg" in svg[:2000] and len(svg) > 20000


def test_other_models_can_be_compared_too():
    pytest.importorskip("matplotlib")
    from matplotlib.text import Text

    figure = figures.draw_half_vectors([("phong_limit", {"exponent": 30.0}, "Limit")], disk.SCALING)
    assert len(figure.axes) == len(figures.TURNS) + 1  # and the colours' bar
    assert any("scaling projection" in text.get_text() for text in figure.findobj(Text))
    assert "Limit" in figure.axes[0].get_ylabel()
