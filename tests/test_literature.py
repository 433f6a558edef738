"""The literature's models: formulas against ones written anew, symmetry, energy, sampling, and their extremes.

The formulas here are scalar, written from the sources with `math`, and integrated by a plain midpoint rule.
"""
import math
from functools import lru_cache

import numpy as np
import pytest
from quadrature import view_at
from scipy import ndimage, optimize, special, stats

from addon.brdf import MODELS, exr, samplers, tables
from addon.brdf.formula_model import FormulaModel
from addon.brdf.pumped_model import PumpedModel, pumped
from addon.brdf.tabulated import TABULATED

FORMULAS = {name: model for name, model in MODELS.items() if isinstance(model, FormulaModel)}
PUMPED = {name: model for name, model in FORMULAS.items() if isinstance(model, PumpedModel)}
PLAIN = {name: model for name, model in FORMULAS.items() if name not in PUMPED}
COPPER = {"fresnel_type": "schlick", "base_color": (0.95, 0.64, 0.54)}
# What each model is tried with besides its defaults: another shape, a colour that depends on angle, a diffuse part.
OTHER = {
    "ward": {"roughness_u": 0.4, "roughness_v": 0.1, "base_color": (0.5, 0.4, 0.3), "diffuse_color": (0.1, 0.2, 0.3)},
    "ward_duer": {"roughness_u": 0.1, "roughness_v": 0.3},
    "ward_bounded": {"roughness_u": 0.35, "roughness_v": 0.2, "diffuse_color": (0.2, 0.1, 0.0)},
    "cook_torrance": {"roughness": 0.45, **COPPER},
    "cosine_microfacet": {"exponent": 12.0, **COPPER, "diffuse_color": (0.1, 0.0, 0.0)},
    "he_torrance": {"sigma": 0.18, "tau": 2.4, "wavelength": 0.6, **COPPER},
    "embrechts": {"smoothness": 3.0, "scattering": 0.8, **COPPER},
    "ashikhmin_shirley": {"exponent_u": 10.0, "exponent_v": 120.0, "base_color": (0.5, 0.3, 0.1),
                          "diffuse_color": (0.3, 0.5, 0.7)},
    "lafortune": {"weight_1": 0.5, "exponent_1": 9.0, "cxy_1": -1.1, "cz_1": 0.9, "weight_3": 0.2,
                  "diffuse_color": (0.1, 0.2, 0.0), "base_color": (0.4, 0.5, 0.6)},
    "phong_original": {"exponent": 9.0, "base_color": (0.9, 0.5, 0.2), "diffuse_color": (0.3, 0.2, 0.1)},
    "blinn_original": {"exponent": 9.0, "base_color": (0.9, 0.5, 0.2), "diffuse_color": (0.3, 0.2, 0.1)},
    "blinn_fresnel": {"exponent": 15.0, **COPPER, "diffuse_color": (0.1, 0.1, 0.1)},
    "weighted_lobes": {"weight_1": 0.3, "exponent_1": 60.0, "weight_2": 0.4, "exponent_3": 2.0, **COPPER},
    "ndf_map": {"rotation": 0.07, **COPPER, "diffuse_color": (0.1, 0.2, 0.3)},
    "kajiya_kay": {"exponent": 12.0, "normalized": False, "diffuse_color": (0.1, 0.2, 0.3)},
}
SHAPES = [(name, given) for name in PLAIN for given in ({}, OTHER[name])]
PUMPED_SHAPES = [("pumped_ward", {"roughness_u": 0.3, "pumps": 1.0, "control": False}),
                 ("pumped_ward_duer", {"pumps": 2.0, "control": False}),
                 ("pumped_cook_torrance", {"roughness": 0.3, "pumps": 1.0}),
                 ("pumped_cosine_microfacet", {"exponent": 20.0, "pumps": 3.0}),
                 ("pumped_he_torrance", {"pumps": 1.0, "control": False}),
                 ("pumped_embrechts", {"smoothness": 3.0, "pumps": 2.5}),
                 ("pumped_ashikhmin_shirley", {"exponent_u": 20.0, "pumps": 1.0}),
                 ("pumped_lafortune", {"pumps": 1.0}),
                 ("pumped_blinn_fresnel", {"exponent": 20.0, "pumps": 2.0, "control": False})]
ENDS = [(name, {p.id: end}) for name, model in PLAIN.items() for p in model.parameters if p.evaluated
        for end in (p.minimum, p.maximum) if p.kind == "float" and math.isfinite(p.maximum)]


