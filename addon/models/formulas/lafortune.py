"""Lafortune's generalized cosine lobes."""
import numpy as np

from ..formula_model import FormulaModel, constant, lambert
from ..geometry import normalize
from ..parameters import COSINE_LOBES, DIFFUSE, ESTIMATOR, SPECULAR
from ..registry import register
from ..samplers import AxisPower, Cosine, Mixture

# The largest power. Bases may be up to 1.44, so powers may overflow. A value of this size is no reflectance, but is
# finite.
LARGEST = 1e30

LAFORTUNE = ("Lafortune, Foo, Torrance, Greenberg, Non-linear approximation of reflectance functions, SIGGRAPH 1997, "
             "eq. 8")


def lobe(view, light, p):
    """Sum of w (n+2)/(2 pi) max(C_xy (V_x L_x + V_y L_y) + C_z V_z L_z, 0)^n over three lobes, (N,)."""
    across = view[:, 0] * light[:, 0] + view[:, 1] * light[:, 1]
    up = view[:, 2] * light[:, 2]
    total = np.zeros(len(view))
    for i in (1, 2, 3):
        n, scale = p[f"exponent_{i}"], p[f"weight_{i}"]
        cosine = np.maximum(p[f"cxy_{i}"] * across + p[f"cz_{i}"] * up, 0.0)
        with np.errstate(over="ignore"):
            total += scale * (n + 2.0) / (2.0 * np.pi) * np.minimum(cosine**n, LARGEST)
    return total


def make_sampler(p):
    """Powers about each lobe's stretched mirror direction, mixed with Lambert's directions."""
    def axis(i):
        return lambda view: normalize(view * [p[f"cxy_{i}"], p[f"cxy_{i}"], p[f"cz_{i}"]])

    lobes = [(p[f"weight_{i}"], AxisPower(axis(i), p[f"exponent_{i}"])) for i in (1, 2, 3)]
    return Mixture((*lobes, (np.mean(p["diffuse_color"]) + 0.01, Cosine())))


def width(p):
    """The slope of the narrowest lobe that has a weight."""
    return np.sqrt(0.5 / max([p[f"exponent_{i}"] for i in (1, 2, 3) if p[f"weight_{i}"] > 0.0] or [1.0]))


register(FormulaModel(
    id="lafortune", label="Lafortune",
    description="Three cosine lobes about stretched mirror directions: off-specular, retroreflective, for measured "
    "data",
    parameters=COSINE_LOBES + SPECULAR + DIFFUSE + ESTIMATOR,
    formula="ρ_d/π + Σ w (n+2)/(2π) (C_xy (V_x L_x + V_y L_y) + C_z V_z L_z)^n", references=(LAFORTUNE,),
    lobe=lobe, sampler=make_sampler, width=width, width_parameter="exponent_1",
    widened_with=("exponent_2", "exponent_3"),
    power_bases=tuple(f"{c}_{i}" for i in (1, 2, 3) for c in ("cxy", "cz")), colour=constant, diffuse=lambert))
