"""Matching by the half-angle against closed forms; fits that find what is known; wrong calls and tables."""
import json
import math

import numpy as np
import pytest
from scipy import optimize
from truth import quadrature

from addon import brdf, cli
from addon.brdf import MODELS
from addon.fitting import fit, minimax, samples
from addon.fitting import match as matching
from addon.fitting.match import match
from addon.models.pumped_model import PumpedModel

# f(N, L) / f(N, N) over the half vector's angle b, of the formulas in the papers; G is that of V-shaped grooves.
NORMALISED = {
    "blinn": lambda b, n: math.cos(b) ** n,
    "phong": lambda b, n: math.cos(2.0 * b) ** n,
    "phong_limit": lambda b, n: math.cos(2.0 * b) ** n,
    "ward": lambda b, m: math.exp(-(math.tan(b) / m) ** 2) / math.sqrt(math.cos(2.0 * b)),
    "ward_duer": lambda b, m: math.exp(-(math.tan(b) / m) ** 2) / math.cos(2.0 * b),
    "cook_torrance": lambda b, m: (math.exp(-(math.tan(b) / m) ** 2) / math.cos(b) ** 4 / math.cos(2.0 * b)
                                   * min(1.0, 2.0 * math.cos(b), 2.0 * math.cos(2.0 * b))),
    "ashikhmin_shirley": lambda b, n: math.cos(b) ** (n - 1.0),
    # Edwards et al. eq. 24 is the density of sin 2b, eq. 20 that of tan b over (N·L)(L·H)(N·H)^3.
    "disk_orthogonal": lambda b, n: (1.0 - math.sin(2.0 * b) ** 2) ** n,
    "disk_scaling": lambda b, n: (1.0 - math.tan(b) ** 2) ** n / (math.cos(2.0 * b) * math.cos(b) ** 4),
}
# Half-angles in closed form.
EXACT = {"blinn": lambda n: math.acos(0.5 ** (1.0 / n)), "phong": lambda n: 0.5 * math.acos(0.5 ** (1.0 / n)),
         "disk_orthogonal": lambda n: 0.5 * math.asin(math.sqrt(1.0 - 0.5 ** (1.0 / n)))}
# Of models that are pumped for the parameters at hand, which takes some tenths of a second each time, one is enough.
AT_HAND = {name for name, model in MODELS.items() if isinstance(model, PumpedModel)}
ROUND_TRIPS = [name for name, model in MODELS.items()
               if name not in AT_HAND - {"pumped_ward"} and name != "kajiya_kay" and model.width_parameter]


@pytest.mark.parametrize("model_id", MODELS)
def test_every_model_says_what_widens_its_lobe(model_id):
    model = MODELS[model_id]
    ids = {p.id for p in model.parameters if p.kind == "float" and p.evaluated}
    assert set(model.widths) <= ids
    assert model.axes in ((), tuple(f"{model.axes[0][:-1]}{end}" for end in "uv") if model.axes else ())
    assert (model.width_parameter is None) == (model_id == "ndf_map")
    if model_id in AT_HAND or model.width_parameter is None:
        return
    values = matching.complete(model, {})
    name = model.width_parameter
    low, high = (matching.half_angles(model, {**values, name: values[name] * k})[0] for k in (0.8, 1.25))
    assert abs(math.log(high / low)) > 0.1


@pytest.mark.parametrize("model_id", NORMALISED)
@pytest.mark.parametrize("beta", [2.0, 8.0, 20.0])
def test_half_of_the_normalised_lobe_is_where_it_is_wanted(model_id, beta):
    """From an exponent whose half-angle has a closed form, to a shape with which the written formula is a half."""
    n = math.log(0.5) / math.log(math.cos(math.radians(beta)))
    found = match("blinn", {"exponent": n}, model_id)
    assert found.wanted == pytest.approx((beta, beta), rel=1e-6)
    assert found.half_angles == pytest.approx((beta, beta), rel=1e-6) and found.held == ()
    value = NORMALISED[model_id](math.radians(beta), found.parameters[MODELS[model_id].width_parameter])
    assert value == pytest.approx(0.5, rel=1e-5)


@pytest.mark.parametrize("model_id", EXACT)
@pytest.mark.parametrize("n", [3.0, 60.0, 5000.0])
def test_half_angles_in_closed_form(model_id, n):
    model = MODELS[model_id]
    angles = matching.half_angles(model, matching.complete(model, {"exponent": n}))
    assert angles == pytest.approx((EXACT[model_id](n),) * 2, rel=1e-7)


