"""Phong and Blinn-Phong as first published, Blinn-Phong with Fresnel's factor, and sums of weighted lobes."""
import numpy as np

from ..formula_model import FormulaModel, constant, factor, lambert
from ..geometry import mirror
from ..lobes import BLINN, PHONG
from ..parameters import COLOUR, DIFFUSE, ESTIMATOR, EXPONENT, LOBES, SPECULAR
from ..registry import register
from ..samplers import AxisPower, Cosine, HalfPower, Mixture
from .cook_torrance import RTR, with_cosine

PHONG_1975 = "Phong, Illumination for computer generated pictures, Communications of the ACM 18(6), 1975"
BLINN_1977 = "Blinn, Models of light reflection for computer synthesized pictures, SIGGRAPH 1977"
SAWICKI = "Sawicki, Modeling the metallic reflection using appropriate BRDF model"


def phong(view, light, p):
    """max(R·L, 0)^n, (N,)."""
    n = p["exponent"]
    return PHONG.value(view, light, n) * 2.0 * np.pi / (n + 2.0)


def blinn(view, light, p):
    """(N·H)^n, (N,)."""
    n = p["exponent"]
    return BLINN.value(view, light, n) * 8.0 * np.pi / (n + 8.0)


def blinn_normalized(view, light, p):
    """(n+8)/(8 pi) (N·H)^n, (N,)."""
    return BLINN.value(view, light, p["exponent"])


def sum_of_lobes(view, light, p):
    """The weighted sum of three lobes (n+8)/(8 pi) (N·H)^n, (N,)."""
    return sum(p[f"weight_{i}"] * BLINN.value(view, light, p[f"exponent_{i}"]) for i in (1, 2, 3))


def make_sum_sampler(p):
    """Half vectors of all lobes, mixed with Lambert's directions."""
    lobes = [(p[f"weight_{i}"], HalfPower(p[f"exponent_{i}"], p[f"exponent_{i}"])) for i in (1, 2, 3)]
    return Mixture((*lobes, (np.mean(p["diffuse_color"]) + 1e-3, Cosine())))


def narrowest(p):
    """The slope of the narrowest lobe that has a weight."""
    return np.sqrt(2.0 / max([p[f"exponent_{i}"] for i in (1, 2, 3) if p[f"weight_{i}"] > 0.0] or [1.0]))


register(FormulaModel(
    id="phong_original", label="Phong, Original",
    description="Phong's power as first published: it reflects less the narrower it is",
    parameters=EXPONENT + SPECULAR + DIFFUSE + ESTIMATOR, formula="k_s (R·L)^n",
    references=(PHONG_1975, SAWICKI + ", eq. 2"),
    lobe=phong, sampler=lambda p: with_cosine(AxisPower(mirror, p["exponent"]), p),
    width=lambda p: np.sqrt(0.5 / p["exponent"]), width_parameter="exponent", colour=constant, diffuse=lambert))
register(FormulaModel(
    id="blinn_original", label="Blinn-Phong, Original",
    description="Blinn's power of the half vector as first published: it reflects less the narrower it is",
    parameters=EXPONENT + SPECULAR + DIFFUSE + ESTIMATOR, formula="k_s (N·H)^n",
    references=(BLINN_1977, SAWICKI + ", eq. 3"),
    lobe=blinn, sampler=lambda p: with_cosine(HalfPower(p["exponent"], p["exponent"]), p),
    width=lambda p: np.sqrt(2.0 / p["exponent"]), width_parameter="exponent", colour=constant, diffuse=lambert))
register(FormulaModel(
    id="blinn_fresnel", label="Blinn-Phong with Fresnel",
    description="Normalised Blinn-Phong with Fresnel's factor, over a diffuse part: the usual model of games",
    parameters=EXPONENT + COLOUR + DIFFUSE + ESTIMATOR, formula="c_diff/π + (m+8)/(8π) F cos^m θ_h",
    references=(RTR + ", eq. 7.49",),
    lobe=blinn_normalized, sampler=lambda p: with_cosine(HalfPower(p["exponent"], p["exponent"]), p),
    width=lambda p: np.sqrt(2.0 / p["exponent"]), width_parameter="exponent", colour=factor, diffuse=lambert))
register(FormulaModel(
    id="weighted_lobes", label="Weighted Lobes",
    description="Three normalised Blinn-Phong lobes, added: a sharp core in a wide halo",
    parameters=LOBES + COLOUR + DIFFUSE + ESTIMATOR,
    formula="c_diff/π + F Σ w_i (n_i+8)/(8π) (N·H)^n_i", references=(RTR + ", eq. 7.49",),
    lobe=sum_of_lobes, sampler=make_sum_sampler, width=narrowest, width_parameter="exponent_1",
    widened_with=("exponent_2", "exponent_3"), colour=factor, diffuse=lambert))
