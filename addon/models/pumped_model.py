"""Any symmetric formula pumped up by its own albedo.

Pumping needs of f_0 nothing but symmetry (see pumping.py), so one mechanism serves all. The albedos of its stages are
integrated for the parameters at hand and kept.
"""
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from . import pumping, quadrature
from .formula_model import FormulaModel
from .geometry import view_at
from .parameters import PUMPING

_FLATTEST = 1e-4  # cosine: below, albedos go on as the power of it that they are there,
_STEEPEST = 1.5  # which is no steeper than this; Ward's is -1/2, Dür's -1
_BLACK = 1e-30  # an albedo of nothing: where it is 0 there is nothing to divide
# Nodes of the view, of those near grazing, of the light's polar angle and of its azimuth: of albedos within 1e-3 of
# themselves, and of some that take no time, within 1 %.
_FINE, _COARSE = (160, 40, 12, 48), (24, 8, 3, 10)
# Of anisotropic models the round ones: an albedo that depends on the azimuth would be no function of N·V.
_ROUND = {"roughness_v": "roughness_u", "exponent_v": "exponent_u"}


def _round(parameters):
    kept = [q for q in parameters if q.id not in _ROUND and q.id not in ("tangent", "diffuse_color")]
    return tuple(replace(q, label=q.label.removesuffix(" U"), help=q.help.replace(" along the tangent", ""))
                 for q in kept)


@dataclass(frozen=True)
class PumpedModel(FormulaModel):
    """f_0 / D, f_0 the `base` model's lobe without colour, times the base's colour."""

    base: FormulaModel = None

    def resolve(self, given: dict) -> dict:
        """All parameters checked and completed with defaults."""
        values = super().resolve(given)
        for across, along in _ROUND.items():
            if along in values:
                values[across] = values[along]
        return values

    def evaluate_fast(self, view, light, p):
        """See `Model`: the albedos that it is pumped up by are integrated by few nodes."""
        def lobe(view, light, p):
            return self.base.lobe(view, light, p) / _correction(self.base, view, light, p, _COARSE)

        return replace(self, lobe=lobe)._value(view, light, p)


def pumped(base: FormulaModel) -> PumpedModel:
    """The model `pumped_<id>` of a symmetric model. Raises ValueError for one that is not symmetric."""
    if not base.symmetric:
        raise ValueError(f"{base.id} is not symmetric, and only symmetric functions can be pumped up")
    shape = _round(base.parameters)
    estimator = tuple(q for q in shape if not q.evaluated)
    parameters = tuple(q for q in shape if q.evaluated) + PUMPING + estimator
    return PumpedModel(
        id=f"pumped_{base.id}", label=f"Pumped {base.label}", description=f"{base.label} divided by its own albedo: "
        "energy-conserving, and bright to grazing angles", parameters=parameters,
        formula=f"[{base.formula}] / D", references=(*base.references, f"{pumping.NEUMANN}, eq. 16, 20, 21"),
        lobe=lambda view, light, p: base.lobe(view, light, p) / _correction(base, view, light, p),
        sampler=lambda p: base.sampler({**p, "diffuse_color": (0.0, 0.0, 0.0)}), width=base.width,
        width_parameter=base.width_parameter, widened_with=base.widened_with,
        power_bases=base.power_bases, colour=base.colour, base=base)


def _correction(base, view, light, p, grid=_FINE):
    return pumping.correction_at(lambda mu, count: _albedos(base, mu, p, count, grid), view[:, 2], light[:, 2],
                                 p["pumps"], p["control"])


def _albedos(base, mu, p, stages, grid):
    """Albedos a_0, a_1, .. of the pump stages of a model's lobe at N·V = `mu` (N,): (N, stages)."""
    key = tuple((q.id, p[q.id]) for q in base.parameters if q.id in p and q.evaluated and q.kind in ("float", "bool"))
    nodes, rows = _stages(base, key, bool(p["control"]), stages, grid)
    return _between(nodes, rows, mu)


@lru_cache(maxsize=64)
def _stages(base, key, control, stages, grid):
    """Logarithms of cosines (nodes,) and of albedos (stages, nodes)."""
    p = dict(key)
    count, grazing, polar, azimuthal = grid
    nodes = np.unique(np.concatenate([np.log(np.cos(np.linspace(0.0, 0.5 * np.pi, count - grazing, endpoint=False))),
                                      np.linspace(np.log(_FLATTEST), np.log(0.03), grazing)]))
    nodes = nodes[nodes >= np.log(_FLATTEST) - 1e-12]
    views = view_at(np.exp(nodes))
    # Views have nodes of different number; where one has fewer, the rest gets no energy.
    rings = [_rings(base, view, p, polar, azimuthal) for view in views]
    shape = len(views), max(len(mu) for mu, _ in rings)
    mu_light, energy = np.ones(shape), np.zeros(shape)
    for row, (mu, ring) in enumerate(rings):
        mu_light[row, :len(mu)], energy[row, :len(mu)] = mu, ring

    def at_lights(albedo):
        return _between(nodes, [_logarithm(albedo)], mu_light)[..., 0]

    found = pumping.stage_albedos(energy, views[:, 2], mu_light, stages, control, at_lights)
    return nodes, _logarithm(found.T)


def _rings(base, view, p, polar, azimuthal):
    """N·L of rings of lights (N,), and the part of a_0 that comes from each of them to one view (3,)."""
    light, weight = quadrature.hemisphere_nodes(view, base.width(p), polar=polar, azimuthal=azimuthal)
    energy = base.lobe(np.broadcast_to(view, light.shape), light, p) * weight
    return light[::azimuthal, 2], energy.reshape(-1, azimuthal).sum(axis=1)


def _logarithm(albedo):
    return np.log(np.maximum(albedo, _BLACK))


def _between(nodes, rows, mu):
    x = np.log(np.clip(mu, 1e-30, 1.0))
    below = np.minimum(x - nodes[0], 0.0)
    slopes = [np.clip((row[1] - row[0]) / (nodes[1] - nodes[0]), -_STEEPEST, _STEEPEST) for row in rows]
    return np.exp(np.stack([np.interp(x, nodes, row) + slope * below
                            for row, slope in zip(rows, slopes, strict=True)], axis=-1))