def test_known_equivalents():
    """Of sharp lobes: Phong's power of R·L is like four times that power of N·H, and Beckmann's m like √(2/n)."""
    assert match("phong", {"exponent": 2000.0}, "blinn").parameters["exponent"] == pytest.approx(8000.0, rel=2e-3)
    m = match("blinn", {"exponent": 5000.0}, "cook_torrance").parameters["roughness"]
    assert m == pytest.approx(0.02, rel=1e-3)
    smooth = match("cook_torrance", {"roughness": 0.2}, "embrechts").parameters["smoothness"]
    assert smooth == pytest.approx(5.0, rel=1e-3)  # Smith's masking differs from the grooves' by little there


@pytest.mark.parametrize("model_id", ROUND_TRIPS)
def test_there_and_back(model_id):
    model = MODELS[model_id]
    given = matching.complete(model, {})
    if not model.power_bases:  # which stand for their exponents, and are not moved alone
        given.update({name: 1.1 * given[name] for name in set(model.widths) - set(model.axes)})
    between = "ashikhmin_shirley" if model.axes else "cook_torrance"
    back = match(between, match(model_id, given, between).parameters, model_id).parameters
    for name in model.widths:
        assert back[name] == pytest.approx(given[name], rel=1e-5), name


def test_stretched_lobes_along_and_across():
    found = match("ward", {"roughness_u": 0.3, "roughness_v": 0.1}, "ashikhmin_shirley")
    for name, m in (("exponent_u", 0.3), ("exponent_v", 0.1)):
        beta = optimize.brentq(lambda b, m=m: NORMALISED["ward"](b, m) - 0.5, 1e-3, 0.6)
        assert NORMALISED["ashikhmin_shirley"](beta, found.parameters[name]) == pytest.approx(0.5, rel=1e-5)
    # A round model gets the geometric mean; a lump its exponent by the wider axis and a radius for the other.
    angles = found.wanted
    assert match("ward", {"roughness_u": 0.3, "roughness_v": 0.1}, "blinn").half_angles == pytest.approx(
        (math.sqrt(angles[0] * angles[1]),) * 2, rel=1e-6)
    for u, v in ((0.3, 0.1), (0.1, 0.3)):
        lump = match("ward", {"roughness_u": u, "roughness_v": v}, "disk_scaling")
        assert lump.half_angles == pytest.approx(lump.wanted, rel=1e-6)
        radii = lump.parameters["radius_u"], lump.parameters["radius_v"]
        assert radii[u < v] == 1.0 and radii[u > v] < 0.5


def test_strands_have_one_width():
    found = match("kajiya_kay", {}, "ward")
    assert math.isinf(found.wanted[1]) and found.half_angles[0] == pytest.approx(found.wanted[0], rel=1e-6)
    assert match("ward", found.parameters, "kajiya_kay").parameters["exponent"] == pytest.approx(50.0, rel=1e-5)


def test_what_goes_along_and_what_is_dropped():
    found = match("pumped_phong", {"pumps": 2.5, "control": False, "base_color": 0.3}, "pumped_blinn")
    assert found.parameters["pumps"] == 2.5 and found.parameters["control"] is False
    assert found.parameters["base_color"] == (0.3, 0.3, 0.3) and found.dropped == ()
    assert match("pumped_phong", {}, "blinn").dropped == ("pumps", "control")
    assert match("edwards_empirical", {"retro": 0.2}, "cook_torrance").dropped == (
        "retro", "retro_exponent", "retro_radius_u", "retro_radius_v")
    assert match("edwards_empirical", {}, "cook_torrance").dropped == ()
    back = match("blinn", {"use_roughness": True, "roughness": 0.3}, "phong").parameters
    assert back["use_roughness"] and brdf.exponent_of_roughness(back["roughness"]) == pytest.approx(back["exponent"])


