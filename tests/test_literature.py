"""The literature's models: formulas against ones written anew, symmetry, energy, sampling, and their extremes.

The formulas of truth/literature.py are scalar, written from the sources with `math`, and integrated by a plain midpoint
rule.
"""
import math

import numpy as np
import pytest
from optics.directions import binned, directions
from optics.names import name_of
from optics.shapes import OTHER, PUMPED_SHAPES
from scipy import stats
from truth.hemisphere import NODES, half_vectors, integrated
from truth.literature import by_hand
from truth.quadrature import view_at

from addon.brdf import MODELS
from addon.forms.albedo.tabulated import TABULATED
from addon.models import samplers
from addon.models.formula_model import FormulaModel
from addon.models.pumped_model import PumpedModel, pumped

FORMULAS = {name: model for name, model in MODELS.items() if isinstance(model, FormulaModel)}
PUMPED = {name: model for name, model in FORMULAS.items() if isinstance(model, PumpedModel)}
PLAIN = {name: model for name, model in FORMULAS.items() if name not in PUMPED}
SHAPES = [(name, given) for name in PLAIN for given in ({}, OTHER[name])]
ENDS = [(name, {p.id: end}) for name, model in PLAIN.items() for p in model.parameters if p.evaluated
        for end in (p.minimum, p.maximum) if p.kind == "float" and math.isfinite(p.maximum)]


@pytest.mark.parametrize("name, given", SHAPES, ids=name_of)
def test_formula(name, given):
    model = MODELS[name]
    p = model.resolve(given)
    view, light = directions(60, seed=1), directions(60, seed=2)
    light[::3] = view[::3] * [-1.0, -1.0, 1.0] + 0.1 * light[::3]  # where sharp lobes are
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    value = model.evaluate(view, light, **given)
    value = value if value.ndim == 2 else np.repeat(value[:, None], 3, axis=1)
    expected = np.array([by_hand(name, v, x, p) for v, x in zip(view.tolist(), light.tolist(), strict=True)])
    assert expected.max() > 0.05
    accuracy = 3e-4 if name == "ndf_map" else 2e-6  # of the image's integral
    np.testing.assert_allclose(value, expected, rtol=accuracy, atol=1e-12 * expected.max())


@pytest.mark.parametrize("name, given", SHAPES + PUMPED_SHAPES, ids=name_of)
def test_reciprocity(name, given):
    """f(V, L) = f(L, V), of all but Kajiya and Kay's strands, which are lit by their own cosine."""
    view, light = directions(400, seed=3, least=1e-3), directions(400, seed=4, least=1e-3)
    one, other = (MODELS[name].evaluate(*pair, **given) for pair in ((view, light), (light, view)))
    if MODELS[name].symmetric:
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-300)
    else:
        assert name == "kajiya_kay"
        assert np.abs(one - other).max() > 0.1 * one.max()
        # Surfaces of many such strands would be: without the cosine of the surface.
        np.testing.assert_allclose((one.T * light[:, 2] / np.sqrt(1.0 - light[:, 0] ** 2)).T,
                                   (other.T * view[:, 2] / np.sqrt(1.0 - view[:, 0] ** 2)).T, rtol=1e-9)


# Energy.


@pytest.mark.parametrize("mu", [0.05, 0.4, 1.0])
@pytest.mark.parametrize("name, given", SHAPES + PUMPED_SHAPES, ids=name_of)
def test_albedo(name, given, mu):
    model = MODELS[name]
    p = model.resolve(given)
    found = model.albedo(mu, **given)[0]
    if model.spike:
        found = found - model.spike(np.array([mu]), p)[0]
    expected = integrated(model, view_at(mu), given)
    np.testing.assert_allclose(found, expected, rtol=3e-3, atol=1e-4)


