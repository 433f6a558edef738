"""Stand-ins by Blender's Principled BSDF: the formula's integrals, what a fit finds, and the errors that it states.

That the formula is what Cycles renders is shown in test_render_principled.py.
"""
import json
from dataclasses import replace

import numpy as np
import pytest

from addon import cli
from addon.backends.nodes import principled_bsdf as bsdf
from addon.backends.nodes import principled_fit
from addon.backends.nodes.appearance import appearance
from addon.backends.osl import estimator
from addon.brdf import MODELS, roughness_of_exponent
from addon.library.metals import METALS
from addon.models.errors import ParameterError
from addon.models.geometry import view_at

GOLD, BLUE = (1.0, 0.784, 0.342), (0.1, 0.25, 0.6)


def midpoints(rings=110, turns=120):
    """Lights (N, 3) above the horizon and their N·L dω, evenly over the disk below them."""
    r = np.sqrt((np.arange(rings) + 0.5) / rings)
    phi = 2.0 * np.pi * (np.arange(turns) + 0.5) / turns
    x, y = (r[:, None] * f(phi) for f in (np.cos, np.sin))
    light = np.stack([x, y, np.broadcast_to(np.sqrt(1.0 - r * r)[:, None], x.shape)], axis=-1).reshape(-1, 3)
    return light, np.full(len(light), np.pi / len(light))


def errors(evaluate, inputs, views):
    """The two errors in %, of `evaluate(view, light)` and the formula, by another quadrature than the package's."""
    light, weight = midpoints()
    lobe, sky = [], []
    for view in views:
        seen = np.broadcast_to(view, light.shape)
        wanted, found = evaluate(seen, light), bsdf.evaluate(inputs, seen, light)
        wanted = wanted if wanted.ndim == 2 else np.repeat(wanted[:, None], 3, axis=1)
        total = (wanted * weight[:, None]).sum()
        lobe.append((np.abs(wanted - found) * weight[:, None]).sum() / total)
        sky.append(np.abs(((wanted - found) * weight[:, None]).sum(axis=0)).sum() / total)
    return 100.0 * np.mean(lobe), 100.0 * np.mean(sky)


VIEWS = view_at(np.cos(np.radians(principled_fit.VIEWS)))


def test_albedo_of_white_ggx():
    assert bsdf.seen_normals(np.array([1.0]), 1.0)[1].sum() == pytest.approx(1.0 - np.log(2.0), abs=3e-4)
    light, weight = midpoints()
    for roughness, mu in ((0.5, 1.0), (0.5, 0.5), (0.8, 0.2), (1.0, 0.6)):
        view = np.broadcast_to(view_at(mu), light.shape)
        whole = (bsdf.ggx(view, light, roughness**2, roughness**2) * weight).sum()
        assert bsdf.Seen([mu], roughness).white[0] == pytest.approx(whole, abs=3e-3)


def test_furnace_of_the_formula():
    """A white metal reflects all at every roughness and view; lights of a body that is white below add up to 1."""
    for roughness in (0.1, 0.4, 0.7, 1.0):
        for inputs in (bsdf.Inputs((1.0, 1.0, 1.0), 1.0, roughness), bsdf.Inputs((1.0, 1.0, 1.0), 0.0, roughness)):
            assert bsdf.albedo(inputs, np.array([1.0, 0.5, 0.2])) == pytest.approx(1.0, abs=1e-9)
    light, weight = midpoints()
    inputs = bsdf.Inputs(GOLD, 0.3, 0.6)
    value = bsdf.evaluate(inputs, np.broadcast_to(view_at(0.5), light.shape), light)
    assert (value * weight[:, None]).sum(axis=0) == pytest.approx(bsdf.albedo(inputs, [0.5])[0], abs=3e-3)


def test_reflectance_of_an_index():
    cosine = np.array([1.0, 0.6, 0.1])
    n, transmitted = 1.5, np.sqrt(1.0 - (1.0 - cosine**2) / 1.5**2)
    across, along = (cosine - n * transmitted) / (cosine + n * transmitted), \
        (n * cosine - transmitted) / (n * cosine + transmitted)
    np.testing.assert_allclose(bsdf.dielectric(cosine, n), 0.5 * (across**2 + along**2), rtol=1e-12)
    assert bsdf.reflectance_of(1.5) == pytest.approx(0.04)
    assert bsdf.ior_of(0.04) == pytest.approx(1.5)
    assert bsdf.effective_ior(bsdf.Inputs(GOLD, 0.0, 0.5, ior=1.5, specular=1.0)) == pytest.approx(bsdf.ior_of(0.08))


