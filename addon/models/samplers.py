"""Samplers of the lobes of formulas, with their exact densities.

A sampler has two methods. `sample(view, u)` returns light directions (N, 3) from uniform numbers `u` (N, 2) in 0..1.
`pdf(view, light)` returns their density (N,) in 1/sr over the whole sphere. Views and lights are unit vectors (N, 3).
"""
from dataclasses import dataclass

import numpy as np

from .geometry import around, dot, half, reflect
from .microfacet import beckmann

TWO_PI = 2.0 * np.pi


@dataclass(frozen=True)
class Cosine:
    """Lambert's lobe: the density is N·L / pi."""

    def sample(self, view, u):
        radius, phi = np.sqrt(1.0 - u[:, 0]), TWO_PI * u[:, 1]
        return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(u[:, 0])], axis=-1)

    def pdf(self, view, light):
        return np.maximum(light[:, 2], 0.0) / np.pi


@dataclass(frozen=True)
class AxisPower:
    """A power of a cosine: the density is (n+1)/(2 pi) max(axis·L, 0)^n with the axis `axis(view)` (N, 3)."""

    axis: object
    exponent: float

    def sample(self, view, u):
        return around(self.axis(view), u[:, 0] ** (1.0 / (self.exponent + 1.0)), TWO_PI * u[:, 1])

    def pdf(self, view, light):
        return (self.exponent + 1.0) / TWO_PI * np.maximum(dot(self.axis(view), light), 0.0) ** self.exponent


class HalfVector:
    """Samples half vectors in the upper hemisphere, and reflects the view about them.

    A subclass has `draw(u)`, half vectors (N, 3) from uniform numbers (N, 2), and `density(h)`, their density (N,) in
    1/sr over the upper hemisphere.
    """

    def sample(self, view, u):
        return reflect(view, self.draw(u))

    def pdf(self, view, light):
        # The sampled half vector is the one of h and -h that is above the horizon.
        h = half(view, light)
        h = np.where(h[:, 2:] < 0.0, -h, h)
        return self.density(h) / (4.0 * np.maximum(np.abs(dot(view, h)), 1e-12))


@dataclass(frozen=True)
class HalfBeckmann(HalfVector):
    """Half vectors by Ward's density exp(-tan²θ (cos²φ/m_x² + sin²φ/m_y²)) / (pi m_x m_y cos³θ)."""

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
    """Half vectors by sqrt((n_u+1)(n_v+1))/(2 pi) (N·H)^(n_u cos²φ + n_v sin²φ): Ashikhmin and Shirley 2000, eq. 6."""

    nu: float
    nv: float

    def draw(self, u):
        # atan2 on the stretched circle covers all four quadrants. Eq. 9 of the paper covers the first.
        phi = np.arctan2(np.sqrt(self.nu + 1.0) * np.sin(TWO_PI * u[:, 1]),
                         np.sqrt(self.nv + 1.0) * np.cos(TWO_PI * u[:, 1]))
        power = self.nu * np.cos(phi) ** 2 + self.nv * np.sin(phi) ** 2
        z = np.maximum(u[:, 0], 1e-300) ** (1.0 / (power + 1.0))
        return half_vectors(z, phi)

    def density(self, h):
        return np.sqrt((self.nu + 1.0) * (self.nv + 1.0)) / TWO_PI * half_power(h, self.nu, self.nv)


@dataclass(frozen=True, eq=False)
class HalfCells(HalfVector):
    """Half vectors by cells of the hemisphere: the cell by its `share` (rings, turns), uniform inside it.

    Uniform means in solid angle. `rings` (rings + 1,) are the edges of the rings in radians from the normal. All cells
    of a ring have the same width. The shares sum to 1.
    """

    rings: np.ndarray
    share: np.ndarray

    def draw(self, u):
        # The cell, by inversion of the cumulative shares.
        ends = np.cumsum(self.share.ravel())
        position = u[:, 0] * ends[-1]
        cell = np.minimum(np.searchsorted(ends, position), len(ends) - 1)
        # The position inside the cell's interval is uniform, too: it sets the height inside the ring.
        fraction = np.clip(1.0 - (ends[cell] - position) / np.maximum(self.share.ravel()[cell], 1e-300), 0.0, 1.0)
        ring, turn = np.divmod(cell, self.share.shape[1])
        z, phi = np.cos(self.rings), TWO_PI * (turn + u[:, 1]) / self.share.shape[1]
        return half_vectors(z[ring] + fraction * (z[ring + 1] - z[ring]), phi)

    def density(self, h):
        rings, turns = self.share.shape
        ring = np.clip(np.searchsorted(-np.cos(self.rings), -h[:, 2], side="right") - 1, 0, rings - 1)
        turn = np.minimum((np.arctan2(h[:, 1], h[:, 0]) % TWO_PI / TWO_PI * turns).astype(int), turns - 1)
        return self.share[ring, turn] / (-np.diff(np.cos(self.rings)) * TWO_PI / turns)[ring]


def half_vectors(z, phi):
    """Unit vectors (..., 3) with the component `z` along the normal and the azimuth `phi`, which broadcast."""
    across = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.stack(np.broadcast_arrays(across * np.cos(phi), across * np.sin(phi), z), axis=-1)


def half_power(h, nu, nv):
    """(N·H)^((n_u h_x² + n_v h_y²) / (1 - h_z²)) of half vectors `h` (..., 3), shape (...)."""
    across2 = h[..., 0] ** 2 + h[..., 1] ** 2
    power = np.where(across2 > 0.0, (nu * h[..., 0] ** 2 + nv * h[..., 1] ** 2) / np.maximum(across2, 1e-300), nu)
    return np.maximum(h[..., 2], 0.0) ** power


@dataclass(frozen=True)
class Mixture:
    """A mixture of the samplers in `parts`, ((weight, sampler), ...), with probabilities by their weights."""

    parts: tuple

    def sample(self, view, u):
        # The first uniform number chooses the sampler.
        chances = np.array([weight for weight, _ in self.parts], dtype=np.float64)
        ends = np.cumsum(chances / chances.sum())
        ends[-1] = 1.0
        chosen = np.minimum(np.searchsorted(ends, u[:, 0]), len(ends) - 1)
        # Its position inside the chosen interval is uniform, too, and is used again.
        light = np.empty(view.shape)
        for i, (_, sampler) in enumerate(self.parts):
            rows = chosen == i
            low = ends[i - 1] if i else 0.0
            reused = np.clip((u[rows, 0] - low) / max(ends[i] - low, 1e-300), 1e-300, 1.0)
            light[rows] = sampler.sample(view[rows], np.stack([reused, u[rows, 1]], axis=-1))
        return light

    def pdf(self, view, light):
        total = sum(weight for weight, _ in self.parts)
        return sum(weight / total * sampler.pdf(view, light) for weight, sampler in self.parts)