def name_of(value):
    return str(value) if not isinstance(value, dict) else " ".join(f"{k}={v}" for k, v in value.items()) or "default"


def directions(count, seed, least=0.02):
    """Unit vectors (count, 3) above the horizon, a fifth of them near it."""
    rng = np.random.default_rng(seed)
    mu = rng.uniform(least, 1.0, count)
    mu[::5] = rng.uniform(least, 0.1, len(mu[::5]))
    phi = rng.uniform(0.0, 2.0 * np.pi, count)
    s = np.sqrt(1.0 - mu * mu)
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)


# The formulas, for one view and one light, without colour; a pair where there is a diffuse part that is not 1/pi.


def half_of(v, light):
    h = [a + b for a, b in zip(v, light, strict=True)]
    length = math.sqrt(sum(a * a for a in h))
    return [a / length for a in h]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def ward_peak(v, light, p):
    h = half_of(v, light)
    delta, phi = math.acos(min(h[2], 1.0)), math.atan2(h[1], h[0])
    along = math.cos(phi) ** 2 / p["roughness_u"] ** 2 + math.sin(phi) ** 2 / p["roughness_v"] ** 2
    return math.exp(-math.tan(delta) ** 2 * along) / (4.0 * math.pi * p["roughness_u"] * p["roughness_v"])


def bounded(v, light, p):
    """In the form with H unnormalised, 1/(pi m_x m_y) exp(..) (H·H)/(H·N)^4."""
    h = [a + b for a, b in zip(v, light, strict=True)]
    return 4.0 * ward_peak(v, light, p) * dot(h, h) / h[2] ** 4


def grooves(v, light):
    h = half_of(v, light)
    return min(1.0, 2.0 * h[2] * v[2] / dot(v, h), 2.0 * h[2] * light[2] / dot(v, h))


def cook_torrance(v, light, p):
    m, cos_h = p["roughness"], half_of(v, light)[2]
    d = math.exp(-(math.tan(math.acos(min(cos_h, 1.0))) / m) ** 2) / (math.pi * m * m * cos_h**4)
    return d * grooves(v, light) / (4.0 * v[2] * light[2])


def cosine_microfacet(v, light, p):
    m = p["exponent"]
    return (m + 2.0) / (8.0 * math.pi) * half_of(v, light)[2] ** m * grooves(v, light) / (v[2] * light[2])


def he_torrance(v, light, p):
    """Eq. 76 to 82 with the vectors that the paper has them in; erfc and the root of eq. 81 are SciPy's."""
    sigma, tau, wavelength = p["sigma"], p["tau"], p["wavelength"]
    k_r, k_i = np.array(v), -np.array(light)  # the wave travels towards the surface
    cot = [x[2] / math.hypot(x[0], x[1]) for x in (v, light)]

    def k(c):
        return math.tan(math.atan(1.0 / c)) * special.erfc(tau * c / (2.0 * sigma))

    mean = 0.25 * (k(cot[0]) + k(cot[1]))
    z0 = optimize.brentq(lambda z: math.sqrt(math.pi / 2.0) * z - sigma * mean * math.exp(-0.5 * (z / sigma) ** 2),
                         0.0, 40.0 * sigma * (1.0 + mean), xtol=1e-15, rtol=1e-14)
    effective = sigma / math.sqrt(1.0 + (z0 / sigma) ** 2)
    g = (2.0 * math.pi * effective / wavelength * (v[2] + light[2])) ** 2
    wave = 2.0 * math.pi / wavelength * (k_r - k_i)
    across2 = wave[0] ** 2 + wave[1] ** 2
    m = np.arange(1, int(g + 12.0 * math.sqrt(g) + 60.0))
    series = np.exp(m * math.log(g) - g - across2 * tau * tau / (4.0 * m) - special.gammaln(m + 1.0)) / m
    d = math.pi**2 * tau**2 / (4.0 * wavelength**2) * series.sum()
    n = np.array([0.0, 0.0, 1.0])
    s_i, s_r = np.cross(k_i, n), np.cross(k_r, n)
    s_i, s_r = s_i / np.linalg.norm(s_i), s_r / np.linalg.norm(s_r)
    p_i, p_r = np.cross(s_i, k_i), np.cross(s_r, k_r)
    along = k_r - k_i
    geometry = ((along @ along) / along[2]) ** 2  # in units of the wave number, or f had a dimension
    geometry *= ((s_r @ k_i) ** 2 + (p_r @ k_i) ** 2) * ((s_i @ k_r) ** 2 + (p_i @ k_r) ** 2)
    geometry /= np.linalg.norm(np.cross(k_r, k_i)) ** 4

    def s(c):
        x = tau * c / (2.0 * sigma)
        big = 0.5 * (2.0 / math.sqrt(math.pi) * sigma / (tau * c) * math.exp(-x * x) - special.erfc(x))
        return (1.0 - 0.5 * special.erfc(x)) / (big + 1.0)

    return geometry * s(cot[0]) * s(cot[1]) * d / (math.pi * v[2] * light[2])


