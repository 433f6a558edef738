"""Ashikhmin and Shirley's anisotropic Phong model with its diffuse part."""
import numpy as np

from ..formula_model import FormulaModel, schlick
from ..geometry import dot, half
from ..parameters import DIFFUSE, ESTIMATOR, POWERS, SPECULAR, TANGENT
from ..registry import register
from ..samplers import Cosine, HalfPower, Mixture, half_power

ASHIKHMIN = "Ashikhmin, Shirley, An anisotropic Phong BRDF model, Journal of Graphics Tools 5(2), 2000"


def lobe(view, light, p):
    """The specular part without F (eq. 4), (N,)."""
    nu, nv = p["exponent_u"], p["exponent_v"]
    h = half(view, light)
    scale = np.sqrt((nu + 1.0) * (nv + 1.0)) / (8.0 * np.pi)
    return scale * half_power(h, nu, nv) / (dot(view, h) * np.maximum(view[:, 2], light[:, 2]))


def diffuse(view, light, p):
    """The diffuse part without R_d (eq. 5), (N, 3): the light that the surface transmits inward and outward."""
    both = (1.0 - (1.0 - 0.5 * view[:, 2]) ** 5) * (1.0 - (1.0 - 0.5 * light[:, 2]) ** 5)
    return 28.0 / (23.0 * np.pi) * both[:, None] * (1.0 - np.asarray(p["base_color"]))


def stretch(p):
    """The lobe's widths along and across the tangent, the larger 1."""
    least = min(p["exponent_u"], p["exponent_v"]) + 1.0
    return np.sqrt(least / (p["exponent_u"] + 1.0)), np.sqrt(least / (p["exponent_v"] + 1.0))


def make_sampler(p):
    """Half vectors of the specular part, mixed with Lambert's directions if there is a diffuse part."""
    glossy = HalfPower(p["exponent_u"], p["exponent_v"])
    diffuse_share = np.mean(p["diffuse_color"]) * (1.0 - np.mean(p["base_color"]))
    if not diffuse_share:
        return glossy
    return Mixture(((max(np.mean(p["base_color"]), 0.05), glossy), (diffuse_share, Cosine())))


register(FormulaModel(
    id="ashikhmin_shirley", label="Ashikhmin-Shirley",
    description="An anisotropic power of the half vector with Fresnel's factor, over a diffuse part: conserves energy",
    parameters=POWERS + SPECULAR + DIFFUSE + TANGENT + ESTIMATOR,
    formula="√((n_u+1)(n_v+1)) F (N·H)^(n_u cos²φ + n_v sin²φ) / (8π V·H max(N·L, N·V)) + diffuse",
    references=(ASHIKHMIN + ", eq. 4, 5",),
    lobe=lobe, sampler=make_sampler, width=lambda p: np.sqrt(2.0 / max(p["exponent_u"], p["exponent_v"])),
    width_parameter="exponent_u", colour=schlick, diffuse=diffuse, stretched=stretch))
