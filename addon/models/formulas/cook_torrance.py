"""Microfacets in V-shaped grooves: Cook and Torrance's model, and one with a power of the cosine."""
import numpy as np

from ..formula_model import FormulaModel, factor, lambert
from ..geometry import half
from ..microfacet import beckmann, v_cavities
from ..parameters import COLOUR, DIFFUSE, ESTIMATOR, EXPONENT, SLOPE
from ..registry import register
from ..samplers import Cosine, HalfBeckmann, HalfPower, Mixture
from .phong import NEUMANN

COOK = "Cook, Torrance, A reflectance model for computer graphics, ACM Transactions on Graphics 1(1), 1982"
RTR = "Akenine-Möller, Haines, Hoffman, Real-Time Rendering, 3rd ed., 2008"


def cook_torrance(view, light, p):
    """D G / (4 (N·L)(N·V)), (N,), with the microfacet normalization of D (Neumann et al. eq. 9, 10)."""
    d = beckmann(half(view, light), p["roughness"])
    return d * v_cavities(view, light) / (4.0 * view[:, 2] * light[:, 2])


def cosine_power(view, light, p):
    """(m+2)/(8 pi) (N·H)^m G / ((N·L)(N·V)), (N,)."""
    n = p["exponent"]
    power = np.maximum(half(view, light)[:, 2], 0.0) ** n
    return (n + 2.0) / (8.0 * np.pi) * power * v_cavities(view, light) / (view[:, 2] * light[:, 2])


def with_cosine(glossy, p):
    """The sampler `glossy`, mixed with Lambert's directions if there is a diffuse part."""
    diffuse = np.mean(p["diffuse_color"])
    return Mixture(((1.0, glossy), (diffuse, Cosine()))) if diffuse else glossy


register(FormulaModel(
    id="cook_torrance", label="Cook-Torrance",
    description="Beckmann's microfacets in V-shaped grooves: off-specular peaks, and hardly any light lost",
    parameters=SLOPE + COLOUR + DIFFUSE + ESTIMATOR, formula="F D G / (4 N·L N·V)",
    references=(COOK, NEUMANN + ", eq. 9, 10"),
    lobe=cook_torrance, sampler=lambda p: with_cosine(HalfBeckmann(p["roughness"], p["roughness"]), p),
    width=lambda p: p["roughness"], width_parameter="roughness", colour=factor, diffuse=lambert))
register(FormulaModel(
    id="cosine_microfacet", label="Cosine-Power Microfacets",
    description="Microfacets whose normals follow a power of the cosine, in V-shaped grooves",
    parameters=EXPONENT + COLOUR + DIFFUSE + ESTIMATOR,
    formula="(m+2)/(8π) cos^m θ_h F G / (N·L N·V)", references=(RTR + ", eq. 7.51",),
    lobe=cosine_power, sampler=lambda p: with_cosine(HalfPower(p["exponent"], p["exponent"]), p),
    width=lambda p: np.sqrt(2.0 / p["exponent"]), width_parameter="exponent", colour=factor, diffuse=lambert))