def embrechts(v, light, p):
    s, cos_b = p["smoothness"], half_of(v, light)[2]

    def masking(c):
        a = s * c / math.sqrt(1.0 - c * c)
        return 2.0 / (1.0 + special.erf(a) + math.exp(-a * a) / (a * math.sqrt(math.pi)))

    c = s * s / (4.0 * math.pi) * masking(v[2]) * masking(light[2])
    return p["scattering"] * c * math.exp(-(s * math.tan(math.acos(cos_b))) ** 2) / (light[2] * v[2] * cos_b**4)


def ashikhmin_shirley(v, light, p):
    nu, nv, h = p["exponent_u"], p["exponent_v"], half_of(v, light)
    power = (nu * h[0] ** 2 + nv * h[1] ** 2) / (1.0 - h[2] ** 2)
    return (math.sqrt((nu + 1.0) * (nv + 1.0)) / (8.0 * math.pi) * h[2] ** power
            / (dot(h, light) * max(v[2], light[2])))


def lafortune(v, light, p):
    total = 0.0
    for i in (1, 2, 3):
        n, c = p[f"exponent_{i}"], (p[f"cxy_{i}"], p[f"cxy_{i}"], p[f"cz_{i}"])
        total += p[f"weight_{i}"] * (n + 2.0) / (2.0 * math.pi) * max(
            sum(a * b * d for a, b, d in zip(c, v, light, strict=True)), 0.0) ** n
    return total


def phong_original(v, light, p):
    return max(dot([-v[0], -v[1], v[2]], light), 0.0) ** p["exponent"]


def blinn_original(v, light, p):
    return half_of(v, light)[2] ** p["exponent"]


@lru_cache(maxsize=1)
def star():
    """The shipped image, row 0 at the bottom, and the sum of its readings at 4e6 half vectors, even in solid angle."""
    pixels = exr.read(tables.PACKAGED / "ndf_star.exr")[0][::-1, :, 1].astype(np.float64)
    # Rings are narrow about the normal, where the image is bright.
    edges = np.linspace(0.0, 0.5 * np.pi, 2001)
    z, phi = 0.5 * (np.cos(edges[1:]) + np.cos(edges[:-1])), np.arange(2000) * np.pi / 1000.0
    s = np.sqrt(1.0 - z * z)
    mean = ndimage.map_coordinates(pixels, [np.outer(s, f(phi)) * 64.0 + 63.5 for f in (np.sin, np.cos)], order=1,
                                   mode="nearest").mean(axis=1)
    return pixels, 2.0 * np.pi * float(mean @ -np.diff(np.cos(edges)))


def ndf_map(v, light, p):
    """Ashikhmin and Shirley's form with the star, read bilinearly between pixels' centres, over its integral."""
    pixels, total = star()
    h, turn = half_of(v, light), 2.0 * math.pi * p["rotation"]
    x, y = (min(max(64.0 * (a + 1.0) - 0.5, 0.0), 127.0) for a in (math.cos(turn) * h[0] + math.sin(turn) * h[1],
                                             math.cos(turn) * h[1] - math.sin(turn) * h[0]))
    i, j = min(int(x), 126), min(int(y), 126)
    density = sum((1.0 - abs(x - k)) * (1.0 - abs(y - n)) * pixels[n, k] for k in (i, i + 1) for n in (j, j + 1))
    return density / total / (4.0 * dot(v, h) * max(v[2], light[2]))


def kajiya_kay(v, light, p):
    """The cosine of the angle between V and the cone of mirrored light, times what a strand receives."""
    to_strand = abs(math.asin(light[0]) + math.asin(v[0]))
    value = max(math.cos(to_strand), 0.0) ** p["exponent"] * math.cos(math.asin(light[0]))
    return value * ((p["exponent"] + 2.0) / (2.0 * math.pi) if p["normalized"] else 1.0) / light[2]


