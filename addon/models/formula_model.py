"""Models that consist of a formula alone. They render by lobe rows that are baked for their parameters.

A new model needs no more than this: a function in NumPy, a sampler, and the lobe's width.
"""
from dataclasses import dataclass

import numpy as np

from . import fresnel, quadrature
from .geometry import dot, half, view_at
from .registry import Model


@dataclass(frozen=True)
class FormulaModel(Model):
    """f(V, L) = lobe(V, L) times a color, plus the parameter `diffuse_color` times a diffuse factor.

    Functions take views and lights (N, 3) above the horizon, and resolved parameters `p`.

    - `lobe(view, light, p)`: the lobe (N,) in 1/sr.
    - `sampler(p)`: the distribution of `sample` and `pdf`, see samplers.py.
    - `width(p)`: about the root mean square slope of the half vectors of the narrowest lobe. It sets how dense the
      nodes of integrals are.
    - `colour(view, light, p)`: the color (N, 3), or None if it is white.
    - `diffuse(view, light, p)`: the diffuse factor (N,) or (N, 3) in 1/sr.
    - `symmetric`: whether f(V, L) = f(L, V).
    - `stretched(p)`, of models with a tangent, x: the widths of the lobe along and across it, the larger of them 1.
    - `mirrored(p)`, of lobes of any shape: whether the lobe is symmetric about the tangent and about the direction
      across it.
    - `spike(mu, p)`: the reflectance (N, 3) at N·V = `mu` (N,) of a perfect mirror, which is added to the albedo but is
      no part of f.
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
        """Albedo without the spike for one view (3,) and resolved parameters `p`: a number or (3,)."""
        return quadrature.hemisphere(lambda v, light: self._value(v, light, p), view, self.width(p),
                                     mirrored=self.stretched is None)

    def lights(self, view, p, widest: float, **counts):
        """Quadrature for functions like the lobe at one view (3,): lights (N, 3) and weights (N,).

        A weight is the solid angle times N·L. The lobe's width is clamped to `widest`. `counts` are arguments of
        `quadrature.hemisphere_nodes`.
        """
        return quadrature.hemisphere_nodes(view, min(self.width(p), widest), self.stretched is None, **counts)

    def _sample(self, view, u, p):
        return self.sampler(p).sample(view, u)

    def _pdf(self, view, light, p):
        return self.sampler(p).pdf(view, light)


def constant(view, light, p):
    """The parameter `base_color` (N, 3), or None if it is white."""
    white = p["base_color"] == (1.0, 1.0, 1.0)
    return None if white else np.broadcast_to(np.asarray(p["base_color"]), (len(view), 3))


def schlick(view, light, p):
    """Schlick's factor (N, 3) at V·H, from `base_color` at normal incidence to 1. None if it is white."""
    if p["base_color"] == (1.0, 1.0, 1.0):
        return None
    return fresnel.schlick(dot(view, half(view, light)), p["base_color"], (1.0, 1.0, 1.0))


def factor(view, light, p):
    """The Fresnel factor (N, 3) of the parameters COLOUR at V·H, or None if it is white."""
    if fresnel.is_white(p):
        return None
    mu = dot(view, half(view, light))
    return fresnel.factor(p["fresnel_type"], mu, p["base_color"], p["f90"], p["ior"], p["extinction"])


def lambert(view, light, p):
    """Lambert's diffuse factor 1 / pi, (N,)."""
    return np.full(len(view), 1.0 / np.pi)
