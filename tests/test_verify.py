"""The instruments, checked on Cycles closures whose formulas are known: right ones must pass and wrong ones fail."""
import json

import numpy as np
import pytest

from addon import cli, measure
from addon.measure import comparison, instruments, scene, specimen, standards
from addon.models.errors import ArgumentError, BrdfError

pytestmark = pytest.mark.blender

SYSTEMATIC = 1e-4  # albedo, or part of the lobe's peak: single precision and the tessellated sphere stay below
LIGHTS = np.array([(0.0, 0.0, 1.0), (-0.6, 0.0, 0.8), (-0.6, 0.48, 0.64), (0.48, -0.36, 0.8), (-0.96, 0.0, 0.28)])
FACTOR = 1.01  # a planted error of one per cent
# Cycles' Ashikhmin-Shirley sampler returns wrong directions where H·V < 0 is likely, so its albedo is only right where
# that is rare: the exponent and angles below. Under a lamp of no size, where nothing is sampled, it is always right.
STANDARDS = {
    "diffuse": (standards.diffuse(), (0.0, 40.0, 80.0)),
    "phong": (standards.phong(20.0), (0.0, 40.0, 60.0, 80.0, 85.0)),
    "ashikhmin_shirley": (standards.ashikhmin_shirley(200.0), (0.0, 40.0, 75.0)),
    "beckmann": (standards.microfacet("beckmann", 0.2), (0.0, 40.0, 60.0)),
    "ggx": (standards.microfacet("ggx", 0.1), (0.0, 30.0, 50.0)),
}


def view_at(angle_deg):
    angle = np.radians(angle_deg)
    return np.array([[np.sin(angle), 0.0, np.cos(angle)]])


def albedo(evaluate, angle_deg, polar=600, azimuthal=600):
    """Integral of f (N·L) by Gauss and midpoint rules, the polar interval cut where N·L = N·V."""
    x, w = np.polynomial.legendre.leggauss(polar // 2)
    edges = np.array([0.0, np.radians(angle_deg), 0.5 * np.pi])
    theta = np.concatenate([a + 0.5 * (x + 1.0) * (b - a) for a, b in zip(edges, edges[1:], strict=False)])
    weight = np.concatenate([0.5 * w * (b - a) for a, b in zip(edges, edges[1:], strict=False)])
    phi = (np.arange(azimuthal) + 0.5) * np.pi / azimuthal
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    light = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).reshape(-1, 3)
    area = (weight[:, None] * np.sin(theta) * 2.0 * np.pi / azimuthal).ravel()
    return float(np.sum(evaluate(view_at(angle_deg), light) * light[:, 2] * area))


@pytest.mark.parametrize("factor", [1.0, FACTOR], ids=["right", "planted error"])
@pytest.mark.parametrize("name", STANDARDS)
def test_furnace(name, factor):
    standard, angles = STANDARDS[name]
    measured, noise = measure.furnace(standard.material(factor), angles, samples=1024)
    reference = np.array([albedo(standard.evaluate, angle) for angle in angles])
    report = measure.compare(measured, reference, noise, SYSTEMATIC)
    if factor == 1.0:
        assert report.verdicts() == [comparison.OK] * len(angles), report.error
    else:
        assert report.verdicts() == [comparison.FAILED] * len(angles), report.error


@pytest.mark.parametrize("factor", [1.0, FACTOR], ids=["right", "planted error"])
@pytest.mark.parametrize("name", STANDARDS)
@pytest.mark.parametrize("view", [0.0, 40.0, 80.0])
def test_goniometer(name, view, factor):
    standard, _ = STANDARDS[name]
    measured, noise = measure.goniometer(standard.material(factor), view, LIGHTS, samples=1)
    reference = standard.evaluate(view_at(view), LIGHTS)
    words = np.array(measure.compare(measured, reference, noise, SYSTEMATIC * reference.max()).verdicts())
    if factor == 1.0:
        assert (words == comparison.OK).all(), measured[:, 0] - reference
    else:  # a per cent of a faint flank is within the allowance
        assert (words[reference > 0.05 * reference.max()] == comparison.FAILED).all()


@pytest.mark.parametrize("name", STANDARDS)
@pytest.mark.parametrize("sun", [0.0, 40.0, 65.0, 80.0])
def test_sphere_under_a_sun(name, sun):
    standard, _ = STANDARDS[name]
    image, lit = measure.sphere_sun(standard.material(), sun, samples=1, resolution=96)
    reference = measure.sphere_reference(standard.evaluate, lit)
    # Faces deviate from the round by 4e-5 radii, which a lobe of exponent n tells about sqrt(n) times more sharply.
    assert measure.l1_error(image, reference, lit.covered) < 3e-3
    assert abs(measure.total_ratio(image, reference, lit.covered) - 1.0) < 2e-3
    assert measure.l1_error(np.flip(image, axis=0), np.flip(reference, axis=0), np.flip(lit.covered, axis=0)) < 3e-3
    if sun > 0.0:  # the sun stands where it was put, not on the other side
        assert measure.l1_error(image[:, ::-1], reference, lit.covered) > 0.1


