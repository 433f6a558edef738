"""The pumping paper's figure 1: its curves and their growth against integrals over the slopes of the microfacets.

With the half vector as (-p, -q, 1)/√(1+p²+q²), Beckmann's D(H) (N·H) dH is exp(-(p²+q²)/m²)/(π m²) dp dq, and
dL = 4 (V·H) dH; so Ward's and Cook and Torrance's albedos are integrals over the plane of slopes.
"""
import math

import numpy as np
import pytest
from scipy import special
from truth import quadrature
from truth.literature import he_torrance

from addon.dev.figures import pumping as figures

M = 0.1
PHONG, HE, COOK, WARD, UNSHADOWED, DUER = figures.COMPARED
COSINES = np.array([1.0, 0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-4])


def over_slopes(mu, weight):
    """Integral of exp(-(p²+q²)/m²)/(π m²) (V·H)/(N·H) `weight`(N·L, (N·H)², (V·H)/(N·H)), for a view at N·V = mu."""
    x, w = np.polynomial.legendre.leggauss(40)
    s = math.sqrt(1.0 - mu * mu)
    # The light is above the horizon where 2 (V·H)/(N·H) > mu (1 + p² + q²): p up to `top`, q up to `end`.
    top = min((1.0 - s) / mu, 6.0 * M)
    cuts = np.concatenate([np.geomspace(min(6.0 * M + top, 1e-6), 6.0 * M + top, 60)[::-1], [0.0]])
    total = 0.0
    for low, high in zip(top - cuts[:-1], top - cuts[1:], strict=True):
        p = low + 0.5 * (high - low) * (x + 1.0)
        ratio = mu - s * p
        end = np.minimum(np.sqrt(np.maximum(2.0 * ratio / mu - 1.0 - p * p, 0.0)), 6.0 * M)
        q = np.outer(end, 1.0 - 0.25 * (1.0 - x) ** 2)  # dense at the end, where N·L may begin as a root
        dq = np.outer(end, 0.5 * (1.0 - x) * w)
        p, ratio = p[:, None], ratio[:, None]
        light = 2.0 * ratio / (1.0 + p * p + q * q) - mu
        gauss = np.exp(-(p * p + q * q) / M**2) / (math.pi * M**2)
        inner = (gauss * ratio * weight(np.maximum(light, 0.0), 1.0 / (1.0 + p * p + q * q), ratio) * dq).sum(axis=1)
        total += 2.0 * (inner * w).sum() * 0.5 * (high - low)
    return total


def slope_integral(label, mu):
    """Albedo of one of the curves: f (N·L) 4 (V·H) dH over the density of slopes is `weight`."""
    return over_slopes(mu, {
        UNSHADOWED: lambda light, cos2, ratio: 1.0 / mu,
        COOK: lambda light, cos2, ratio: np.minimum(1.0, 2.0 * np.minimum(mu, light) / ratio) / mu,
        WARD: lambda light, cos2, ratio: cos2**2 * np.sqrt(light / mu),
        DUER: lambda light, cos2, ratio: cos2**2 / mu,
    }[label])


def closed_form(mu):
    """Albedo with G = 1, whose integral over q is an error function."""
    s = math.sqrt(1.0 - mu * mu)
    p = np.linspace(-6.0 * M, min((1.0 - s) / mu, 6.0 * M), 200001)
    end = np.sqrt(np.maximum(2.0 * (mu - s * p) / mu - 1.0 - p * p, 0.0))
    y = np.exp(-((p / M) ** 2)) / (math.sqrt(math.pi) * M) * (mu - s * p) * special.erf(end / M) / mu
    return float(np.sum(0.5 * (y[1:] + y[:-1])) * (p[1] - p[0]))


@pytest.mark.parametrize("label", [COOK, WARD, UNSHADOWED, DUER])
def test_curves_are_integrals_over_slopes(label):
    expected = [slope_integral(label, mu) for mu in COSINES]
    np.testing.assert_allclose(figures.compared_albedo(label, COSINES), expected, rtol=1e-4)


def test_the_integral_over_slopes_itself():
    np.testing.assert_allclose([slope_integral(UNSHADOWED, mu) for mu in COSINES], [closed_form(mu) for mu in COSINES],
                               rtol=1e-5)
    assert 1e-6 * slope_integral(UNSHADOWED, 1e-6) == pytest.approx(M / (2.0 * math.sqrt(math.pi)), rel=1e-4)


