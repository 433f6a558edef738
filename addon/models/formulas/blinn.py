"""Reciprocal Blinn and its pumped-up form."""
from ..lobe_model import LobeModel
from ..lobes import BLINN
from ..parameters import COLOUR, ESTIMATOR, PUMPING, SHAPE
from ..registry import register
from .phong import NEUMANN

register(LobeModel(
    id="blinn", label="Blinn",
    description="The reciprocal half-vector lobe. Its albedo passes 1 near normal incidence for small exponents",
    lobe=BLINN, correction="none", parameters=SHAPE + COLOUR + ESTIMATOR,
    formula="(n+8)/(8π) (N·H)^n", references=(NEUMANN + ", eq. 6",),
))
register(LobeModel(
    id="pumped_blinn", label="Pumped Blinn",
    description="Blinn divided by its own albedo: energy-conserving after the first pump, with off-specular peaks",
    lobe=BLINN, correction="pumped", parameters=SHAPE + PUMPING + COLOUR + ESTIMATOR,
    formula="(n+8)/(8π) (N·H)^n / D", references=(NEUMANN + ", eq. 16, 20, 21",),
))