FORMULA = {
    "ward": lambda v, light, p: ward_peak(v, light, p) / math.sqrt(v[2] * light[2]),
    "ward_duer": lambda v, light, p: ward_peak(v, light, p) / (v[2] * light[2]),
    "ward_bounded": bounded, "cook_torrance": cook_torrance, "cosine_microfacet": cosine_microfacet,
    "he_torrance": he_torrance, "embrechts": embrechts, "ashikhmin_shirley": ashikhmin_shirley, "lafortune": lafortune,
    "phong_original": phong_original, "blinn_original": blinn_original, "kajiya_kay": kajiya_kay,
    "ndf_map": ndf_map,
    "blinn_fresnel": lambda v, light, p: (p["exponent"] + 8.0) / (8.0 * math.pi) * blinn_original(v, light, p),
    "weighted_lobes": lambda v, light, p: sum(
        p[f"weight_{i}"] * (p[f"exponent_{i}"] + 8.0) / (8.0 * math.pi) * half_of(v, light)[2] ** p[f"exponent_{i}"]
        for i in (1, 2, 3)),
}


def by_hand(name, v, light, p):
    """f of all channels (3,), from the formulas above."""
    base, diffuse = np.array(p["base_color"]), np.array(p["diffuse_color"])
    colour = base
    if name == "ashikhmin_shirley" or p.get("fresnel_type") == 1:
        edge = np.array(p.get("f90", (1.0, 1.0, 1.0)))
        colour = base + (edge - base) * (1.0 - dot(v, half_of(v, light))) ** 5
    amount = 1.0 / math.pi
    if name == "ashikhmin_shirley":
        amount = 28.0 / (23.0 * math.pi) * (1.0 - base) * math.prod(
            1.0 - (1.0 - 0.5 * x[2]) ** 5 for x in (v, light))
    if name == "kajiya_kay":
        amount = math.cos(math.asin(light[0])) / (math.pi * light[2])
    return FORMULA[name](v, light, p) * colour + diffuse * amount


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


NODES = {"ndf_map": (600, 720)}  # rings and turns, where lobes have narrow rays


@lru_cache(maxsize=8)
def half_vectors(width, rings=300, turns=120):
    """Half vectors (N, 3) about the normal and solid angles (N,), by the midpoint rule in log of their slope."""
    edges = np.concatenate([[0.0], np.geomspace(1e-3 * width, 1e4, rings)])
    slope = np.sqrt(edges[1:] * np.maximum(edges[:-1], 1e-12))
    slope[0] = 0.5 * edges[1]
    cosines = 1.0 / np.sqrt(1.0 + edges * edges)
    area = (cosines[:-1] - cosines[1:]) * 2.0 * np.pi / turns
    phi = (np.arange(turns) + 0.5) * 2.0 * np.pi / turns
    z = 1.0 / np.sqrt(1.0 + slope**2)
    x, y = (np.outer(z * slope, f(phi)).ravel() for f in (np.cos, np.sin))
    return np.stack([x, y, np.repeat(z, turns)], axis=-1), np.repeat(area, turns)


def half_vector_lights(view, model, given):
    """Lights (N, 3) above the horizon and solid angles (N,), dense where half vectors are upright: dL = 4 V·H dH."""
    h, area = half_vectors(round(float(model.width(model.resolve(given))), 4), *NODES.get(model.id, ()))
    facing = h @ view
    light = 2.0 * facing[:, None] * h - view
    lit = (facing > 0.0) & (light[:, 2] > 0.0)
    return light[lit] / np.linalg.norm(light[lit], axis=1, keepdims=True), 4.0 * facing[lit] * area[lit]


def even_lights(view, model, given, nodes=600):
    """The same, spread evenly: for strands, whose light is on cones, and is bright at the horizon."""
    mu, phi = ((np.arange(nodes) + 0.5) * end / nodes for end in (1.0, 2.0 * np.pi))
    s = np.sqrt(1.0 - mu * mu)
    x, y = (np.outer(s, f(phi)).ravel() for f in (np.cos, np.sin))
    return np.stack([x, y, np.repeat(mu, nodes)], axis=-1), np.full(nodes * nodes, 2.0 * np.pi / nodes**2)


def integrated(model, view, given):
    """The albedo without a spike, of one view (3,)."""
    light, area = (even_lights if model.id == "kajiya_kay" else half_vector_lights)(view, model, given)
    return np.einsum("n,n...->...", area * light[:, 2], model.evaluate(view[None], light, **given))


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


def binned(light, weights=None):
    turn = np.arctan2(light[:, 1], light[:, 0])
    return np.histogram2d(light[:, 2], turn, (10, 12), ((-1.0, 1.0), (-np.pi, np.pi)), weights=weights)[0].ravel()


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
