"""Embrechts' model from lighting engineering."""
from ..formula_model import FormulaModel, factor, lambert
from ..geometry import half
from ..microfacet import beckmann, smith_beckmann
from ..parameters import COLOUR, DIFFUSE, ESTIMATOR, SMOOTHNESS
from ..registry import register
from ..samplers import HalfBeckmann
from .cook_torrance import with_cosine
from .phong_variants import SAWICKI

EMBRECHTS = "Embrechts, Etude et modélisation de la réflexion lumineuse, thesis, Université de Liège, 1995"


def lobe(view, light, p):
    """a_sc C exp(-s² tan²β) / (cosθ_L cosθ_V cos⁴β), (N,).

    The source states that the attenuation C depends on the material's s, but not how. Here C is s²/(4 pi) times Smith's
    masking of Gaussian slopes in both directions.
    """
    m = 1.0 / p["smoothness"]
    masking = smith_beckmann(view[:, 2], m) * smith_beckmann(light[:, 2], m)
    return p["scattering"] * masking * beckmann(half(view, light), m) / (4.0 * view[:, 2] * light[:, 2])


register(FormulaModel(
    id="embrechts", label="Embrechts",
    description="Beckmann-like scattering with masking by the roughness itself, from lighting engineering",
    parameters=SMOOTHNESS + COLOUR + DIFFUSE + ESTIMATOR,
    formula="a_sc F C exp(-s² tan²β) / (N·L N·V cos⁴β)", references=(EMBRECHTS, SAWICKI + ", eq. 7"),
    lobe=lobe, sampler=lambda p: with_cosine(HalfBeckmann(1.0 / p["smoothness"], 1.0 / p["smoothness"]), p),
    width=lambda p: 1.0 / p["smoothness"], width_parameter="smoothness", colour=factor, diffuse=lambert))
