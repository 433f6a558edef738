"""A highlight of any shape: an image is the distribution of half vectors."""
from dataclasses import dataclass

import numpy as np

from ...resources import LUTS
from .. import half_map
from ..formula_model import FormulaModel, factor, lambert
from ..geometry import dot, half
from ..parameters import COLOUR, DIFFUSE, ESTIMATOR, IMAGE, TANGENT
from ..registry import register
from .ashikhmin_shirley import ASHIKHMIN
from .cook_torrance import RTR, with_cosine

GENERATOR = "Ashikhmin, Premože, Shirley, A microfacet-based BRDF generator, SIGGRAPH 2000"
# The image in LUTS that is used without an image of the user's.
SHIPPED = "ndf_star.exr"


def distribution(p):
    """The `HalfMap` of the parameters `p`. Raises ImageError, which names the file and the fault."""
    return half_map.load(p["image"] or LUTS / SHIPPED, 2.0 * np.pi * p["rotation"])


def lobe(view, light, p):
    """p(H) / (4 V·H max(N·L, N·V)), (N,): Ashikhmin and Shirley's eq. 4 with the image's density in place of theirs."""
    h = half(view, light)
    return distribution(p).density(h) / (4.0 * dot(view, h) * np.maximum(view[:, 2], light[:, 2]))


@dataclass(frozen=True)
class NdfMapModel(FormulaModel):
    """A formula whose integrals are sums over the image's half vectors, since its lobe may be anywhere.

    f N·L dω_L = p(h) F N·L / max(N·L, N·V) dω_H.
    """

    def albedo_from(self, view, p):
        """See `FormulaModel`."""
        light, _, mass = half_map.lights(distribution(p).nodes, view)
        energy = mass * light[:, 2] / np.maximum(light[:, 2], view[2])
        tint = factor(view, light, p)
        albedo = energy.sum() if tint is None else energy @ tint
        return albedo + np.asarray(p["diffuse_color"]) if any(p["diffuse_color"]) else albedo

    def lights(self, view, p, widest: float, **counts):
        """See `FormulaModel`. There is one light for each node of the image, whatever `widest` and `counts` are."""
        return half_map.lights(distribution(p).few_nodes, view)[:2]


register(NdfMapModel(
    id="ndf_map", label="NDF Map",
    description="A highlight painted as an image of its half vectors: reciprocal, and conserves energy",
    parameters=IMAGE + COLOUR + DIFFUSE + TANGENT + ESTIMATOR,
    formula="p(H) F / (4 V·H max(N·L, N·V)) + diffuse, p(H) the image over its integral",
    references=(GENERATOR, ASHIKHMIN + ", eq. 4", RTR + ", p. 258 (NDF mapping)"),
    lobe=lobe, sampler=lambda p: with_cosine(distribution(p).sampler, p), width=lambda p: distribution(p).slope,
    width_parameter=None, colour=factor, diffuse=lambert, stretched=lambda p: (1.0, 1.0),
    mirrored=lambda p: distribution(p).is_mirrored))
