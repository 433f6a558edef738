"""Any symmetric formula, pumped up by its own albedo.

Pumping requires only symmetry of f_0 (see pumping.py), so one mechanism serves all formulas. The stages' albedos are
integrated for the current parameters, and cached.
"""
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from . import pumping, quadrature
from .formula_model import FormulaModel
from .geometry import view_at
from .parameters import PUMPING

# The least cosine of a node. Below it, albedos are extrapolated by the power of the cosine that they follow there.
_FLATTEST = 1e-4
# The largest exponent, positive or negative, of that power. Ward's is -1/2, Dür's -1.
_STEEPEST = 1.5
# The least albedo: its logarithm is finite.
_BLACK = 1e-30
# Numbers of nodes: all views, the views near grazing, the light's polar angle on each interval, the light's azimuth.
# Albedos are within 0.1 % (relative) with the fine ones, and within 1 % with the coarse ones, which take little time.
_FINE, _COARSE = (160, 40, 12, 48), (24, 8, 3, 10)
# Anisotropic models are pumped in their round form, since pumping needs an albedo that depends on N·V only. The
# parameter across the tangent gets the value of the one along it.
_ROUND = {"roughness_v": "roughness_u", "exponent_v": "exponent_u"}


def _round(parameters):
    """The parameters of a round lobe without a diffuse part."""
    lobe = [q for q in parameters if q.id not in _ROUND and q.id not in ("tangent", "diffuse_color")]
    return tuple(replace(q, label=q.label.removesuffix(" U"), help=q.help.replace(" along the tangent", ""))
                 for q in lobe)


@dataclass(frozen=True)
class PumpedModel(FormulaModel):
    """f_0 / D times the color of the `base` model, where f_0 is the base's lobe without color."""

    base: FormulaModel = None

    def resolve(self, given: dict) -> dict:
        """See `Model`. The base's parameters across the tangent are set to those along it."""
        values = super().resolve(given)
        for across, along in _ROUND.items():
            if along in values:
                values[across] = values[along]
        return values

    def evaluate_fast(self, view, light, p):
        """See `Model`: the stages' albedos are integrated with few nodes."""
        def lobe(view, light, p):
            return self.base.lobe(view, light, p) / _correction(self.base, view, light, p, _COARSE)

        return replace(self, lobe=lobe)._value(view, light, p)


def pumped(base: FormulaModel) -> PumpedModel:
    """The model `pumped_<id>` of a symmetric model `base`. Raises ValueError if the base is not symmetric."""
    if not base.symmetric:
        raise ValueError(f"{base.id} is not symmetric, and only symmetric functions can be pumped up")
    # The estimator's parameters stay last, as in every model.
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
    """D (N,) of the base's lobe, from albedos integrated with the numbers of nodes `grid`."""
    return pumping.correction_at(lambda mu, count: _albedos(base, mu, p, count, grid), view[:, 2], light[:, 2],
                                 p["pumps"], p["control"])


def _albedos(base, mu, p, stages, grid):
    """Albedos a_0, a_1, .. of the pump stages of the base's lobe at cosines `mu` (N,): (N, stages)."""
    key = tuple((q.id, p[q.id]) for q in base.parameters if q.id in p and q.evaluated and q.kind in ("float", "bool"))
    nodes, rows = _stages(base, key, bool(p["control"]), stages, grid)
    return _between(nodes, rows, mu)


@lru_cache(maxsize=64)
def _stages(base, key, control, stages, grid):
    """Logarithms of the views' cosines (nodes,) and of the stages' albedos there (stages, nodes).

    `key`: the base's parameters as pairs, so that calls can be cached.
    """
    # Views even in the angle, and near grazing even in the logarithm of the cosine.
    p = dict(key)
    count, grazing, polar, azimuthal = grid
    nodes = np.unique(np.concatenate([np.log(np.cos(np.linspace(0.0, 0.5 * np.pi, count - grazing, endpoint=False))),
                                      np.linspace(np.log(_FLATTEST), np.log(0.03), grazing)]))
    nodes = nodes[nodes >= np.log(_FLATTEST) - 1e-12]
    views = view_at(np.exp(nodes))
    # Views have different numbers of rings: missing rings have no energy.
    rings = [_rings(base, view, p, polar, azimuthal) for view in views]
    shape = len(views), max(len(mu) for mu, _ in rings)
    mu_light, energy = np.ones(shape), np.zeros(shape)
    for row, (mu, ring) in enumerate(rings):
        mu_light[row, :len(mu)], energy[row, :len(mu)] = mu, ring

    def at_lights(albedo):
        return _between(nodes, [_logarithm(albedo)], mu_light)[..., 0]

    albedos = pumping.stage_albedos(energy, views[:, 2], mu_light, stages, control, at_lights)
    return nodes, _logarithm(albedos.T)


def _rings(base, view, p, polar, azimuthal):
    """N·L of rings of lights (N,), and each ring's contribution to a_0 at one view (3,), shape (N,)."""
    light, weight = quadrature.hemisphere_nodes(view, base.width(p), polar=polar, azimuthal=azimuthal)
    energy = base.lobe(np.broadcast_to(view, light.shape), light, p) * weight
    return light[::azimuthal, 2], energy.reshape(-1, azimuthal).sum(axis=1)


def _logarithm(albedo):
    return np.log(np.maximum(albedo, _BLACK))


def _between(nodes, rows, mu):
    """Albedos (..., stages) at cosines `mu` (...,), interpolated as powers of the cosine; see `_stages`."""
    x = np.log(np.clip(mu, 1e-30, 1.0))
    below = np.minimum(x - nodes[0], 0.0)
    slopes = [np.clip((row[1] - row[0]) / (nodes[1] - nodes[0]), -_STEEPEST, _STEEPEST) for row in rows]
    return np.exp(np.stack([np.interp(x, nodes, row) + slope * below
                            for row, slope in zip(rows, slopes, strict=True)], axis=-1))
