"""Base lobes: near the target at every light direction, and nowhere where kernels cannot make up for the difference.

Blending and closures are written anew, as the shader blends and Cycles evaluates them, and read from the shipped file;
nothing of the fit is shared. Targets are the models in NumPy.
"""
import json

import numpy as np
import pytest
from truth import quadrature

from addon import resources
from addon.brdf import MODELS
from addon.forms.albedo import tables

BASE = json.loads((resources.LUTS / "base_lobes.json").read_text(encoding="utf-8"))
FAMILIES = list(BASE["families"])
# Size of the residual, in parts of the target's energy: at most, by view in degrees, and the mean over all points.
# Blinn's super-metals at grazing, of which hardly anything is seen, are the worst.
RESIDUAL = {"phong": {60.0: 0.027, 80.0: 0.075, 88.0: 0.1}, "blinn": {60.0: 0.035, 80.0: 0.09, 88.0: 0.55}}
MEAN_RESIDUAL = {"phong": 0.007, "blinn": 0.023}
HEAVIEST = 2.0  # a kernel's weight, see osl/include/estimator.h
OUT_OF_REACH = {80.0: 1e-3, 88.0: 0.02}  # of the energy: what of it kernels do not make up for, being held back by that
# Of the energy: what of the base is above the target and too much for negative kernels, and what is below zero.
ABOVE = {"phong": {80.0: 2e-3, 88.0: 3.5e-3}, "blinn": {80.0: 5e-3, 88.0: 0.025}}
BELOW = {"phong": 3e-5, "blinn": 2e-4}
PLAIN = (0.0, False)


def phong_exponent(family, n):
    """Exponent of the Phong lobe that is as wide: a half vector turns half as far as the light."""
    return n if family == "phong" else n / 4.0


def gain(family, cosine, n, choice):
    """M / D(M) at the mirror direction of N·V = M; `choice` is (pumps, control), None the limit D = M."""
    cosine = np.atleast_1d(cosine)
    if choice is None:
        return np.ones_like(cosine)
    light = np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], -1)
    view = light * [-1.0, 1.0, 1.0]
    f = MODELS[f"pumped_{family}"].evaluate(view, light, exponent=n, pumps=choice[0], control=choice[1])
    return f / quadrature.f0(family, view, light, n) * cosine


def target(family, theta, n, light, choice):
    """f(V, L) N·L."""
    view = np.broadcast_to(quadrature.view_at(np.cos(theta)), light.shape)
    if choice is None:
        f = quadrature.f0(family, view, light, n) / np.maximum(light[:, 2], view[:, 2])
    else:
        f = MODELS[f"pumped_{family}"].evaluate(view, light, exponent=n, pumps=choice[0], control=choice[1])
    return np.where(light[:, 2] > 0.0, f * light[:, 2], 0.0)


def coefficients(family, theta, n, gains):
    """Blended numbers of the point's nodes: (levels of each ramp (ramps, 8), weights of the facets, residual)."""
    data = BASE["families"][family]
    ramps, facets = len(data["ramps"]), len(data["facets"])
    table = np.reshape(data["table"], (data["u_nodes"], data["v_nodes"], len(BASE["features"]), 3 * data["stride"]))
    w = np.tan(theta) / np.sqrt(phong_exponent(family, n))
    u = 0.5 * w / (1.0 + w) + theta / np.pi
    row = np.array([np.interp(u, np.linspace(0.0, 1.0, data["u_nodes"]), np.arange(data["u_nodes"])),
                    np.interp(n ** -data["power"], np.linspace(0.0, 1.0, data["v_nodes"]), np.arange(data["v_nodes"]))])
    i, j = np.minimum(row.astype(int), np.array(table.shape[:2]) - 2)
    u, v = row - (i, j)
    # Between the three nodes of the half of the cell: along the longer way first.
    middle = table[i + 1, j] if u > v else table[i, j + 1]
    node = (1.0 - max(u, v)) * table[i, j] + abs(u - v) * middle + min(u, v) * table[i + 1, j + 1]
    total = np.asarray(gains) @ node
    return total[: 9 * ramps].reshape(ramps, 9)[:, :8], total[9 * ramps : 9 * ramps + facets], total[8]


