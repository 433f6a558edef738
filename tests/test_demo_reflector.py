"""The reflector's pictures: radiance point by point against the formulas, widths, and what the comparison measures."""
import json
import math

import numpy as np
import pytest

from addon.brdf import MODELS

bpy = pytest.importorskip("bpy")
from addon.dev.demo import reflector  # noqa: E402

pytestmark = pytest.mark.blender
RESOLUTION = (64, 60)
POINT, TOTAL = 0.02, 0.01  # allowed errors, of the peak and of all light


def expected(surface, resolution):
    """Radiance (height, width) at the pixels' centres, first row at the bottom; NaN beside the bowl.

    f(V, L) (N·L) I / d² with I = P / (4 pi) W/sr, Blender's radiant intensity of a white point lamp of P watts; rays
    are cut with the paraboloid x² + y² = 4 F z.
    """
    width, height = resolution
    view = reflector.towards_camera()
    across = (np.arange(width) + 0.5 - 0.5 * width) * reflector.VIEW_WIDTH / width
    upwards = (np.arange(height) + 0.5 - 0.5 * height) * reflector.VIEW_WIDTH / width
    x, u = np.meshgrid(across, upwards)
    up = np.array([0.0, view[2], -view[1]])
    origin = np.array(reflector.CENTRE) + x.ravel()[:, None] * [1.0, 0.0, 0.0] + u.ravel()[:, None] * up
    four_f = 4.0 * reflector.FOCUS
    a, b = view[1] ** 2, 2.0 * origin[:, 1] * view[1] - four_f * view[2]
    c = origin[:, 0] ** 2 + origin[:, 1] ** 2 - four_f * origin[:, 2]
    root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    radiance = np.full(width * height, np.nan)
    for t in ((-b - root) / (2.0 * a), (-b + root) / (2.0 * a)):  # the one nearer to the camera last
        point = origin + t[:, None] * view
        hit = (b * b > 4.0 * a * c) & (point[:, 2] < reflector.RIM**2 / four_f)
        radiance[hit] = reflected(surface, point[hit], view)
    return radiance.reshape(height, width)