def test_albedos_that_are_known():
    """Lambert's part; powers of the half vector seen from above; what bounds and what does not."""
    up = 1.0
    assert MODELS["phong_original"].albedo(up, exponent=30.0)[0] == pytest.approx(2.0 * math.pi / 32.0, rel=1e-6)
    tinted = MODELS["cook_torrance"].albedo(up, base_color=(0.0, 0.0, 0.0), diffuse_color=(0.2, 0.4, 0.6))[0]
    np.testing.assert_allclose(tinted, (0.2, 0.4, 0.6), rtol=2e-4)
    # V-shaped grooves lose nothing where each facet is seen: sharp ones seen from above.
    assert MODELS["cook_torrance"].albedo(up, roughness=0.05)[0] == pytest.approx(1.0, abs=2e-3)
    assert MODELS["ward_duer"].albedo(0.5, roughness_u=0.05, roughness_v=0.05)[0] == pytest.approx(1.0, abs=0.02)
    grazing = np.cos(np.radians([80.0, 88.0]))
    assert MODELS["ward"].albedo(grazing, roughness_u=0.1, roughness_v=0.1).max() < 0.25
    for m in (0.1, 0.3, 1.0):
        assert MODELS["ward_bounded"].albedo(grazing, roughness_u=m, roughness_v=m).max() <= 1.0 + 1e-3
    for n in (5.0, 100.0):
        assert MODELS["ashikhmin_shirley"].albedo(np.array([0.02, 0.3, 1.0]), exponent_u=n,
                                                  exponent_v=n).max() <= 1.0 + 1e-3


def growth(model_id, **given):
    """Power of N·V that an albedo grows by at the horizon."""
    mu = np.array([1e-5, 1e-6])
    albedo = MODELS[model_id].albedo(mu, **given)
    return math.log(albedo[1] / albedo[0]) / math.log(mu[1] / mu[0])


@pytest.mark.parametrize("m", [0.1, 0.5])
def test_growth_towards_grazing(m):
    """Neumann et al., section 2.1: Ward's albedo grows as (N·V)^-1/2, Dür's as (N·V)^-1.

    Cook and Torrance's would grow as Dür's did their geometry term stay 1, as that section has it; but the term goes
    with N·V to 0 for all lights off the mirror direction, and the albedo to 1.
    """
    both = {"roughness_u": m, "roughness_v": m}
    assert growth("ward", **both) == pytest.approx(-0.5, abs=0.01)
    assert growth("ward_duer", **both) == pytest.approx(-1.0, abs=0.01)
    assert growth("ward_bounded", **both) == pytest.approx(0.0, abs=0.01)
    assert growth("cook_torrance", roughness=m) == pytest.approx(0.0, abs=0.01)
    assert MODELS["cook_torrance"].albedo(1e-6, roughness=m)[0] <= 1.0 + 1e-3


@pytest.mark.parametrize("name, given", PUMPED_SHAPES, ids=name_of)
def test_pumping_conserves_any_symmetric_formula(name, given):
    """Pumped once or more no albedo passes 1, and the last pump is a division by the larger of two albedos."""
    model = MODELS[name]
    mu = np.cos(np.radians([0.0, 30.0, 60.0, 80.0, 88.0]))
    albedo = model.albedo(mu, **given)
    assert albedo.max() <= 1.0 + 2e-3 and (albedo > 0.05).all()
    once = {**given, "pumps": 1.0, "control": False}
    view, light = view_at(0.3), view_at(0.8) * [-1.0, 1.0, 1.0]
    p = model.resolve(given)
    own = {q.id: p[q.id] for q in model.base.parameters if q.id in p and q.evaluated}
    a = [integrated(model.base, x, own) for x in (view, light)]
    expected = model.base.evaluate(view, light, **own) / max(a)
    np.testing.assert_allclose(model.evaluate(view, light, **once), expected, rtol=5e-3)