class _Node:
    """A model that is Principled itself, so that a fit can be perfect."""

    axes, spike = ("u", "v"), None

    def __init__(self, inputs, narrower=1.0):
        self.inputs, self.narrower = inputs, narrower

    def resolve(self, given):
        return {"rotation": self.inputs.rotation, "diffuse_color": self.inputs.base_color, **given}

    def stretched(self, values):
        along, across = bsdf.alphas(1.0, self.inputs.anisotropic)
        return along, across

    def width(self, values):
        return self.narrower * self.inputs.roughness**2

    def with_albedos(self, albedos):
        return self

    def evaluate_fast(self, view, light, values):
        # The body alone is black where diffuse_color is.
        black = not any(values["diffuse_color"]) and self.inputs.metallic < 1.0
        color = (0.0, 0.0, 0.0) if black else self.inputs.base_color
        return bsdf.evaluate(replace(self.inputs, base_color=color, rotation=values["rotation"]), view, light)


@pytest.mark.parametrize("inputs", [
    bsdf.Inputs(GOLD, 1.0, 0.3), bsdf.Inputs(GOLD, 1.0, 0.7), bsdf.Inputs(BLUE, 0.0, 0.4),
    bsdf.Inputs(BLUE, 0.0, 0.25, ior=2.0), bsdf.Inputs(GOLD, 1.0, 0.4, anisotropic=0.7, rotation=0.15)])
@pytest.mark.parametrize("narrower", [0.6, 1.5])
def test_fit_finds_the_inputs_that_made_it(inputs, narrower):
    """Also where the model's own word about its width is wrong by half."""
    found = principled_fit.fit(_Node(inputs, narrower), {})
    assert found.roughness == pytest.approx(inputs.roughness, rel=0.03)
    assert found.base_color == pytest.approx(inputs.base_color, abs=0.02)
    assert (found.metallic, found.anisotropic) == pytest.approx((inputs.metallic, inputs.anisotropic), abs=1e-6)
    if inputs.metallic < 1.0:
        assert found.ior == pytest.approx(inputs.ior, rel=0.03)
    if inputs.anisotropic:
        assert found.rotation == pytest.approx(inputs.rotation)
    assert found.lobe_error < 4.0 and found.albedo_error < 2.5


@pytest.mark.parametrize("name", MODELS)
def test_every_model_has_a_stand_in(name):
    model = MODELS[name]
    found = principled_fit.fit(model, {})
    for value in (*found.base_color, found.metallic, found.specular, found.anisotropic, found.rotation):
        assert 0.0 <= value <= 1.0
    assert bsdf.SMOOTHEST <= found.roughness <= 1.0 and 1.0 <= found.ior < 100.0
    assert 1.0 < found.lobe_error < 100.0 and 0.0 <= found.albedo_error < 90.0


@pytest.mark.parametrize(("name", "given"), [
    ("pumped_phong", {}), ("pumped_phong", {"base_color": GOLD, "exponent": 60.0}), ("blinn", {}),
    ("cook_torrance", {"roughness": 0.3}), ("edwards_empirical", {}), ("pumped_lafortune", {}),
    ("edwards_empirical", {"base_color": (0.6, 0.34, 0.02), "diffuse_color": (0.75, 0.42, 0.01), "retro": 0.85,
                           "retro_exponent": 60.0})])
def test_errors_are_as_stated_and_least(name, given):
    model = MODELS[name]
    found = principled_fit.fit(model, given)

    def evaluate(view, light):
        return model.evaluate(view, light, **given)

    lobe, sky = errors(evaluate, found, VIEWS)
    assert found.lobe_error == pytest.approx(lobe, rel=0.06, abs=0.5)
    assert found.albedo_error == pytest.approx(sky, abs=1.5)
    for factor in (0.8, 1.25):
        others = errors(evaluate, replace(found, roughness=found.roughness * factor), VIEWS)
        assert sum(others) > lobe + sky


