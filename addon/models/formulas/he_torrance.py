"""He, Torrance, Sillion and Greenberg's model by physical optics, for unpolarized light."""
import math

import numpy as np

from .. import fresnel
from ..formula_model import FormulaModel, factor, lambert
from ..geometry import dot, half
from ..microfacet import erfc
from ..parameters import COLOUR, DIFFUSE, ESTIMATOR, SURFACE
from ..registry import register
from ..samplers import HalfBeckmann
from .cook_torrance import with_cosine

HE = "He, Torrance, Sillion, Greenberg, A comprehensive physical model for light reflection, SIGGRAPH 1991"


def _cot(mu):
    """Cotangent of the angle with the cosine `mu`, for mu in 1e-6 .. 1."""
    mu = np.clip(mu, 1e-6, 1.0)
    return mu / np.sqrt(np.maximum(1.0 - mu * mu, 1e-12))


def shadowing(mu, sigma, tau):
    """Shadowing S of one direction with the cosine `mu` (N,) (eq. 24, 25), shape (N,)."""
    a = np.minimum(_cot(mu) * tau / (2.0 * sigma), 25.0)
    lambda_ = 0.5 * (np.exp(-a * a) / (np.sqrt(np.pi) * a) - erfc(a))
    return (1.0 - 0.5 * erfc(a)) / (lambda_ + 1.0)


def effective_roughness(mu_view, mu_light, sigma, tau):
    """sigma of the illuminated parts of the surface (eq. 80 to 82), (N,), by Newton's method for z_0.

    z_0 exp(z_0² / (2 sigma_0²)) increases without bound, so there is one root. Steps from its right reach it.
    """
    def k(mu):
        a = _cot(mu)
        return erfc(np.minimum(a * tau / (2.0 * sigma), 25.0)) / a

    # The root of x exp(x²/2) = target, with x = z_0 / sigma_0.
    target = np.sqrt(2.0 / np.pi) * 0.25 * (k(mu_view) + k(mu_light))
    x = np.minimum(target, np.sqrt(2.0 * np.log1p(target)) + 1e-12)
    for _ in range(40):
        # A Newton step for log x of log x + x²/2 = log target, which converges fast.
        residual = np.log(np.maximum(x, 1e-300)) + 0.5 * x * x - np.log(np.maximum(target, 1e-300))
        x = x * np.exp(-residual / (1.0 + x * x))
        # The step after a residual of this size is exact: each step squares the residual.
        if np.max(np.abs(residual), initial=0.0) < 1e-9:
            break
    return sigma / np.sqrt(1.0 + x * x)


def _phase(mu_view, mu_light, p):
    """g of eq. 79, (N,)."""
    sigma = effective_roughness(mu_view, mu_light, p["sigma"], p["tau"])
    return (2.0 * np.pi * sigma * (mu_view + mu_light) / p["wavelength"]) ** 2


def _series(g, x):
    """Sum over m >= 1 of g^m exp(-g - x/m) / (m! m) (eq. 78), (N,). The relative error is 1e-8 for sums above 1e-20.

    For large g the terms are a bell over m, of width √g, and one term in 0.75 √g is enough: on a bell the error of the
    trapezoidal rule falls as exp(-2 (π width / step)²).
    """
    total = np.empty(g.shape)
    # Values of g within a factor of 4 are summed with the same step.
    octaves = np.floor(0.5 * np.log2(np.maximum(g, 1.0)))
    for octave in np.unique(octaves):
        chosen = octaves == octave
        total[chosen] = _terms(g[chosen], x[chosen], int(4.0**octave))
    return total


def _terms(g, x, least):
    """`_series` for g in `least` .. 4 `least`, or in 0 .. 4 if `least` is 1."""
    # Terms within 8 widths of the bell's center.
    step = int(0.75 * np.sqrt(least)) if least >= 64 else 1
    first = max(int(least - 8.0 * np.sqrt(least)), 1)
    last = int(np.ceil(g.max() + 8.0 * np.sqrt(g.max()) + 12.0))
    total, log_g = np.zeros(g.shape), np.log(np.maximum(g, 1e-300))
    for m in range(first, last + 1, step):
        total += np.exp(m * log_g - g - x / m - math.lgamma(m + 1.0)) / m
    return step * total


def lobe(view, light, p):
    """The directional-diffuse part G S D / (pi cosθ_i cosθ_r) of eq. 77, (N,).

    For unpolarized light G = (v·v / v_z)² |k_r × k_i|^-4 [..][..] (eq. 76) is (2 V·H / N·H)², since each bracket is
    |k_r × k_i|².
    """
    # D by the series.
    h = half(view, light)
    mu_v, mu_l, tau = view[:, 2], light[:, 2], p["tau"]
    g = _phase(mu_v, mu_l, p)
    across = view[:, :2] + light[:, :2]
    x = (np.pi * tau / p["wavelength"]) ** 2 * dot(across, across)  # v_xy² tau² / 4
    d = (0.5 * np.pi * tau / p["wavelength"]) ** 2 * _series(g, x)
    # G and S.
    geometry = (2.0 * dot(view, h) / np.maximum(h[:, 2], 1e-9)) ** 2
    s = shadowing(mu_v, p["sigma"], tau) * shadowing(mu_l, p["sigma"], tau)
    return geometry * s * d / (np.pi * mu_v * mu_l)


def spike(mu, p):
    """The mirror's reflectance |F|² exp(-g) S (eq. 72) at N·V = `mu` (N,), shape (N, 3)."""
    mu = np.maximum(mu, 1e-6)
    strength = np.exp(-_phase(mu, mu, p)) * shadowing(mu, p["sigma"], p["tau"]) ** 2
    colour = fresnel.factor(p["fresnel_type"], mu, p["base_color"], p["f90"], p["ior"], p["extinction"])
    return strength[:, None] * colour


def slope(p):
    """The sampler's slope, clamped to [0.01, 1]: 4 sigma/tau of rough surfaces, wavelength/(pi tau) of smooth ones.

    That is twice the lobe's slope: by the facets, 2 sigma/tau, or by diffraction, wavelength/(2 pi tau).
    """
    g = min((4.0 * np.pi * p["sigma"] / p["wavelength"]) ** 2, 1e6)
    return float(np.clip(p["wavelength"] / (np.pi * p["tau"]) * np.sqrt(max(g, 1.0)), 0.01, 1.0))


register(FormulaModel(
    id="he_torrance", label="He-Torrance",
    description="Physical optics of a rough surface: a mirror spike, and scattering by diffraction and slopes",
    parameters=SURFACE + COLOUR + DIFFUSE + ESTIMATOR,
    formula="|F|² [exp(-g) S δ + G S D / (π N·L N·V)] + a/π, D a series", references=(HE + ", eq. 71 to 82",),
    lobe=lobe, sampler=lambda p: with_cosine(HalfBeckmann(slope(p), slope(p)), p), width=slope, width_parameter="tau",
    colour=factor, diffuse=lambert, spike=spike))