def test_colours_go_along():
    """In the words of a model that says them otherwise: what is reflected at normal and at grazing incidence."""
    copper = {"fresnel_type": "schlick", "base_color": (0.9, 0.6, 0.5), "f90": (1.0, 0.9, 0.8)}
    lump = match("blinn", copper, "disk_scaling")
    assert lump.parameters["base_color"] == (0.9, 0.6, 0.5) and lump.parameters["f90"] == (1.0, 0.9, 0.8)
    assert match("disk_scaling", lump.parameters, "blinn").parameters["fresnel_type"] == 1
    flat = match("ward", {"base_color": (0.9, 0.6, 0.5)}, "disk_scaling").parameters
    assert flat["base_color"] == flat["f90"] == (0.9, 0.6, 0.5)
    metal = match("blinn", {"fresnel_type": "conductor", "ior": 1.5, "extinction": 0.0}, "ward")
    assert metal.parameters["base_color"] == pytest.approx((0.04, 0.04, 0.04))  # ((1.5 - 1) / (1.5 + 1))²
    assert metal.dropped == ("fresnel_type", "ior")
    assert match("ashikhmin_shirley", {"base_color": 0.5}, "blinn").parameters["fresnel_type"] == 1


def test_out_of_reach():
    with pytest.raises(ValueError, match=r"reciprocal_disk: a half-angle of 32.77 degrees .* 1 to 100000 .* 22.15 deg"):
        match("blinn", {"exponent": 4.0}, "reciprocal_disk")
    held = match("blinn", {"exponent": 4.0}, "reciprocal_disk", hold=True)
    assert held.held == ("exponent",) and held.parameters["exponent"] == 1.0
    assert match("phong", {"exponent": 1e5}, "ward", hold=True).parameters["roughness_u"] == pytest.approx(0.01)
    with pytest.raises(ValueError, match="blinn: f does not fall to half"):
        match("blinn", {"exponent": 1.0}, "phong")
    assert match("blinn", {"exponent": 1.0}, "phong", hold=True).parameters["exponent"] == 1.0
    with pytest.raises(ValueError, match="no lobe"):
        match("weighted_lobes", {f"weight_{i}": 0.0 for i in (1, 2, 3)}, "blinn")


def one_line(capsys):
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1 and "Traceback" not in printed.err
    return printed.err