def base_value(family, theta, n, light, choice):
    """Sum of the closures, N·L included, towards lights (N, 3), and the residual as the shader states it."""
    data = BASE["families"][family]
    view, m = quadrature.view_at(np.cos(theta)), phong_exponent(family, n)
    s = 1.0 / np.sqrt(m)
    cosines = np.cos(np.maximum(theta - np.array(BASE["features"]) * s, 0.0))
    gains, total = gain(family, cosines, n, choice), np.zeros(len(light))
    whole = gains[0]
    if data["plain"]:
        slope = (gains / cosines).min()
        gains, total = gains - slope * cosines, slope * ramp(view, -theta, 0.0, n, np.ones(8), light)
    levels, weights, residual = coefficients(family, theta, n, gains)
    mean = np.cos(theta) + BASE["grazing"] * s
    height = 0.5 * np.pi - theta
    for closure, level in zip(data["ramps"], levels, strict=True):
        lean = np.clip(closure["lean"] * s, -0.6 * max(height - 0.03, 0.0), np.pi - height - 0.3)
        exponent = m * closure["sharp"]
        if closure["crease"]:
            # The power is crease / 7 at the mirror direction, where the colours have a kink.
            lean = max(min(closure["lean"] * s, theta), 0.1 * s)
            exponent = min(np.log(closure["crease"] / 7.0) / np.log(max(np.cos(lean), 0.03)), 5e5)
            level = level * (m + 2.0) / (exponent + 2.0)
        for side in {closure["side"], -closure["side"]}:
            total += ramp(view, lean - theta, side * s, exponent, level / mean, light)
    assert (weights >= 0.0).all()
    for closure, weight in zip(data["facets"], weights, strict=True):
        lean, alpha2 = min(closure["lean"] * s, 0.02 / s), min(0.5 / (m * closure["sharp"]), 1.0)
        total += weight * mean * beckmann(view, lean, alpha2, light)
    return total, residual / whole


def ramp(view, angle, side, exponent, level, light):
    """phong_ramp: (e+2)/(2 pi) c (N'·L) times the colour at c = (R·L)^e; R at `angle` in plane, `side` out of it."""
    mirror = np.array([np.sin(angle) * np.cos(side), np.sin(side), np.cos(angle) * np.cos(side)])
    normal = (mirror + view) / np.linalg.norm(mirror + view)
    c = np.clip(light @ mirror, 0.0, None) ** exponent
    colour = np.interp(c, np.arange(8) / 7, level)
    return (exponent + 2.0) / (2.0 * np.pi) * c * np.clip(light @ normal, 0.0, None) * colour


def beckmann(view, lean, alpha2, light):
    """Walter et al. 2007, eq. 20, 25 with the rational fit of G1 there: D G2 / (4 N'·V), N·L included."""
    normal = np.array([np.sin(lean), 0.0, np.cos(lean)])
    half = (view + light) / np.linalg.norm(view + light, axis=1, keepdims=True)

    def shadow(cosine):
        tan = np.sqrt(np.clip(1.0 / np.square(cosine) - 1.0, 1e-12, None))
        a = 1.0 / (np.sqrt(alpha2) * tan)
        # Lambda from G1 = (3.535 a + 2.181 a^2) / (1 + 2.276 a + 2.577 a^2) = 1 / (1 + Lambda).
        return np.where(a < 1.6, (1.0 + 2.276 * a + 2.577 * a * a) / (3.535 * a + 2.181 * a * a) - 1.0, 0.0)

    cos_h, nl, nv = half @ normal, light @ normal, view @ normal
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        d = np.exp(-(1.0 / cos_h**2 - 1.0) / alpha2) / (np.pi * alpha2 * cos_h**4)
        value = d / (4.0 * nv * (1.0 + shadow(nl) + shadow(nv)))
    return np.where((nl > 0.0) & (cos_h > 0.0), value, 0.0)


def measured(family, theta, n, choice, factor=1.0):
    """(size of the residual, its size as the shader states it, its part out of reach, what of the base is above the
    target and too much for negative kernels, what is below zero), see RESIDUAL and ABOVE; parts of the energy."""
    light, area = lights(family, theta, n)
    base, residual = base_value(family, theta, n, light, choice)
    wanted = target(family, theta, n, light, choice)
    energy, remainder = (area * wanted).sum(), wanted - factor * base
    drawn = density(family, theta, BASE["drawn"] * n, light)
    held_back = remainder - np.clip(remainder, -HEAVIEST * drawn, HEAVIEST * drawn)
    above = np.maximum(-remainder - room(family, theta, n, light) * drawn * np.maximum(factor * base, 0.0), 0.0)
    sizes = np.abs(remainder), np.abs(held_back), above, np.maximum(-factor * base, 0.0)
    size, lost, above, below = ((area * part).sum() / energy for part in sizes)
    return size, residual, lost, above, below


def room(family, theta, n, light):
    """Solid angle of the widest negative kernel at a light, a flat one of half its profile's, less a tenth."""
    width = 1.0 / np.sqrt(phong_exponent(family, n))
    if family == "blinn":
        width *= min(np.cos(theta) + 0.15 * width, 1.0)
    return 0.9 * np.pi * np.minimum(BASE["hole"] * width, light[:, 2] / 1.3) ** 2


def density(family, theta, n, light):
    """What kernels are drawn with, per solid angle: a power of R·L, or of N·H."""
    view = quadrature.view_at(np.cos(theta))
    if family == "phong":
        return (n + 1.0) / (2.0 * np.pi) * np.clip(light @ (view * [-1.0, -1.0, 1.0]), 0.0, None) ** n
    half = (view + light) / np.linalg.norm(view + light, axis=1, keepdims=True)
    return (n + 1.0) / (8.0 * np.pi) * half[:, 2] ** n / np.maximum(half @ view, 1e-9)


