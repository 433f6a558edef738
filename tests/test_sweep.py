"""Ten thousand sets of parameters of every model, drawn at random over the ranges that it declares, ends included.

None gives what is no number, or less than nothing, seen from anywhere; what is drawn has a density; and no light is
made by those that say so. Albedos that a model divides by come from the tables in so many sets, and are integrated in
fewer, as that costs up to some tenths of a second a set. A model's own albedos cost some twenty milliseconds a set and
are looked at in fewer sets, but for lumps that stay on the disk: each of their draws has the weight f (N·L) / pdf of
the albedo itself, which is known.
"""
from dataclasses import replace

import numpy as np
import pytest
from truth.quadrature import view_at

from addon.brdf import MODELS
from addon.forms.albedo.tabulated import TABULATED
from addon.models import fresnel
from addon.models.pumped_model import PumpedModel

pytestmark = pytest.mark.proof

SETS, PAIRS, POOL = 10_000, 32, 4096
SHAPES = 4  # of models that integrate their albedos for a second for each: all else varies from set to set
INTEGRATIONS = 60  # sets for which the albedos that a model divides by are integrated
COLOURS = ("color", "enum")
FLATTEST = 1e-9  # cosine of the flattest directions
ALBEDOS = 60  # sets of which the albedo is looked at, from COSINES; of pumped formulas SHAPES
COSINES = np.array([1e-6, 1e-3, 0.03, 0.3, 0.7, 1.0])


# Sets of parameters.

def value_of(q, rng):
    """A value of a parameter: every tenth at an end of its range, otherwise even over it, or over its logarithm."""
    if q.kind in ("bool", "enum"):
        return int(rng.integers(int(q.minimum), int(q.maximum) + 1))
    if q.kind == "color":
        return tuple(np.where(rng.random(3) < 0.2, rng.integers(0, 2, 3), rng.random(3) ** 2)
                     * (q.maximum - q.minimum) + q.minimum)
    if rng.random() < 0.1:
        return q.maximum if rng.random() < 0.5 else q.minimum
    if q.logarithmic:
        low, high = np.log1p([q.minimum, q.maximum])
        return float(np.clip(np.expm1(rng.uniform(low, high)), q.minimum, q.maximum))
    return float(rng.uniform(q.minimum, q.maximum))


def evaluated(model):
    return [q for q in model.parameters if q.evaluated and q.kind not in ("vector", "image")]


def sets(model, rng, count=SETS):
    """So many sets of a model's parameters, one after the other.

    Pumped formulas have few shapes, each of its own number of stages; images are turned in few ways, as each is read
    for it.
    """
    pumped = isinstance(model, PumpedModel)
    few = pumped or model.id == "ndf_map"
    shapes = [{q.id: value_of(q, rng) for q in evaluated(model) if q.kind not in COLOURS} for _ in range(SHAPES)]
    for i in range(count):
        given = {q.id: value_of(q, rng) for q in evaluated(model)}
        if few:
            shape = shapes[i % SHAPES]
            given.update({k: v for k, v in shape.items() if k != "pumps"})
        if pumped:
            given["pumps"] = float(min(i % SHAPES + 1.0 - rng.random() * (rng.random() < 0.8), 4.0))
        yield given


# Directions.

def upper(count, rng):
    """Unit vectors (count, 3) above the horizon: every fourth within a billionth to a tenth of it, some the normal."""
    mu = np.where(np.arange(count) % 4 == 0, 10.0 ** -rng.uniform(1.0, 9.0, count), rng.random(count))
    mu[rng.random(count) < 0.06] = 1.0
    mu = np.maximum(mu, FLATTEST)
    phi = np.where(rng.random(count) < 0.1, 0.0, rng.uniform(0.0, 2.0 * np.pi, count))
    s = np.sqrt((1.0 - mu) * (1.0 + mu))
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)


def pool(rng):
    """(views, lights) (POOL, 3): lights anywhere, at the view itself, at its mirror direction and close about that."""
    view, light = upper(POOL, rng), upper(POOL, rng)
    mirrored = view * [-1.0, -1.0, 1.0]
    about = mirrored + 10.0 ** -rng.uniform(1.0, 6.0, (POOL, 1)) * rng.normal(size=(POOL, 3))
    about[:, 2] = np.maximum(np.abs(about[:, 2]), FLATTEST)
    about /= np.linalg.norm(about, axis=1, keepdims=True)
    kind = rng.integers(0, 6, POOL)[:, None]
    return view, np.select([kind == 0, kind == 1, kind == 2], [mirrored, view, about], light)


