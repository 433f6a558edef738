"""Reciprocal Phong, its pumped-up form, and the limit of controlled pumping."""
from ..lobe_model import LobeModel
from ..lobes import PHONG
from ..parameters import COLOUR, ESTIMATOR, PUMPING, SHAPE
from ..pumping import NEUMANN
from ..registry import register

LEWIS = "Lewis, Making shaders more physically plausible, 1993"

register(LobeModel(
    id="phong", label="Phong", description="The reciprocal Phong lobe: darkens towards grazing angles",
    lobe=PHONG, correction="none", parameters=SHAPE + COLOUR + ESTIMATOR,
    formula="(n+2)/(2π) max(R·L, 0)^n", references=(LEWIS, NEUMANN + ", eq. 6"),
))
register(LobeModel(
    id="pumped_phong", label="Pumped Phong",
    description="Phong divided by its own albedo, once or several times, until it mirrors like metal",
    lobe=PHONG, correction="pumped", parameters=SHAPE + PUMPING + COLOUR + ESTIMATOR,
    formula="(n+2)/(2π) max(R·L, 0)^n / D", references=(NEUMANN + ", eq. 16, 20, 21",),
))
register(LobeModel(
    id="phong_limit", label="Phong Limit",
    description="Where controlled pumping of Phong ends: a mirror that stays as bright as what it mirrors",
    lobe=PHONG, correction="limit", parameters=SHAPE + COLOUR + ESTIMATOR,
    formula="(n+2)/(2π) max(R·L, 0)^n / max(N·L, N·V)", references=(NEUMANN + ", eq. 22",),
))