def lights(family, theta, n):
    """Lights and areas over the lobe, and as much over the round lobe as wide, which an oblong one does not cover."""
    parts = [("phong", phong_exponent(family, n))] + [("blinn", n)] * (family == "blinn")
    nodes = [quadrature.lobe_nodes(lobe, np.cos(theta), m, rings=80, turns=40, whole=False) for lobe, m in parts]
    light, area = np.concatenate([p[0] for p in nodes]), np.concatenate([p[1] / len(nodes) for p in nodes])
    above = light[:, 2] > 1e-9
    return light[above], area[above]


def points(count, seed):
    """Random views up to 88 degrees, exponents, and pumps with or without control, the limit now and then."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        theta, n = np.radians(88.0 * rng.random()), float(np.exp(rng.uniform(0.0, np.log(1e5))))
        yield theta, n, None if rng.random() < 0.2 else (float(4.0 * rng.random()), bool(rng.random() < 0.5))


@pytest.mark.parametrize("family", FAMILIES)
def test_base_is_near_the_target(family):
    where = list(points(300, seed=8))
    residual, told, lost, above, below = np.array([measured(family, *point) for point in where]).T
    degrees = np.degrees([theta for theta, _, _ in where])
    low = 0.0
    for high, bound in RESIDUAL[family].items():
        here = (degrees >= low) & (degrees < high)
        worst = int(np.argmax(np.where(here, residual, 0.0)))
        assert residual[worst] <= bound, (high, residual[worst], where[worst])
        low = high
    assert residual.mean() <= MEAN_RESIDUAL[family]
    assert lost[degrees < 80.0].max() <= OUT_OF_REACH[80.0] and lost.max() <= OUT_OF_REACH[88.0], lost.max()
    assert above[degrees < 80.0].max() <= ABOVE[family][80.0] and above.max() <= ABOVE[family][88.0], above.max()
    assert below.max() <= BELOW[family], below.max()
    # The number of kernels that the shader draws depends on the residual that it states.
    assert 0.8 < np.median(told / residual) < 1.2 and (told > 0.25 * residual - 0.003).all()


@pytest.mark.parametrize(("family", "theta", "n", "choice", "most"), [
    ("phong", 40.0, 20.0, None, 0.006), ("phong", 65.0, 20.0, None, 0.012), ("phong", 80.0, 20.0, None, 0.04),
    ("phong", 65.0, 1.5, (1.0, True), 0.04), ("phong", 65.0, 7.0, (2.0, False), 0.03),
    ("phong", 80.0, 5000.0, None, 0.005),
    ("blinn", 40.0, 20.0, (1.0, True), 0.015), ("blinn", 65.0, 20.0, (2.0, False), 0.03),
    ("blinn", 65.0, 150.0, (1.0, True), 0.02), ("blinn", 80.0, 7.0, (1.0, True), 0.05),
])
def test_base_leaves_little_over(family, theta, n, choice, most):
    assert 0.0 < measured(family, np.radians(theta), n, choice)[0] <= most


def test_plain_phong_is_exact():
    for theta, n, _ in points(30, seed=11):
        light, _ = lights("phong", theta, n)
        wanted, base = target("phong", theta, n, light, PLAIN), base_value("phong", theta, n, light, PLAIN)[0]
        np.testing.assert_allclose(base, wanted, atol=1e-9 * wanted.max())


@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_a_base_too_bright_or_too_dark_would_be_noticed(factor):
    sizes = [measured("phong", *point, factor=factor)[0] for point in points(30, seed=10)]
    assert np.mean(sizes) > MEAN_RESIDUAL["phong"]


def test_file_is_what_the_fit_declares():
    from addon.forms.base_lobes import closures, fit

    assert (BASE["drawn"], BASE["hole"], BASE["grazing"]) == (fit.DRAWN, fit.NEGATIVE_RADIUS, closures.GRAZING)
    assert tuple(BASE["features"]) == closures.FEATURES
    assert set(closures.FAMILIES) == set(FAMILIES)
    for name, family in closures.FAMILIES.items():
        data = BASE["families"][name]
        assert [closures.Ramp(**r) for r in data["ramps"]] == list(family.ramps)
        assert [closures.Facet(**f) for f in data["facets"]] == list(family.facets)
        for name in ("plain", "u_nodes", "v_nodes", "power"):
            assert data[name] == getattr(family, name)
        assert data["stride"] == fit.stride(family)
        assert len(data["table"]) == family.u_nodes * family.v_nodes * len(closures.FEATURES) * 3 * fit.stride(family)
    assert (tables.folder() / fit.FILE).is_file()


@pytest.mark.parametrize(("name", "i", "j"), [("phong", 6, 4), ("phong", 18, 8), ("blinn", 18, 12)])
def test_a_node_fitted_again_is_the_shipped(name, i, j):
    from addon.forms.base_lobes import closures, fit

    family = closures.FAMILIES[name]
    table = np.reshape(BASE["families"][name]["table"], (family.u_nodes, family.v_nodes, -1))
    again = fit.fit_node(family, i / (family.u_nodes - 1), j / (family.v_nodes - 1))
    np.testing.assert_allclose(fit._packed(family, *again), table[i, j], rtol=1e-3, atol=2e-3)