def uniform(rng):
    """Numbers (POOL, 2) to draw by, some of them at the ends of the unit square."""
    u = rng.random((POOL, 2))
    ends = rng.random((POOL, 2)) < 0.03
    return np.where(ends, np.round(u), u)


def faults(model, given, view, light, u):
    """What is wrong with a model of these parameters, in words; empty where all is well."""
    drawn = model.sample(view, u, **given)
    if not np.isfinite(drawn).all() or np.abs(np.linalg.norm(drawn, axis=1) - 1.0).max() > 1e-9:
        return ["draws no unit vector"]
    views, lights = np.concatenate([view, view]), np.concatenate([light, drawn])
    f, pdf = model.evaluate(views, lights, **given), model.pdf(views, lights, **given)
    found = []
    if not np.isfinite(f).all():
        found.append("f is no number")
    elif f.min() < 0.0:
        found.append("f is negative")
    if not np.isfinite(pdf).all() or pdf.min() < 0.0:
        found.append("no density")
    # Where a density ends, or is reached from a view at the horizon, rounding decides: a draw may lie beside it.
    inside = (view[:, 2] > 1e-6) & ((u > 1e-6) & (u < 1.0 - 1e-6)).all(axis=1)
    if (pdf[PAIRS:][inside] <= 0.0).any():
        found.append("drawn where its density is 0")
    return found


def report(model, seed=1, count=SETS):
    """{what is wrong: (how often, the first set)}."""
    rng = np.random.default_rng(seed)
    (view, light), u = pool(rng), uniform(rng)
    found = {}
    for given in sets(model, rng, count):
        here = slice(start := int(rng.integers(0, POOL - PAIRS)), start + PAIRS)
        for what in faults(model, given, view[here], light[here], u[here]):
            found[what] = (found.get(what, (0,))[0] + 1, found.get(what, (0, given))[1])
    return found


@pytest.mark.parametrize("name", MODELS)
def test_numbers_are_numbers(name):
    assert not report(MODELS[name].with_albedos(TABULATED))


@pytest.mark.parametrize("name", [name for name, model in MODELS.items() if model.with_albedos(TABULATED) is not model])
def test_numbers_are_numbers_with_integrated_albedos(name):
    assert not report(MODELS[name], seed=5, count=INTEGRATIONS)


def test_sets_are_what_is_declared():
    """Over all decades, and at both ends."""
    exponents = np.array([given["exponent"] for given in sets(MODELS["phong"], np.random.default_rng(2), 2000)])
    assert (exponents == 1.0).sum() > 50 and (exponents == 1e5).sum() > 50
    assert (np.histogram(np.log10(exponents), 5, (0.0, 5.0))[0] > 200).all()
    assert exponents.min() == 1.0 and exponents.max() == 1e5


# No light is made.

# What conserves energy without a diffuse part, and by how much its albedos may pass 1: rounding, errors of tables
# (within 1e-3 anywhere), of the quadrature or of interpolation between albedos. He-Torrance, Ward, Dür, sums of lobes,
# the first published forms and strands pass 1 by their definition, Blinn near the normal.
EXACT, TABLE, INTEGRATED = 1e-6, 1e-3, 2e-4
CONSERVING = {
    "phong": EXACT, "phong_limit": EXACT, "disk_scaling": EXACT, "disk_orthogonal": EXACT, "edwards_empirical": EXACT,
    "edwards_fit": TABLE, "pumped_phong": TABLE, "pumped_blinn": TABLE, "reciprocal_disk": TABLE,
    "ward_bounded": INTEGRATED, "cook_torrance": INTEGRATED, "cosine_microfacet": INTEGRATED, "embrechts": INTEGRATED,
    "ashikhmin_shirley": INTEGRATED, "ndf_map": EXACT,
}
PUMPED = [name for name, model in MODELS.items() if isinstance(model, PumpedModel)]
# Below a cosine of 1e-4 the albedos that such divide by are extrapolated.
PUMPED_TO, PUMPED_FLAT = 2e-3, 1e-2


def conserving(given):
    """The set without a diffuse part, which is added on top, and pumped once at least."""
    given = {**given, **({"diffuse_color": (0.0, 0.0, 0.0)} if "diffuse_color" in given else {})}
    return {**given, **({"pumps": max(given["pumps"], 1.0)} if "pumps" in given else {})}


def albedos(name, count, seed=3):
    """Largest channel of the albedos (sets, cosines) of a model."""
    rows = []
    for given in sets(MODELS[name], np.random.default_rng(seed), count):
        albedo = MODELS[name].albedo(COSINES, **conserving(given))
        rows.append(albedo if albedo.ndim == 1 else albedo.max(axis=-1))
    return np.array(rows)