def test_sphere_under_a_sky_shows_the_albedo():
    picture = measure.sphere(standards.phong(20.0).material(), sky=1.0, samples=64, resolution=32)
    shown, angle = picture.image[16, 24, 0], np.degrees(np.arccos(picture.normal[16, 24, 2]))
    assert shown == pytest.approx(albedo(standards.phong(20.0).evaluate, angle), abs=0.05)
    assert np.isnan(picture.normal[0, 0]).all() and not picture.covered[0, 0]
    assert picture.image[0, 0] == pytest.approx(1.0)


def test_sphere_under_an_area_lamp():
    lamp = ("AREA", (0.0, 0.6, 0.8), {"energy": 100.0, "size": 0.5, "distance": 6.0})
    picture = measure.sphere(standards.diffuse().material(), [lamp], samples=16, resolution=32)
    row, column = np.unravel_index(np.argmax(picture.image[..., 0]), (32, 32))
    assert picture.normal[row, column] @ np.array([0.0, 0.6, 0.8]) > 0.99


def test_standard_error_is_honest():
    """The scatter of repeated measurements is what the pixels' scatter says."""
    material = standards.phong(20.0).material()
    with scene.MeasuringScene(material, scene.PLANE, 16) as place:
        place.sky(1.0)
        place.look_from(view_at(60.0)[0])
        pictures = [place.render(16, seed)[..., 0] for seed in range(24)]
    claimed = np.mean([np.std(p, ddof=1) / np.sqrt(p.size) for p in pictures])
    assert 0.6 < np.std([p.mean() for p in pictures], ddof=1) / claimed < 1.5


def test_mean_and_standard_error_of_known_pixels():
    pixels = np.repeat(np.array([1.0, 2.0, 3.0, 6.0]).reshape(2, 2, 1), 3, axis=2)
    mean, error = instruments._statistics(pixels)
    np.testing.assert_allclose(mean, 3.0)
    np.testing.assert_allclose(error, np.sqrt((4.0 + 1.0 + 0.0 + 9.0) / 3.0 / 4.0))


def test_the_mirrors_side_is_where_the_view_is_not():
    view, mirror = view_at(40.0)[0], measure.in_plane([40.0])[0]
    np.testing.assert_allclose(mirror, view * [-1.0, -1.0, 1.0], atol=1e-12)
    beside = measure.across_lobe(40.0, [10.0])[0]
    assert beside @ mirror == pytest.approx(np.cos(np.radians(10.0))) and beside[1] > 0.0


def test_measuring_twice_gives_the_same_and_leaves_nothing_behind():
    import bpy

    material = standards.diffuse().material()
    kinds = ("scenes", "objects", "meshes", "cameras", "lights", "worlds", "images")
    before = {kind: len(getattr(bpy.data, kind)) for kind in kinds}
    first, second = (measure.goniometer(material, 30.0, LIGHTS, samples=1).value for _ in range(2))
    assert np.array_equal(first, second)
    assert {kind: len(getattr(bpy.data, kind)) for kind in kinds} == before


@pytest.mark.parametrize("argument, call", [
    ("angles_deg", lambda m: measure.furnace(m, [90.0])), ("angles_deg", lambda m: measure.furnace(m, [np.nan])),
    ("angles_deg", lambda m: measure.furnace(m, [])), ("samples", lambda m: measure.furnace(m, [0.0], samples=0)),
    ("resolution", lambda m: measure.furnace(m, [0.0], resolution=2.5)),
    ("view_deg", lambda m: measure.goniometer(m, [0.0, 1.0], LIGHTS)),
    ("lights", lambda m: measure.goniometer(m, 0.0, [(0.0, 0.0, -1.0)])),
    ("lights", lambda m: measure.goniometer(m, 0.0, [(0.0, 0.0, 2.0)])),
    ("view_deg", lambda m: measure.goniometer(m, -5.0, LIGHTS)),
])
def test_wrong_arguments_are_refused(argument, call):
    with pytest.raises(ArgumentError) as caught:
        call(standards.diffuse().material())
    assert caught.value.argument == argument


def test_verdicts():
    report = measure.compare([[1.0] * 3, [1.1] * 3, [0.9] * 3, [np.nan] * 3, [1.0] * 3], np.ones(5),
                            [[0.0] * 3, [1e-3] * 3, [1e-3] * 3, [0.0] * 3, [0.1] * 3], 1e-2)
    assert report.verdicts() == [comparison.OK, *[comparison.FAILED] * 3, comparison.NOISY]
    assert report.verdict == comparison.FAILED
    with pytest.raises(ArgumentError) as caught:
        measure.compare(np.ones((1, 3)), [1.0], np.zeros((1, 3)), 0.0)
    assert caught.value.argument == "tolerance"
    with pytest.raises(BrdfError) as caught:
        measure.compare(np.ones((2, 3)), [1.0], np.zeros((1, 3)), 1.0)
    assert caught.value.code == "shape"


