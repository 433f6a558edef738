"""Directions drawn from the lobes that formulas are made of, with their exact densities.

A sampler has `sample(view, u)`, light directions (N, 3) from uniform numbers (N, 2), and `pdf(view, light)`, their
density in 1/sr over the whole sphere (N,). Both take unit vectors (N, 3).
"""
from dataclasses import dataclass

import numpy as np

from .geometry import around, dot, half, reflect
from .microfacet import beckmann

TWO_PI = 2.0 * np.pi


@dataclass(frozen=True)
class Cosine:
    """Lambert's: in proportion to N·L."""

    def sample(self, view, u):
        radius, phi = np.sqrt(1.0 - u[:, 0]), TWO_PI * u[:, 1]
        return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(u[:, 0])], axis=-1)

    def pdf(self, view, light):
        return np.maximum(light[:, 2], 0.0) / np.pi


@dataclass(frozen=True)
class AxisPower:
    """(n+1)/(2 pi) max(axis·L, 0)^n about `axis(view)`."""

    axis: object
    exponent: float

    def sample(self, view, u):
        return around(self.axis(view), u[:, 0] ** (1.0 / (self.exponent + 1.0)), TWO_PI * u[:, 1])

    def pdf(self, view, light):
        return (self.exponent + 1.0) / TWO_PI * np.maximum(dot(self.axis(view), light), 0.0) ** self.exponent


class HalfVector:
    """Half vectors with a density over the upper hemisphere, (pi - theta_h symmetric): the light mirrors the view.

    A subclass draws them, `draw(u)` (N, 3) from (N, 2), and knows their `density(h)` in 1/sr (N,).
    """

    def sample(self, view, u):
        return reflect(view, self.draw(u))

    def pdf(self, view, light):
        # Below the horizon the half vector that was drawn is the one of h and -h that lies above it.
        h = half(view, light)
        h = np.where(h[:, 2:] < 0.0, -h, h)
        return self.density(h) / (4.0 * np.maximum(np.abs(dot(view, h)), 1e-12))


@dataclass(frozen=True)
class HalfBeckmann(HalfVector):
    """Half vectors as Ward draws them: exp(-tan²(cos²/m_x² + sin²/m_y²)) / (pi m_x m_y cos³)."""

    mx: float
    my: float

    def draw(self, u):
        turn = TWO_PI * u[:, 1]
        radius = np.sqrt(-np.log(np.maximum(u[:, 0], 1e-300)))
        slopes = np.stack([self.mx * radius * np.cos(turn), self.my * radius * np.sin(turn)], axis=-1)
        h = np.concatenate([slopes, np.ones((len(u), 1))], axis=-1)
        return h / np.linalg.norm(h, axis=-1, keepdims=True)

    def density(self, h):
        return beckmann(h, self.mx, self.my) * h[:, 2]


@dataclass(frozen=True)
class HalfPower(HalfVector):
    """Half vectors by sqrt((n_u+1)(n_v+1))/(2 pi) (N·H)^(n_u cos² + n_v sin²): Ashikhmin and Shirley 2000, eq. 6."""

    nu: float
    nv: float

    def draw(self, u):
        # atan2 of the stretched circle gives all four quadrants (their eq. 9 is for the first).
        phi = np.arctan2(np.sqrt(self.nu + 1.0) * np.sin(TWO_PI * u[:, 1]),
                         np.sqrt(self.nv + 1.0) * np.cos(TWO_PI * u[:, 1]))
        power = self.nu * np.cos(phi) ** 2 + self.nv * np.sin(phi) ** 2
        z = np.maximum(u[:, 0], 1e-300) ** (1.0 / (power + 1.0))
        return half_vectors(z, phi)

    def density(self, h):
        return np.sqrt((self.nu + 1.0) * (self.nv + 1.0)) / TWO_PI * half_power(h, self.nu, self.nv)


@dataclass(frozen=True, eq=False)
class HalfCells(HalfVector):
    """Half vectors by the `share` (rings, turns) of each cell of the hemisphere, and evenly in solid angle inside it.

    `rings` (rings + 1,) are the edges of the rings in radians from the normal; a ring's cells are as wide as each
    other. The shares sum to 1.
    """

    rings: np.ndarray
    share: np.ndarray

    def draw(self, u):
        ends = np.cumsum(self.share.ravel())
        place = u[:, 0] * ends[-1]
        cell = np.minimum(np.searchsorted(ends, place), len(ends) - 1)
        rest = np.clip(1.0 - (ends[cell] - place) / np.maximum(self.share.ravel()[cell], 1e-300), 0.0, 1.0)
        ring, turn = np.divmod(cell, self.share.shape[1])
        z = np.cos(self.rings)
        return half_vectors(z[ring] + rest * (z[ring + 1] - z[ring]), TWO_PI * (turn + u[:, 1]) / self.share.shape[1])

    def density(self, h):
        rings, turns = self.share.shape
        ring = np.clip(np.searchsorted(-np.cos(self.rings), -h[:, 2], side="right") - 1, 0, rings - 1)
        turn = np.minimum((np.arctan2(h[:, 1], h[:, 0]) % TWO_PI / TWO_PI * turns).astype(int), turns - 1)
        return self.share[ring, turn] / (-np.diff(np.cos(self.rings)) * TWO_PI / turns)[ring]


def half_vectors(z, phi):
    """Unit vectors (..., 3) whose part along the normal is `z` and whose azimuth is `phi`, which broadcast."""
    across = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.stack(np.broadcast_arrays(across * np.cos(phi), across * np.sin(phi), z), axis=-1)


def half_power(h, nu, nv):
    """(N·H)^((n_u h_x² + n_v h_y²) / (1 - h_z²)) of half vectors (N, 3), shape (N,)."""
    across2 = h[..., 0] ** 2 + h[..., 1] ** 2
    power = np.where(across2 > 0.0, (nu * h[..., 0] ** 2 + nv * h[..., 1] ** 2) / np.maximum(across2, 1e-300), nu)
    return np.maximum(h[..., 2], 0.0) ** power


@dataclass(frozen=True)
class Mixture:
    """One of `parts`, ((weight, sampler), ...), chosen in proportion to the weights."""

    parts: tuple

    def sample(self, view, u):
        chances = np.array([weight for weight, _ in self.parts], dtype=np.float64)
        ends = np.cumsum(chances / chances.sum())
        ends[-1] = 1.0
        chosen = np.minimum(np.searchsorted(ends, u[:, 0]), len(ends) - 1)
        light = np.empty(view.shape)
        for i, (_, sampler) in enumerate(self.parts):
            mine = chosen == i
            low = ends[i - 1] if i else 0.0
            again = np.clip((u[mine, 0] - low) / max(ends[i] - low, 1e-300), 1e-300, 1.0)
            light[mine] = sampler.sample(view[mine], np.stack([again, u[mine, 1]], axis=-1))
        return light

    def pdf(self, view, light):
        total = sum(weight for weight, _ in self.parts)
        return sum(weight / total * sampler.pdf(view, light) for weight, sampler in self.parts)
