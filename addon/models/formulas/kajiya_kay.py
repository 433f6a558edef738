"""Kajiya and Kay's strands on a surface, which is dark below its horizon."""
import numpy as np

from ..formula_model import FormulaModel, constant
from ..parameters import DIFFUSE, ESTIMATOR, EXPONENT, NORMALIZE, SPECULAR, TANGENT
from ..registry import register
from ..samplers import Cosine
from .cook_torrance import RTR

KAJIYA = "Kajiya, Kay, Rendering fur with three dimensional textures, SIGGRAPH 1989"


def _sines(view, light):
    """Sines of the angles between the strand, x, and V and L; (N,) each."""
    return np.sqrt(np.maximum(1.0 - view[:, 0] ** 2, 0.0)), np.sqrt(np.maximum(1.0 - light[:, 0] ** 2, 0.0))


def lobe(view, light, p):
    """cos^m α_r (Real-Time Rendering, eq. 7.50), times (m+2)/(2 pi) if `normalized`, (N,).

    The factor sine_l / N·L replaces the surface's cosine by the strand's.
    """
    sine_v, sine_l = _sines(view, light)
    cosine = np.maximum(sine_v * sine_l - view[:, 0] * light[:, 0], 0.0)
    m = p["exponent"]
    scale = (m + 2.0) / (2.0 * np.pi) if p["normalized"] else 1.0
    return scale * cosine**m * sine_l / light[:, 2]


def diffuse(view, light, p):
    """Lambert's factor, (N,), with the strand's cosine in place of the surface's."""
    return _sines(view, light)[1] / (np.pi * light[:, 2])


register(FormulaModel(
    id="kajiya_kay", label="Kajiya-Kay",
    description="Strands along the tangent: bright cones of light, dark where the surface turns away; not reciprocal",
    parameters=EXPONENT + NORMALIZE + SPECULAR + DIFFUSE + TANGENT + ESTIMATOR,
    formula="(c_diff/π + c_spec (m+2)/(2π) cos^m α_r) cosθ'_i / N·L", references=(KAJIYA, RTR + ", eq. 7.50"),
    lobe=lobe, sampler=lambda p: Cosine(), width=lambda p: np.sqrt(0.5 / p["exponent"]), width_parameter="exponent",
    colour=constant, diffuse=diffuse, symmetric=False,
    stretched=lambda p: (min(2.0 / np.sqrt(p["exponent"] + 4.0), 0.9), 1.0)))
