"""Terms of microfacet models: Beckmann's distribution of normals, and two kinds of shadowing and masking."""
import numpy as np

from .geometry import dot, half


def beckmann(h, mx, my=None):
    """Beckmann's D(H) in 1/sr of half vectors `h` (N, 3), shape (N,). It is normalized: ∫ D (N·H) dω = 1.

    The root mean square slopes along x and y are m_x/√2 and m_y/√2. `my` is `mx` by default.
    """
    my = mx if my is None else my
    z = np.maximum(h[:, 2], 1e-9)
    tan2 = (h[:, 0] / (z * mx)) ** 2 + (h[:, 1] / (z * my)) ** 2
    return np.exp(-tan2) / (np.pi * mx * my * z**4)


def v_cavities(view, light):
    """Shadowing and masking by V-shaped grooves: min(1, 2 (N·H)(N·V)/(V·H), 2 (N·H)(N·L)/(V·H)), (N,).

    Source: Cook and Torrance 1982, after Torrance and Sparrow 1967.
    """
    h = half(view, light)
    lower = np.minimum(view[:, 2], light[:, 2])
    return np.minimum(1.0, 2.0 * h[:, 2] * lower / np.maximum(dot(view, h), 1e-12))


def smith_beckmann(mu, m):
    """Smith's masking 1 / (1 + Lambda), (N,), for Beckmann's distribution with slope `m`, at cosines `mu` (N,).

    Source: Walter, Marschner, Li, Torrance 2007, section 5.2: the exact formula, not the rational fit.
    """
    mu = np.clip(mu, 1e-9, 1.0)
    a = mu / (m * np.sqrt(np.maximum(1.0 - mu * mu, 1e-18)))
    a = np.minimum(a, 20.0)
    return 1.0 / (1.0 + 0.5 * (np.exp(-a * a) / (a * np.sqrt(np.pi)) - erfc(a)))


def erfc(x):
    """Complementary error function of numbers `x` >= 0 (...,), with a relative error of at most 1.2e-7.

    Source: Press et al., Numerical Recipes, 2nd ed., section 6.2.
    """
    t = 1.0 / (1.0 + 0.5 * np.asarray(x, dtype=np.float64))
    series = (-1.26551223, 1.00002368, 0.37409196, 0.09678418, -0.18628806, 0.27886807, -1.13520398, 1.48851587,
              -0.82215223, 0.17087277)
    return t * np.exp(-x * x + np.polynomial.polynomial.polyval(t, series))


def beckmann_lambda(tan2):
    """Lambda (...) of Smith's masking for Beckmann's distribution, by the rational fit that Cycles uses.

    `tan2` (...) is the squared tangent of a direction's angle from the facet's normal, times alpha squared. With two
    widths it is (x alpha_x / z)^2 + (y alpha_y / z)^2.

    Source: Walter et al. 2007, the fit below eq. 27, in Heitz 2014's form.
    """
    a = 1.0 / np.sqrt(np.maximum(tan2, 0.39))
    return np.where(tan2 < 0.39, 0.0, ((0.396 * a - 1.259) * a + 1.0) / ((2.181 * a + 3.535) * a))