def reflected(surface, point, view):
    """Radiance (N,) from `point` (N, 3) of the bowl towards `view`."""
    normal = np.stack([-point[:, 0], -point[:, 1], np.full(len(point), 2.0 * reflector.FOCUS)], axis=-1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    light = np.array(reflector.LAMP) - point
    distance = np.linalg.norm(light, axis=1)
    light /= distance[:, None]
    tangent = np.cross(normal, [0.36, 0.48, 0.8])
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    frame = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    local_light = np.einsum("nij,nj->ni", frame, light)
    f = MODELS[surface.model].evaluate(frame @ view, local_light, **surface.parameters)
    f = f if f.ndim == 1 else f[:, 0]
    intensity = reflector.LAMP_POWER / (4.0 * math.pi)
    return f * np.maximum(local_light[:, 2], 0.0) * intensity / distance**2


@pytest.fixture(scope="module")
def bowl():
    """The scene and its reflector, at RESOLUTION."""
    scene, body = reflector.build(RESOLUTION)
    reflector.prepare(scene, 384)
    return scene, body


@pytest.mark.parametrize("model", ["ward", "pumped_phong", "he_torrance"])
def test_radiance_is_what_the_formula_says(model, bowl, tmp_path):
    """At points of the figure, each a mean over 3 x 3 pixels, and in all."""
    surface = next(s for s in reflector.surfaces() if s.model == model)
    reflector.dress(bowl[1], surface)
    _, seeds = reflector._render_twice(bowl[0], tmp_path, model)
    found, truth = seeds.mean(axis=0), expected(surface, RESOLUTION)
    peak = np.nanmax(truth)
    row, column = np.unravel_index(np.nanargmax(truth), truth.shape)
    for up, across in ((0, 0), (4, 0), (-4, 2), (1, -4), (0, 5)):
        box = slice(row + up - 1, row + up + 2), slice(column + across - 1, column + across + 2)
        noise = 0.5 * np.diff(seeds[:, *box], axis=0).std() / 3.0
        assert noise < 0.006 * peak and truth[box].mean() > 0.1 * peak
        assert found[box].mean() == pytest.approx(truth[box].mean(), abs=POINT * peak + 5.0 * noise)
    assert found.sum() == pytest.approx(np.nansum(truth), rel=TOTAL)


def test_all_are_as_wide_as_the_reference():
    """Half of the peak at one angle beta of the half vector, the view at the normal, the light at 2 beta."""
    beta, found = reflector.half_angle(), {s.model: s.parameters for s in reflector.surfaces()}
    assert list(found) == ["he_torrance", "cook_torrance", "ashikhmin_shirley", "ward", "phong", "pumped_phong"]
    light = [[0.0, 0.0, 1.0], [math.sin(2.0 * beta), 0.0, math.cos(2.0 * beta)]]
    for model, given in found.items():
        f = MODELS[model].evaluate([0.0, 0.0, 1.0], light, **given).reshape(2, -1)[:, 0]
        assert f[1] / f[0] == pytest.approx(0.5, abs=1e-6)
    assert math.cos(2.0 * beta) ** found["phong"]["exponent"] == pytest.approx(0.5, abs=1e-6)
    # Ashikhmin and Shirley's power over V·H, Ward's exponential over the root of N·L.
    assert math.cos(beta) ** (found["ashikhmin_shirley"]["exponent_u"] - 1.0) == pytest.approx(0.5, abs=1e-6)
    ward = math.exp(-((math.tan(beta) / found["ward"]["roughness_u"]) ** 2)) / math.sqrt(math.cos(2.0 * beta))
    assert ward == pytest.approx(0.5, abs=1e-6)


def test_comparing_figures_of_known_difference():
    """Two bells, the second three times as bright and with a ripple of 20 % of the first's root mean square."""
    rng = np.random.default_rng(5)
    x = np.linspace(-3.0, 3.0, 200)
    bell = np.exp(-(x[:, None] ** 2) - x**2)
    ripple = np.sin(8.0 * x) * np.ones((200, 1))
    ripple *= 0.2 * math.sqrt(np.mean(bell**2) / np.mean(ripple**2))
    noise = 0.1 * rng.standard_normal((4, 200, 200))
    same = reflector.compare(bell + noise[:2], bell + noise[2:])
    other = reflector.compare(3.0 * (bell + ripple + noise[:2]), bell + noise[2:])
    true_noise = math.hypot(1.0, 1.0) * 0.1 * 200.0 / math.sqrt(2.0) / bell.sum()
    assert same["flux"] == pytest.approx(1.0, abs=5.0 * true_noise)
    assert same["flux_noise"] == pytest.approx(true_noise, rel=0.05)
    assert same["difference"] < 5.0 * same["difference_noise"] and same["difference_noise"] < 0.05
    assert other["flux"] == pytest.approx(3.0, abs=15.0 * true_noise)
    assert other["difference"] == pytest.approx(0.2, abs=5.0 * other["difference_noise"])
    assert 0.0 < other["difference_noise"] < 0.02


def test_pictures_and_numbers_are_written(tmp_path, monkeypatch, capsys):
    image = pytest.importorskip("matplotlib.image")
    from addon import cli

    monkeypatch.setattr(reflector, "REFERENCE", ("phong", {"exponent": 37.0}))
    monkeypatch.setattr(reflector, "MATCHED", ("pumped_phong",))
    arguments = ["demo", "reflector", "--output", str(tmp_path), "--samples", "1", "--resolution", "48x45"]
    assert cli.main(arguments) == 0
    assert str(tmp_path / "light_points.png") in capsys.readouterr().out
    assert image.imread(tmp_path / "reflector_pumped_phong.png").shape[:2] == (45, 96)
    text = json.loads((tmp_path / "reflector.json").read_text(encoding="utf-8"))
    assert text["reference"] == "phong" and [entry["model"] for entry in text["models"]] == ["phong", "pumped_phong"]
    measured = text["models"][1]
    assert measured["flux"] > 1.1 and 0.0 < measured["flux_noise"] < 0.1 * measured["flux"]
    assert set(measured) == {"model", "parameters", "flux", "flux_noise", "difference", "difference_noise"}