def test_furnace_command_prints_json_and_plots(tmp_path, capfd):
    code = cli.main(["furnace", "phong", "--set", "exponent=50", "--angles", "0", "60", "--samples", "256", "--json",
                     "--output", str(tmp_path / "plot.png")])
    report = json.loads(capfd.readouterr().out)
    assert code == 0 and report["verdict"] == "ok"
    assert [row["angle_deg"] for row in report["rows"]] == [0.0, 60.0]
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_goniometer_command_prints_json_and_plots(tmp_path, capfd):
    code = cli.main(["goniometer", "phong", "--view", "40", "--angles", "20", "40", "60", "--json",
                     "--output", str(tmp_path / "plot.png")])
    report = json.loads(capfd.readouterr().out)
    assert code == 0 and report["largest_error_of_peak"] < 0.02
    assert [sweep["plane"] for sweep in report["sweeps"]] == ["incidence", "across"]
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_a_wrong_material_makes_the_commands_fail(monkeypatch, capfd):
    wrong = specimen.of_model("phong")
    monkeypatch.setattr(specimen, "of_model", lambda *_: specimen.Specimen(
        wrong.title, standards.phong(20.0).material(0.9), wrong.model, wrong.parameters))
    assert cli.main(["furnace", "phong", "--angles", "40", "--samples", "64"]) == 1
    assert cli.main(["goniometer", "phong", "--view", "40", "--angles", "40"]) == 1
    assert capfd.readouterr().out.count("FAILED") == 3


def test_material_of_a_file(tmp_path, capfd):
    import bpy

    made = specimen.of_model("phong", ["exponent=33"]).material
    made.name = "Ours"
    standards.diffuse().material().name = "Chalk"
    with measure.quiet():
        bpy.data.libraries.write(str(tmp_path / "shelf.blend"), {made, bpy.data.materials["Chalk"]}, fake_user=True)
    call = ["furnace", "--blend", str(tmp_path / "shelf.blend"), "--angles", "30", "--samples", "256", "--json"]
    assert cli.main([*call, "--material", "Ours"]) == 0
    ours = json.loads(capfd.readouterr().out)
    assert ours["model"] == "phong" and ours["parameters"]["exponent"] == 33.0 and ours["verdict"] == "ok"
    assert cli.main([*call, "--material", "Chalk"]) == 0
    chalk = json.loads(capfd.readouterr().out)
    assert chalk["verdict"] is None and chalk["rows"][0]["measured"] == pytest.approx([1.0] * 3, abs=1e-4)
    assert cli.main([*call, "--material", "Nothing"]) == 2
    assert "'Chalk'" in capfd.readouterr().err


@pytest.mark.parametrize("arguments, word", [
    (["nonsense"], "no model"), (["phong", "--set", "colour=1"], "no parameter"),
    (["phong", "--set", "exponent"], "form"),
    (["phong", "--set", "exponent=nan"], "outside"), (["phong", "--set", "exponent=wide"], "number"),
    (["phong", "--set", "exponent=2", "--set", "exponent=3"], "twice"), ([], "MODEL"),
    (["--blend", "nowhere.blend", "--material", "m"], "no file"), (["--blend", "nowhere.blend"], "together"),
    (["phong", "--material", "m"], "either"), (["phong", "--tolerance", "0"], "tolerance"),
    (["phong", "--output", "nowhere/plot.png"], "folder"), (["phong", "--output", "plot.doc"], "png"),
    (["phong", "--samples", "0"], "samples"), (["phong", "--set", "fresnel_type=glass"], "schlick"),
])
@pytest.mark.parametrize("command", ["furnace", "goniometer"])
def test_what_a_user_gets_wrong_is_one_line(command, arguments, word, capfd):
    assert cli.main([command, *arguments]) == 2
    said = capfd.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and word in said.err


def test_settings_read_every_kind_of_value():
    from addon import brdf

    values = specimen.settings(brdf.MODELS["pumped_phong"], [
        "control=false", "base_color=0.9,0.6,0.2", "fresnel_type=schlick", "pumps=2", "use_roughness=True"])
    assert values == {"control": False, "base_color": (0.9, 0.6, 0.2), "fresnel_type": 1, "pumps": 2.0,
                      "use_roughness": True}


def test_missing_osl_is_told(monkeypatch, capfd):
    import _cycles

    monkeypatch.setattr(_cycles, "with_osl", False)
    assert cli.main(["furnace", "phong"]) == 2
    assert "Open Shading Language" in capfd.readouterr().err


def test_missing_bpy_is_told(monkeypatch, capfd):
    monkeypatch.setattr(scene.importlib.util, "find_spec", lambda name: None)
    assert cli.main(["goniometer", "phong"]) == 2
    assert "pip install bpy" in capfd.readouterr().err
