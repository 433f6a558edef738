"""Models that are a formula and nothing else: they render through weights that are baked for their parameters.

This is the whole of what a new model needs: a function in NumPy, what to draw from, how wide it is.
"""
from dataclasses import dataclass

import numpy as np

from . import fresnel, quadrature
from .geometry import dot, half, view_at
from .registry import Model


@dataclass(frozen=True)
class FormulaModel(Model):
    """f(V, L) = lobe(V, L) times a colour, plus a diffuse colour times an amount.

    `lobe(view, light, p)` (N,) in 1/sr is asked above the horizon only. `colour(view, light, p)` gives (N, 3), or None
    where it is white. `diffuse(view, light, p)` gives the amount of `diffuse_color` (N,) or (N, 3), in 1/sr.
    `sampler(p)` is what `sample` draws from (see samplers.py). `width(p)` is about the root mean square slope of the
    half vectors of the narrowest lobe: it says how fine to look. `symmetric` tells whether f(V, L) = f(L, V) is
    claimed. `stretched(p)`, of models that know a tangent, x, gives the widths of the lobe along and across it, the
    larger 1. `mirrored(p)`, of models whose lobe may have any shape, tells whether it is its own mirror image about the
    tangent and about the direction across it. `spike(mu, p)`, where there is one, is the reflectance (N, 3) of a
    perfect mirror on top, which is no part of f.
    """

    lobe: object
    sampler: object
    width: object
    colour: object = None
    diffuse: object = None
    symmetric: bool = True
    stretched: object = None
    mirrored: object = None
    spike: object = None

    def _value(self, view, light, p):
        value = self.lobe(view, light, p)
        colour = self.colour and self.colour(view, light, p)
        if colour is not None:
            value = value[:, None] * colour
        if self.diffuse is None or not any(p["diffuse_color"]):
            return value
        amount = np.asarray(self.diffuse(view, light, p))
        amount = amount if amount.ndim == 2 else amount[:, None]
        return (value if value.ndim == 2 else value[:, None]) + amount * np.asarray(p["diffuse_color"])

    def _albedo(self, mu, p):
        albedo = np.array([self.albedo_from(view, p) for view in view_at(np.maximum(mu, 1e-6))])
        if self.spike is None:
            return albedo
        return (albedo if albedo.ndim == 2 else albedo[:, None]) + self.spike(mu, p)

    def albedo_from(self, view, p):
        """Albedo without the spike for one view (3,), of resolved parameters: a number or (3,)."""
        return quadrature.hemisphere(lambda v, light: self._value(v, light, p), view, self.width(p),
                                     mirrored=self.stretched is None)

    def lights(self, view, p, widest: float, **counts):
        """Lights (N, 3) and weights (N,), solid angle times N·L, to integrate what is like the lobe of one view (3,).

        A lobe wider than `widest` is looked at as if it were that; `counts` are those of quadrature.hemisphere_nodes.
        """
        return quadrature.hemisphere_nodes(view, min(self.width(p), widest), self.stretched is None, **counts)

    def _sample(self, view, u, p):
        return self.sampler(p).sample(view, u)

    def _pdf(self, view, light, p):
        return self.sampler(p).pdf(view, light)



def constant(view, light, p):
    """The parameter `base_color`, or None where it is white."""
    white = p["base_color"] == (1.0, 1.0, 1.0)
    return None if white else np.broadcast_to(np.asarray(p["base_color"]), (len(view), 3))


def schlick(view, light, p):
    """Schlick's factor from `base_color` at normal incidence to 1, at V·H; None where that is white."""
    if p["base_color"] == (1.0, 1.0, 1.0):
        return None
    return fresnel.schlick(dot(view, half(view, light)), p["base_color"], (1.0, 1.0, 1.0))


def factor(view, light, p):
    """The factor of the parameters COLOUR at V·H, or None where it is white."""
    if fresnel.is_white(p):
        return None
    mu = dot(view, half(view, light))
    return fresnel.factor(p["fresnel_type"], mu, p["base_color"], p["f90"], p["ior"], p["extinction"])


def lambert(view, light, p):
    """1 / pi."""
    return np.full(len(view), 1.0 / np.pi)