def test_stand_in_tracks_the_parameters():
    model = MODELS["pumped_phong"]
    rough = [principled_fit.fit(model, {"exponent": n}).roughness for n in (5.0, 20.0, 100.0, 2000.0, 50000.0)]
    assert rough == sorted(rough, reverse=True) and rough[0] > 0.5 and rough[-1] < 0.08
    gold = METALS["gold"]
    found = principled_fit.fit(model, {"fresnel_type": "conductor", "ior": gold.ior, "extinction": gold.extinction,
                                   "exponent": 500.0, "pumps": 2.0})
    assert found.metallic == 1.0 and found.base_color == pytest.approx(gold.f0, abs=0.06)
    body = principled_fit.fit(MODELS["edwards_empirical"], {"diffuse_color": BLUE, "exponent": 300.0})
    assert body.metallic == 0.0 and body.base_color == pytest.approx(BLUE, abs=0.02)
    assert body.ior == pytest.approx(1.5, abs=0.1)


@pytest.mark.parametrize("name", [name for name, model in MODELS.items() if not estimator.is_baked(model)])
def test_factors_of_roughness_are_what_fits_find(name):
    model = MODELS[name]
    for exponent in (10.0, 100.0, 3000.0):
        stated = roughness_of_exponent(appearance(model, model.resolve({"exponent": exponent}))[1])
        found = principled_fit.fit(model, {"exponent": exponent}).roughness
        assert principled_fit.ROUGHNESS_FACTORS[name] * stated == pytest.approx(found, rel=0.12)


def test_stretched_lobes_are_turned_as_the_models_are():
    along = principled_fit.fit(MODELS["ward"], {"roughness_u": 0.4, "roughness_v": 0.1})
    across = principled_fit.fit(MODELS["ward"], {"roughness_u": 0.1, "roughness_v": 0.4})
    assert along.anisotropic == across.anisotropic == pytest.approx(0.75 / 0.9)
    assert (along.rotation, across.rotation) == (0.0, 0.25)
    turned = principled_fit.fit(MODELS["disk_scaling"], {"radius_u": 0.1, "rotation": 0.1})
    assert turned.rotation == pytest.approx(0.35) and turned.anisotropic == 1.0
    # The formula's turn is the model's: the highlights lie on each other, and not on their mirror images.
    given = {"radius_u": 0.1, "rotation": 0.1}
    aside = np.radians(np.array([0.35, -0.35]) * 360.0)
    light = np.stack([np.sin(0.3) * np.cos(aside), np.sin(0.3) * np.sin(aside), np.full(2, np.cos(0.3))], axis=-1)
    view = np.tile([0.0, 0.0, 1.0], (2, 1))
    model = MODELS["disk_scaling"].evaluate(view, light, **given)
    formula = bsdf.evaluate(turned, view, light)[:, 0]
    assert model[0] > 2.0 * model[1] and formula[0] > 2.0 * formula[1]


def test_black_models_have_a_black_stand_in():
    found = principled_fit.fit(MODELS["pumped_phong"], {"base_color": (0.0, 0.0, 0.0)})
    assert found.base_color == (0.0, 0.0, 0.0) and found.ior == 1.0 and found.metallic == 0.0
    with pytest.raises(ParameterError) as caught:
        principled_fit.fit(MODELS["phong"], {"exponent": -1.0})
    assert caught.value.parameter == "exponent"


def test_quick_values_of_pumped_models_are_near():
    light, _ = midpoints(24, 24)
    view = np.broadcast_to(view_at(0.5), light.shape)
    for name in ("pumped_ward", "pumped_blinn_fresnel"):
        model = MODELS[name]
        exact = model.evaluate(view, light)
        quick = model.evaluate_fast(view, light, model.resolve({}))
        assert np.abs(quick / exact - 1.0)[exact > 1e-6 * exact.max()].max() < 0.02


def test_command(capsys):
    assert cli.main(["match", "--native"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:]] == list(MODELS)
    assert all(line.count("%") == 2 for line in lines[1:])
    assert cli.main(["match", "--native", "--from", "phong", "--set", "exponent=80", "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)
    assert entry["model"] == "phong"
    assert entry["roughness"] == principled_fit.fit(MODELS["phong"], {"exponent": 80.0}).roughness


@pytest.mark.parametrize("argv", [["--native", "--to", "phong"], ["--native", "--set", "exponent=3"],
                                  ["--from", "phong"], ["--to", "phong"], ["--native", "--from", "wart"]])
def test_wrong_calls_are_one_line(argv, capsys):
    assert cli.main(["match", *argv]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1