def test_match_command(capsys):
    assert cli.main(["match", "--from", "blinn", "--to", "ward", "--set", "exponent=50"]) == 0
    text = capsys.readouterr().out
    assert "9.518°" in text and "roughness_u=0.19" in text and "seen from 75°" in text
    assert cli.main(["match", "--from", "ward", "--to", "blinn", "--set", "roughness_u=0.3", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["half_angles_deg"]["source"][0] > report["half_angles_deg"]["target"][0]
    # The distance between the lobes is that of the formulas, on lights that the command does not use.
    there = np.array([[-math.sin(a), 0.0, math.cos(a)] for a in np.linspace(-1.5, 1.5, 3001)])
    view = [math.sin(math.radians(45.0)), 0.0, math.cos(math.radians(45.0))]
    t = [MODELS[i].evaluate(view, there, **p) * there[:, 2]
         for i, p in (("ward", {"roughness_u": 0.3}), ("blinn", report["parameters"]))]
    in_plane = np.abs(t[1] - t[0]).max() / t[0].max()
    assert report["largest_difference_of_peak"][1]["difference"] >= 0.97 * in_plane


@pytest.mark.parametrize(("argv", "words"), [
    (["--from", "blin", "--to", "ward"], ("'blin'", "blinn")),
    (["--from", "blinn", "--to", "wart"], ("'wart'", "ward_duer")),
    (["--from", "blinn", "--to", "ward", "--set", "exponent=0"], ("exponent: 0", "1 .. 100000")),
    (["--from", "blinn", "--to", "ward", "--set", "roughness_u=1"], ("roughness_u", "exponent")),
    (["--from", "phong", "--to", "ward", "--set", "exponent=100000"], ("0.1067", "0.01 to 1", "0.477")),
])
def test_bad_match_calls(argv, words, capsys):
    assert cli.main(["match", *argv]) == 2
    error = one_line(capsys)
    assert all(word in error for word in words)


# Fits.


def lights(polar=400, turns=180):
    """Midpoints over the hemisphere's half y > 0, (N, 3), and their solid angles, counted for both halves."""
    theta, phi = np.meshgrid((np.arange(polar) + 0.5) * 0.5 * np.pi / polar, (np.arange(turns) + 0.5) * np.pi / turns,
                             indexing="ij")
    area = 2.0 * np.sin(theta) * (0.5 * np.pi / polar) * (np.pi / turns)
    light = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    return light.reshape(-1, 3), area.ravel()


def blinn_weighted(view, light, n):
    h = (view + light)[:, 2] / np.sqrt(((view + light) ** 2).sum(axis=1))
    return (n + 8.0) / (8.0 * np.pi) * h**n * light[:, 2]


def cook_torrance_weighted(view, light, m, scale):
    h = (view + light) / np.sqrt(((view + light) ** 2).sum(axis=1))[:, None]
    c = h[:, 2]
    g = np.minimum(1.0, 2.0 * c * np.minimum(view[2], light[:, 2]) / (h @ view))
    return scale * np.exp(-(1.0 / c**2 - 1.0) / m**2) / (4.0 * np.pi * m * m * c**4) * g / view[2]


@pytest.fixture(scope="module")
def cook_to_blinn():
    return fit.to_model("cook_torrance", "blinn", {"exponent": 50.0})


def test_the_errors_are_those_of_the_formulas(cook_to_blinn):
    """On lights that the fit does not use, with the formulas and the definition of the error written anew."""
    found, (light, area) = cook_to_blinn, lights()
    for values, said in ((found.start, found.start_errors), (found.parameters, found.errors)):
        seen, sky = [], []
        for degrees in range(0, 61, 10):
            view = np.array([math.sin(math.radians(degrees)), 0.0, math.cos(math.radians(degrees))])
            true = blinn_weighted(view, light, 50.0)
            value = cook_torrance_weighted(view, light, values["roughness"], values["base_color"][0])
            seen.append((np.abs(value - true) / (np.minimum(value, true) + 0.05 * true.max())).max())
            a, b = value @ area, true @ area
            sky.append(abs(a - b) / min(a, b))
        assert max(seen) == pytest.approx(said[0], rel=0.02)
        assert max(sky) == pytest.approx(said[1], rel=2e-3)
    assert found.between == pytest.approx(found.errors, rel=0.05)
    exact = [quadrature.exact_a0("blinn", math.cos(math.radians(view)), 50.0) for view in samples.VIEWS]
    np.testing.assert_allclose(found.samples.albedos(found.samples.value)[:, 0], exact, rtol=1e-3)


def test_the_fit_is_a_minimum(cook_to_blinn):
    """Whichever way the parameters are moved, by a little or by much, the larger of both errors grows."""
    found = cook_to_blinn
    assert max(found.errors) < 0.5 * max(found.start_errors)
    rng = np.random.default_rng(1)
    for size in (0.01, 0.3):
        for a, b in rng.uniform(-size, size, (30, 2)):
            moved = {**found.parameters, "roughness": found.parameters["roughness"] * math.exp(a),
                     "base_color": (found.parameters["base_color"][0] * math.exp(b),) * 3}
            assert max(samples.largest(samples.errors(found.samples, found.model, moved))) >= max(found.errors) * 0.9999


def test_a_fit_with_a_known_answer():
    """A factor on the lobe that keeps its albedo, against one whose albedo falls: the mean in logarithms is best."""
    n = 2000.0
    found = fit.to_model("phong_limit", "phong", {"exponent": n}, free=["base_color"])
    a = [quadrature.albedo(lambda v, light: quadrature.f0("phong", v, light, n) / np.maximum(v[..., 2], light[..., 2]),
                           "phong", mu, n) / quadrature.exact_a0("phong", mu, n) for mu in (1.0, 0.5)]
    assert found.parameters["base_color"][0] == pytest.approx(1.0 / math.sqrt(a[0] * a[1]), rel=2e-3)
    assert found.errors[1] == pytest.approx(math.sqrt(max(a) / min(a)) - 1.0, rel=5e-3)
    assert found.parameters["exponent"] == pytest.approx(n, rel=1e-6)


@pytest.mark.parametrize(("model_id", "target_id", "given"), [
    ("pumped_blinn", "cook_torrance", {"roughness": 0.3}), ("weighted_lobes", "pumped_phong", {}),
    ("ashikhmin_shirley", "ward", {"roughness_u": 0.3, "roughness_v": 0.1}), ("cook_torrance", "he_torrance", {}),
    ("blinn_fresnel", "cook_torrance", {"base_color": (0.9, 0.6, 0.3), "fresnel_type": "schlick"}),
])
def test_a_fit_is_never_worse_than_the_match(model_id, target_id, given):
    found = fit.to_model(model_id, target_id, given)
    assert max(found.errors) <= max(found.start_errors)
    assert max(found.between) <= 1.15 * max(found.errors) and max(found.between) < max(found.start_between)


def test_a_target_given_by_roughness():
    """The exponent is what is fitted, and the roughness that is reported stands for it."""
    found = fit.to_model("phong", "phong_limit", {"roughness": 0.3}, views=[0.0, 10.0]).parameters
    assert found["use_roughness"] is False
    assert found["exponent"] == pytest.approx(brdf.exponent_of_roughness(0.3), rel=0.02)
    assert found["roughness"] == pytest.approx(0.3, rel=0.01)


def test_fits_are_repeatable(cook_to_blinn):
    assert fit.to_model("cook_torrance", "blinn", {"exponent": 50.0}).parameters == cook_to_blinn.parameters


TABLE = {"cook_torrance": ({"roughness": 0.31, "base_color": (0.9, 0.6, 0.3)}, {}),
         "pumped_blinn": ({"exponent": 33.0, "pumps": 1.5, "control": False, "base_color": 0.7}, {"control": False}),
         "embrechts": ({"smoothness": 4.0, "base_color": 0.6}, {})}


def write_table(path, model_id, given, polar=range(0, 90, 3), around=range(0, 181, 15), views=(0, 25, 50)):
    """A model's values as a table, in an order of columns of its own."""
    rows = []
    for v, t, p in ((v, t, p) for v in views for t in polar for p in around):
        a, b, c = (math.radians(x) for x in (v, t, p))
        f = MODELS[model_id].evaluate([math.sin(a), 0.0, math.cos(a)],
                                      [math.sin(b) * math.cos(c), math.sin(b) * math.sin(c), math.cos(b)], **given)[0]
        rows.append(",".join(f"{x:.9g}" for x in (p, *np.atleast_1d(f), v, t)))
    names = "f_r,f_g,f_b" if np.ndim(f) else "f"
    path.write_text("# made for a test\n\n" + "\n".join([f"phi,{names},theta_view,theta_light", *rows]) + "\n")
    return path


@pytest.mark.parametrize("model_id", TABLE)
def test_a_model_is_found_in_its_own_table(model_id, tmp_path):
    given, own = TABLE[model_id]
    path = write_table(tmp_path / "t.csv", model_id, given)
    found = fit.to_table(model_id, path, own=own)
    expected = MODELS[model_id].resolve(given)
    for name in given:
        assert found.parameters[name] == pytest.approx(expected[name], rel=0.01), name
    assert max(found.errors) < 1e-3 < max(found.start_errors) and found.between is None


def test_a_table_adds_up_to_the_albedo(tmp_path):
    model, n = MODELS["blinn"], 20.0
    path = write_table(tmp_path / "t.csv", "blinn", {"exponent": n}, polar=[*range(0, 90, 2), 89.9])
    table = samples.of_table(path)
    exact = [quadrature.exact_a0("blinn", math.cos(math.radians(view)), n) for view in (0, 25, 50)]
    np.testing.assert_allclose(table.albedos(table.value)[:, 0], exact, rtol=5e-3)
    # All around, without the last azimuth; and not at all where rows are missing.
    whole = write_table(tmp_path / "w.csv", "blinn", {"exponent": n}, polar=[*range(0, 90, 2), 89.9],
                        around=range(0, 360, 15))
    np.testing.assert_allclose(samples.of_table(whole).albedos(samples.of_table(whole).value)[:, 0], exact, rtol=5e-3)
    part = write_table(tmp_path / "p.csv", "blinn", {"exponent": n}, polar=range(0, 40, 2))
    assert not samples.of_table(part).integrable.any()
    found = fit.to_table("blinn", part)
    assert found.errors[1] is None and found.parameters["exponent"] == pytest.approx(n, rel=1e-3)
    assert samples.half_angle(table) == pytest.approx(matching.half_angle(model, {"exponent": n}, 0.0), rel=1e-3)


HEAD = "theta_view,theta_light,phi,f\n"


@pytest.mark.parametrize(("text", "words"), [
    ("", ["no header line"]), (HEAD, ["no rows"]), ("# only a comment\n", ["no header line"]),
    ("theta_view,theta_light,f\n0,0,1\n", ["line 1", "phi", "theta_view, theta_light, f"]),
    ("theta_view,theta_light,phi,f_r,f_g\n0,0,0,1,1\n", ["line 1", "f_r, f_g, f_b"]),
    ("# two\n" + HEAD + "0,0,0,1\n0,10,0\n", ["line 4", "expected 4 values, got 3"]),
    (HEAD + "0,0,0,nan\n", ["line 2", "f: nan"]), (HEAD + "0,0,0,-0.5\n", ["line 2", "f: -0.5"]),
    (HEAD + "0,0,0,inf\n", ["line 2", "f: inf"]), (HEAD + "0,95,0,1\n", ["line 2", "theta_light: 95", "0 .. 90"]),
    (HEAD + "90,0,0,1\n", ["theta_view: 90"]), (HEAD + "0,0,400,1\n", ["phi: 400", "-360 .. 360"]),
    (HEAD + "0,0,0,one\n", ["f: expected a number", "'one'"]), (HEAD + "0,0,0,0\n", ["every value of f is 0"]),
])
def test_wrong_tables(text, words, tmp_path, capsys):
    path = tmp_path / "table.csv"
    path.write_text(text)
    assert cli.main(["fit", "blinn", "--table", str(path)]) == 2
    error = one_line(capsys)
    assert "table.csv" in error and all(word in error for word in words)


@pytest.mark.parametrize(("argv", "words"), [
    (["blin", "--to", "ward"], ("'blin'", "blinn")), (["blinn", "--to", "wart"], ("'wart'",)),
    (["blinn", "--table", "nowhere.csv"], ("nowhere.csv",)),
    (["blinn", "--to", "ward", "--set", "roughness_u=2"], ("roughness_u: 2", "0.01 .. 1")),
    (["blinn", "--to", "ward", "--with", "exponent=0"], ("exponent: 0", "1 .. 100000")),
    (["blinn", "--to", "ward", "--free", "samples"], ("samples", "exponent, base_color")),
    (["blinn", "--to", "ward", "--free", "colour"], ("'colour'", "exponent")),
    (["blinn", "--to", "ward", "--floor", "0"], ("floor: 0", "0.001 .. 1")),
    (["blinn", "--to", "ward", "--views", "10", "89"], ("89", "0 .. 85")),
    (["blinn", "--table", "t.csv", "--set", "exponent=3"], ("--set", "--to")),
])
def test_bad_fit_calls(argv, words, capsys):
    assert cli.main(["fit", *argv]) == 2
    error = one_line(capsys)
    assert all(word in error for word in words)


def test_fit_command(capsys, tmp_path):
    argv = ["fit", "cook_torrance", "--to", "blinn", "--set", "exponent=50", "--output", str(tmp_path)]
    assert cli.main([*argv, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    errors = {key: max(report[key]["largest_relative_error"].values()) for key in ("matched", "fitted")}
    assert errors["fitted"] < errors["matched"] and report["free"] == ["roughness", "base_color"]
    assert report["target_parameters"]["exponent"] == 50.0
    assert [path.suffix for path in sorted(tmp_path.iterdir())] == [".png", ".svg"]
    assert sorted(map(str, tmp_path.iterdir())) == report["files"]
    assert cli.main(argv[:-2]) == 0
    text = capsys.readouterr().out
    assert "matched by width" in text and f"roughness={report['fitted']['parameters']['roughness']:.6g}" in text


def test_a_fit_can_be_cancelled(monkeypatch, capsys):
    def interrupted(*arguments, **settings):
        raise KeyboardInterrupt

    monkeypatch.setattr(fit, "fit", interrupted)
    assert cli.main(["fit", "blinn", "--to", "ward"]) == 130
    assert one_line(capsys) == "plausible fit: cancelled\n"


def test_minimax_reaches_the_best_line():
    """Chebyshev's: the straight line nearest to x² on 0..1 is x - 1/8, off by 1/8; here with both moved into 0..1."""
    x = np.linspace(0.0, 1.0, 1001)
    found, worst = minimax.minimise(lambda p: (2.0 * p[0] - 1.0) + 2.0 * p[1] * x - x**2, [0.9, 0.1])
    assert worst == pytest.approx(0.125, rel=1e-6) and found == pytest.approx([0.4375, 0.5], abs=1e-5)
    # What changes nothing stays, and a solution at a bound is found.
    found, worst = minimax.minimise(lambda p: np.array([p[0] + 0.5, 0.1]), [0.7, 0.3])
    assert found.tolist() == [0.0, 0.3] and worst == 0.5