@pytest.mark.parametrize("name", CONSERVING)
def test_no_light_is_made(name):
    albedo = albedos(name, ALBEDOS)
    assert np.isfinite(albedo).all() and albedo.min() >= 0.0
    assert albedo.max() <= 1.0 + CONSERVING[name]
    assert albedo.max() > 0.9  # whiteness is among the colours


@pytest.mark.parametrize("name", PUMPED)
def test_pumping_makes_no_light(name):
    albedo = albedos(name, SHAPES)
    assert np.isfinite(albedo).all() and albedo.min() >= 0.0
    assert albedo[:, 1:].max() <= 1.0 + PUMPED_TO and albedo[:, 0].max() <= 1.0 + PUMPED_FLAT


def gray(given):
    """The set with colours of three equal channels, so that all light is drawn in proportion."""
    return {k: (v[1],) * 3 if isinstance(v, tuple) else v for k, v in given.items()}


def weights(name, given, view, u):
    """(f (N·L) / pdf over the albedo that is known, draws) of the first channel of lumps that stay on the disk.

    Draws that end at the very horizon, and what is black, are left out.
    """
    model = MODELS[name]
    light = model.sample(view, u, **given)
    f, pdf = model.evaluate(view, light, **given), model.pdf(view, light, **given)
    f = f if f.ndim == 1 else f[:, 0]
    edge = given.get("f90", (1.0,) * 3)
    factor = fresnel.schlick(view[:, 2], given["base_color"], edge)[:, 0]
    known = factor + (1.0 - factor) * given.get("diffuse_color", (0.0,))[0]
    lit = (light[:, 2] > 1e-9) & (pdf > 0.0) & (known > 1e-9)
    return (f * light[:, 2])[lit] / pdf[lit] / known[lit], light


@pytest.mark.parametrize("name", ["disk_scaling", "edwards_empirical"])
def test_lumps_on_the_disk_lose_nothing_and_make_nothing(name):
    """Two-sided, in all sets: every draw weighs F + (1 - F) C_d, and none is lost below the horizon."""
    rng = np.random.default_rng(4)
    view, u = upper(POOL, rng), rng.uniform(1e-6, 1.0 - 1e-6, (POOL, 2))
    view, counted = view[view[:, 2] > 1e-3], 0
    for given in sets(MODELS[name], rng):
        here = slice(start := int(rng.integers(0, len(view) - 8)), start + 8)
        weight, light = weights(name, gray(given), view[here], u[here])
        np.testing.assert_allclose(weight, 1.0, rtol=1e-6, err_msg=str(given))
        assert light[:, 2].min() > -1e-9, given
        counted += len(weight)
    assert counted > 7 * SETS


# Planted errors.

@pytest.mark.parametrize("wrong, what", [
    (lambda f, light: np.where(light[:, 2] < 3e-9, np.nan, f), "f is no number"),
    (lambda f, light: f - 1e-7 * (light[:, 2] > 0.999999), "f is negative"),
])
def test_a_planted_error_is_found(wrong, what):
    right = MODELS["ward"]
    planted = replace(right, lobe=lambda v, light, p: wrong(right.lobe(v, light, p), light), colour=None, diffuse=None)
    assert what in report(planted, count=2000)


def test_a_planted_density_is_found():
    class Wrong:
        def __init__(self, p):
            self.right = MODELS["phong_original"].sampler({**p, "diffuse_color": (0.0, 0.0, 0.0)})

        def sample(self, view, u):
            return self.right.sample(view, u)

        def pdf(self, view, light):
            return np.where(light[:, 2] < 0.1, 0.0, self.right.pdf(view, light))

    planted = replace(MODELS["phong_original"], sampler=Wrong)
    assert "drawn where its density is 0" in report(planted, count=200)


def test_a_planted_gain_is_found(monkeypatch):
    """A per cent of light too much, of one model that conserves it and one that is pumped until it does."""
    right = MODELS["cook_torrance"]
    monkeypatch.setitem(MODELS, "cook_torrance",
                        replace(right, lobe=lambda v, light, p: 1.01 * right.lobe(v, light, p)))
    assert albedos("cook_torrance", ALBEDOS).max() > 1.0 + 2.0 * INTEGRATED
    rng = np.random.default_rng(4)
    given = gray(next(sets(MODELS["disk_scaling"], rng, 1)))
    view = np.tile(view_at(0.5), (8, 1))
    weight, _ = weights("disk_scaling", {**given, "base_color": (0.5,) * 3}, view, rng.random((8, 2)))
    assert np.abs(1.01 * weight - 1.0).min() > 1e-3