@pytest.mark.parametrize("name", ["pumped_ward", "pumped_ward_duer"])
def test_pumping_holds_at_the_horizon(name):
    """Below a cosine of 1e-4 albedos that grow as a power go on growing: by 10 and 100 at 1e-6."""
    albedo = MODELS[name].albedo(np.array([1e-6, 1e-5]), roughness_u=0.3, pumps=1.0, control=False)
    np.testing.assert_allclose(albedo, 1.0, atol=0.01)


def test_lobes_of_no_light_and_of_too_much_are_numbers():
    """Lafortune's lobes may look below the horizon, and grow as 1.2^n."""
    nothing = {f"{c}_{i}": -1.0 for c in ("cxy", "cz") for i in (1, 2, 3)}
    view, light = directions(50, seed=12), directions(50, seed=13)
    light[:, :2] = np.abs(light[:, :2]) * np.sign(view[:, :2])  # where C_xy < 0 shows nothing
    assert (MODELS["pumped_lafortune"].evaluate(view, light, pumps=4.0, control=False, **nothing) == 0.0).all()
    up = (0.0, 0.0, 1.0)
    much = MODELS["lafortune"].evaluate(up, up, cz_1=1.2, exponent_1=1e4, base_color=(1.0, 0.5, 0.0))[0]
    assert np.isfinite(much).all() and much[0] > 1e30 and much[1] == pytest.approx(0.5 * much[0], rel=1e-12)


def test_the_one_mechanism_pumps_as_tables_do():
    """Blinn's lobe through tables, through their integrals, and through those that any formula is pumped by."""
    mu = np.cos(np.radians([0.0, 40.0, 70.0, 85.0]))
    for given in ({"pumps": 1.0, "control": False}, {"pumps": 2.5, "control": True}):
        own = MODELS["pumped_blinn_fresnel"].albedo(mu, exponent=20.0, **given)
        for model in (MODELS["pumped_blinn"], MODELS["pumped_blinn"].with_albedos(TABULATED)):
            np.testing.assert_allclose(own, model.albedo(mu, exponent=20.0, **given), rtol=2e-3)


def test_only_symmetric_formulas_are_pumped():
    with pytest.raises(ValueError, match="kajiya_kay is not symmetric"):
        pumped(MODELS["kajiya_kay"])


def test_he_torrance_at_its_ends():
    """A smooth surface is Fresnel's mirror; a rough one scatters as Beckmann's microfacets of slope 2 sigma / tau."""
    mu = np.array([0.3, 0.9])
    smooth = {"sigma": 0.01, "tau": 20.0, "wavelength": 0.78, "base_color": (0.5, 0.5, 0.5)}
    p = MODELS["he_torrance"].resolve(smooth)
    spike = MODELS["he_torrance"].spike(mu, p)[:, 0]
    np.testing.assert_allclose(spike, 0.5 * np.exp(-((4.0 * np.pi * 0.01 * mu / 0.78) ** 2)), rtol=1e-3)
    np.testing.assert_allclose(MODELS["he_torrance"].albedo(mu, **smooth)[:, 0], 0.5, rtol=0.01)
    rough = {"sigma": 1.0, "tau": 10.0, "wavelength": 0.38}
    m = 2.0 * 1.0 / 10.0
    view = view_at(math.cos(0.5))
    for tilt in (-0.2, 0.0, 0.1):
        h = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
        light = 2.0 * (h @ view) * h - view
        d = math.exp(-((math.tan(tilt) / m) ** 2)) / (math.pi * m * m * math.cos(tilt) ** 4)
        found = MODELS["he_torrance"].evaluate(view, light, **rough)[0]
        assert found == pytest.approx(d / (4.0 * view[2] * light[2]), rel=0.02)


# Sampling.