def test_the_curve_of_phong():
    expected = [quadrature.exact_a0("phong", mu, 150.0) for mu in COSINES]
    np.testing.assert_allclose(figures.compared_albedo(PHONG, COSINES), expected, rtol=1e-4)


@pytest.mark.parametrize("angle", [30.0, 78.0])
def test_the_curve_of_he_and_torrance(angle):
    """A plain sum over the hemisphere, and the spike by eq. 72."""
    p, view = {"sigma": 0.1, "tau": 1.7, "wavelength": 0.55}, quadrature.view_at(math.cos(math.radians(angle)))
    rings, turns = 60, 60
    theta, phi = (np.arange(rings) + 0.5) * 0.5 * np.pi / rings, (np.arange(turns) + 0.5) * np.pi / turns
    area = 2.0 * (0.5 * np.pi / rings) * (np.pi / turns)
    total = sum(he_torrance(view, (math.sin(t) * math.cos(f), math.sin(t) * math.sin(f), math.cos(t)), p)
                * math.cos(t) * math.sin(t) * area for t in theta for f in phi)
    mirror = he_spike(view[2], p)
    assert figures.compared_albedo(HE, view[2:])[0] == pytest.approx(total + mirror, rel=3e-3)
    assert (angle == 78.0) == (mirror > 0.3)


def he_spike(mu, p):
    """exp(-g) S of the mirror direction, eq. 72: view and light lean alike, so eq. 81 has one K."""
    cot, root = mu / math.sqrt(1.0 - mu * mu), 0.0
    a = p["tau"] * cot / (2.0 * p["sigma"])
    k = special.erfc(a) / cot
    for _ in range(200):  # z0/sigma by plain iteration, halved so that it settles
        root = 0.5 * (root + math.sqrt(2.0 / math.pi) * 0.5 * k * math.exp(-0.5 * root * root))
    sigma = p["sigma"] / math.sqrt(1.0 + root * root)
    g = (4.0 * math.pi * sigma * mu / p["wavelength"]) ** 2
    big = 0.5 * (math.exp(-a * a) / (a * math.sqrt(math.pi)) - special.erfc(a))
    return math.exp(-g) * ((1.0 - 0.5 * special.erfc(a)) / (big + 1.0)) ** 2


def test_growth_towards_grazing():
    """Ward grows as (N·V)^-1/2, Ward-Dür and Cook-Torrance with G = 1 as ^-1; the others do not grow."""
    limits = {WARD: -0.5, UNSHADOWED: -1.0, DUER: -1.0}
    for label, limit in limits.items():
        decade = [slope_integral(label, mu) for mu in (10.0 * figures.LAST, figures.LAST)]
        assert figures.growth(label) == pytest.approx(math.log10(decade[0] / decade[1]), abs=1e-3)
        assert figures.growth(label) == pytest.approx(limit, abs=0.02)  # the last decade is not yet the limit
        assert figures.growth(label, 1e-6) == pytest.approx(limit, abs=1e-3)
    assert all(figures.growth(label) > -1e-3 for label in figures.COMPARED if label not in limits)


def test_cook_and_torrance_end_at_one_by_eq_10():
    """The paper's claim takes G = 1: with the geometry term the albedo is never above 1, and 1 at the horizon."""
    mu = np.geomspace(1.0, 1e-6, 40)
    albedo = figures.compared_albedo(COOK, mu)
    assert albedo.max() < 1.0 + 1e-4 and albedo.min() < 0.95
    assert albedo[-1] == pytest.approx(1.0, abs=1e-4)
    assert figures.compared_albedo(UNSHADOWED, mu).max() > 1e3


def test_the_figure_says_what_was_measured():
    pytest.importorskip("matplotlib")
    albedo, grazing = figures.draw("models").axes
    words = [text.get_text() for text in grazing.get_legend().get_texts()]
    assert words == [f"{WARD}: slope −0.49", f"{UNSHADOWED}: slope −0.99", f"{DUER}: slope −0.99"]
    assert [text.get_text() for text in albedo.get_legend().get_texts()] == list(figures.COMPARED)
    assert grazing.get_xlim()[1] <= 1e-3 and all("albedo" in at.get_ylabel() for at in (albedo, grazing))
