"""Matching by the half-angle against closed forms; fits that find what is known; wrong calls and tables."""
import json
import math

import numpy as np
import pytest
from scipy import optimize

from addon import brdf, cli
from addon.brdf import MODELS
from addon.brdf.pumped_model import PumpedModel
from addon.fitting import match as matching
from addon.fitting.match import match

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
ROUND_TRIPS = [name for name in MODELS if name not in AT_HAND - {"pumped_ward"} and name != "kajiya_kay"]


def widths(model):
    return {model.shape, *model.alongside, *model.axes}


@pytest.mark.parametrize("model_id", MODELS)
def test_every_model_says_what_widens_its_lobe(model_id):
    model = MODELS[model_id]
    ids = {p.id for p in model.parameters if p.kind == "float" and p.evaluated}
    assert widths(model) <= ids
    assert model.axes in ((), tuple(f"{model.axes[0][:-1]}{end}" for end in "uv") if model.axes else ())
    if model_id in AT_HAND:
        return
    values = matching.complete(model, {})
    low, high = (matching.half_angles(model, {**values, model.shape: values[model.shape] * k})[0] for k in (0.8, 1.25))
    assert abs(math.log(high / low)) > 0.1


@pytest.mark.parametrize("model_id", NORMALISED)
@pytest.mark.parametrize("beta", [2.0, 8.0, 20.0])
def test_half_of_the_normalised_lobe_is_where_it_is_wanted(model_id, beta):
    """From an exponent whose half-angle has a closed form, to a shape with which the written formula is a half."""
    n = math.log(0.5) / math.log(math.cos(math.radians(beta)))
    found = match("blinn", {"exponent": n}, model_id)
    assert found.wanted == pytest.approx((beta, beta), rel=1e-6)
    assert found.half_angles == pytest.approx((beta, beta), rel=1e-6) and found.held == ()
    value = NORMALISED[model_id](math.radians(beta), found.parameters[MODELS[model_id].shape])
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
    given = {**given, **{name: 1.1 * given[name] for name in widths(model) if model.shape not in model.axes
                         and "radius" not in name}}
    between = "ashikhmin_shirley" if model.axes else "cook_torrance"
    back = match(between, match(model_id, given, between).parameters, model_id).parameters
    for name in widths(model):
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