@pytest.mark.parametrize("mu", [0.1, 0.8])
@pytest.mark.parametrize("name, given", SHAPES, ids=name_of)
def test_samples_follow_the_pdf(name, given, mu):
    """Chi-square over 10 x 12 bins of the sphere, what is expected by integrating .pdf; f N·L / pdf is the albedo."""
    model = MODELS[name]
    view, count = view_at(mu), 20000
    light = model.sample(view, np.random.default_rng(5).random((count, 2)), **given)
    np.testing.assert_allclose(np.linalg.norm(light, axis=1), 1.0, rtol=1e-9)
    pdf = model.pdf(view, light, **given)
    assert np.isfinite(pdf).all() and (pdf > 0.0).all()
    value = model.evaluate(view, light, **given)
    value = (value if value.ndim == 1 else value[:, 1]) * np.maximum(light[:, 2], 0.0) / pdf
    albedo = np.reshape(model.albedo(mu, **given), -1)
    spike = model.spike(np.array([mu]), model.resolve(given))[0, 1] if model.spike else 0.0
    expected = albedo[1 % len(albedo)] - spike
    assert abs(value.mean() - expected) < 5.0 * value.std() / math.sqrt(count) + 1e-3 * expected
    found, wanted = binned(light), density_binned(model, given, view) * count
    rare = wanted < 10.0
    found, wanted = (np.append(x[~rare], x[rare].sum()) for x in (found, wanted))
    assert wanted.sum() == pytest.approx(count, rel=5e-3)
    wanted *= found.sum() / wanted.sum()
    keep = wanted > 1.0
    chi2 = ((found - wanted)[keep] ** 2 / wanted[keep]).sum()
    assert stats.chi2.sf(chi2, max(keep.sum() - 1, 1)) > 1e-5


def density_binned(model, given, view):
    """Integral of .pdf over each bin, over half vectors, upper ones seen from either side: one leads to each light."""
    h, area = half_vectors(round(float(model.width(model.resolve(given))), 4), *NODES.get(model.id, ()))
    facing = h @ view
    light = 2.0 * facing[:, None] * h - view
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    return binned(light, model.pdf(view, light, **given) * 4.0 * np.abs(facing) * area)


# Extremes.


@pytest.mark.parametrize("name, given", ENDS, ids=name_of)
def test_extremes_are_finite_and_not_negative(name, given):
    model = MODELS[name]
    view, light = directions(300, seed=6, least=1e-6), directions(300, seed=7, least=1e-6)
    view[:20], light[:20] = (0.0, 0.0, 1.0), (0.0, 0.0, 1.0)
    light[20:60] = view[20:60] * [-1.0, -1.0, 1.0]
    value = model.evaluate(view, light, **given)
    assert np.isfinite(value).all() and value.min() >= 0.0
    drawn = model.sample(view[:50], np.random.default_rng(8).random((50, 2)), **given)
    assert np.isfinite(drawn).all() and np.isfinite(model.pdf(view[:50], drawn, **given)).all()
    albedo = model.albedo(np.array([1e-3, 0.5, 1.0]), **given)
    assert np.isfinite(albedo).all() and albedo.min() >= 0.0


def test_half_vectors_of_a_power_go_around_as_their_density_says():
    """Between any two azimuths there are as many as the density has there, integrated over the height."""
    sampler, count, bins = samplers.HalfPower(2.0, 40.0), 100000, 24
    v = (np.arange(count) + 0.5) / count
    h = sampler.draw(np.stack([np.full(count, 0.5), v], axis=-1))
    found = np.histogram(np.arctan2(h[:, 1], h[:, 0]), bins, (-np.pi, np.pi))[0] / count
    x, w = np.polynomial.legendre.leggauss(40)
    z, phi = 0.5 * (x + 1.0), -np.pi + (np.arange(60 * bins) + 0.5) * 2.0 * np.pi / (60 * bins)
    density = sampler.density(samplers.half_vectors(z[:, None], phi).reshape(-1, 3)).reshape(len(z), bins, 60)
    wanted = np.einsum("zbp,z->b", density, 0.5 * w) * 2.0 * np.pi / (60 * bins)
    np.testing.assert_allclose(found, wanted, atol=5e-4)
