"""A distribution of half vectors from an image, which shows the hemisphere from above, with N in the middle.

The pixel at (x, y), both -1..1, is the half vector with these in-plane components: x, to the right, is along the
tangent, and y, up, is across it. Its value is proportional to the density p in 1/sr. Between the pixels' centers, p is
bilinear. It is scaled so that its integral over the hemisphere is 1. Pixels outside the unit circle are not used.
"""
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from . import images
from .errors import ImageError
from .samplers import HalfCells, half_vectors

# The largest number of pixels across. Larger images are averaged down to it.
MOST = 256
# The least numbers of nodes across, of integrals of smooth functions and of functions with kinks.
ENOUGH, FINE = 96, 256
# The largest number of pixels across of an image file.
LARGEST = 8192
# The share of samples that is uniform over the hemisphere, so that the density is nowhere 0.
EVERYWHERE = 1e-3


@dataclass(frozen=True, eq=False)
class HalfMap:
    """p in 1/sr of the square image `pixels` (N, N), row 0 at the bottom, turned about the normal by `turn` radians."""

    pixels: np.ndarray
    turn: float = 0.0

    def density(self, h):
        """p in 1/sr of unit half vectors (..., 3) above the horizon, shape (...). Bilinear interpolation."""
        h, size, p = _turned(h, -self.turn), len(self.pixels), self.pixels
        x, y = (np.clip(0.5 * size * (h[..., i] + 1.0) - 0.5, 0.0, size - 1.0) for i in (0, 1))
        i, j = (np.minimum(at.astype(int), size - 2) for at in (x, y))
        x, y = x - i, y - j
        return (1.0 - y) * ((1.0 - x) * p[j, i] + x * p[j, i + 1]) + y * ((1.0 - x) * p[j + 1, i] + x * p[j + 1, i + 1])

    @cached_property
    def nodes(self):
        """Quadrature nodes: half vectors (M, 3), their solid angles (M,), and p times the solid angle (M,).

        The nodes are the pixels' centers, and for images of fewer than FINE pixels also points between them. A
        bilinear function's integral is the sum of its values at the centers. Functions with kinks need FINE nodes
        across: N·L / max(N·L, N·V), above all at grazing.
        """
        return self._nodes(FINE)

    @cached_property
    def few_nodes(self):
        """As `nodes`, for functions as smooth as the image."""
        return self._nodes(ENOUGH)

    def _nodes(self, least):
        size = len(self.pixels)
        h, area, center = _squares(size if size >= least else size * (1 + 2 * -(-(least - size) // (2 * size))))
        return _turned(h, self.turn), area, self.density(_turned(center, self.turn)) * area

    @cached_property
    def sampler(self):
        """A sampler of half vectors by cells of the hemisphere, rings times turns.

        Unlike pixels, cells end at the hemisphere's rim.
        """
        # The sum of p at four points of each cell.
        size = max(len(self.pixels), ENOUGH)
        rings, turns = np.linspace(0.0, 0.5 * np.pi, round(0.25 * np.pi * size) + 1), round(np.pi * size)
        z, total = np.cos(rings), 0.0
        for along, around in ((0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)):
            phi = 2.0 * np.pi * (np.arange(turns) + around) / turns
            total = total + self.density(half_vectors((z[:-1] + along * np.diff(z))[:, None], phi))
        # The cells' shares: p times the solid angle, mixed with a uniform share.
        even = np.broadcast_to(-np.diff(z)[:, None], total.shape)
        share = (1.0 - EVERYWHERE) * total * even / (total * even).sum() + EVERYWHERE * even / even.sum()
        return HalfCells(rings, share)

    @cached_property
    def slope(self) -> float:
        """The slope m of the half vectors: √2 times their standard deviation, along x or y, whichever is smaller.

        It is of their in-plane components, and is clamped to [one pixel, 1].
        """
        h, _, mass = self.few_nodes
        variance = mass @ h[:, :2] ** 2 - (mass @ h[:, :2]) ** 2
        return float(np.clip(np.sqrt(2.0 * max(variance.min(), 0.0)), 2.0 / len(self.pixels), 1.0))

    @cached_property
    def is_mirrored(self) -> bool:
        """Whether p is symmetric about the tangent and about the direction across it."""
        quarters = 2.0 * self.turn / np.pi
        flips = (self.pixels[::-1], self.pixels[:, ::-1])
        close = 1e-4 * self.pixels.max()
        return abs(quarters - round(quarters)) < 1e-6 and all(np.abs(f - self.pixels).max() <= close for f in flips)


def lights(nodes, view):
    """The lights that the half vectors `nodes` of a HalfMap reflect to `view` (3,), for those above the horizon.

    Returns lights (M, 3), their solid angles times N·L (M,), and p dω_H (M,). The solid angles follow from
    dω_L = 4 V·H dω_H.
    """
    h, area, mass = nodes
    facing = h @ view
    light = 2.0 * facing[:, None] * h - view
    lit = (facing > 0.0) & (light[:, 2] > 0.0)
    return light[lit], 4.0 * facing[lit] * light[lit, 2] * area[lit], mass[lit]


def of_image(luminance, turn: float = 0.0) -> HalfMap:
    """The distribution of an image (N, N) in any unit, row 0 at the top. Raises ImageError if it cannot be used."""
    # Size and values.
    height, width = luminance.shape
    if height != width:
        raise ImageError(f"{width} x {height} pixels; it must be square, or half vectors would be stretched", "square")
    if not 2 <= width <= LARGEST:
        raise ImageError(f"{width} pixels across are not within 2 .. {LARGEST}", "size")
    if not np.isfinite(luminance).all() or luminance.min() < 0.0:
        bad = luminance[~np.isfinite(luminance) | (luminance < 0.0)][0]
        raise ImageError(f"a pixel is {bad:g}; densities are finite numbers, 0 or more", "pixel")
    # Division by the maximum keeps sums finite. The scale then makes the integral 1.
    relative = HalfMap(_averaged(luminance[::-1] / max(luminance.max(), 1e-300)))
    total = relative.nodes[2].sum()
    if not total > 0.0:
        raise ImageError("every pixel inside the unit circle is 0; there is no half vector to reflect by", "black")
    return HalfMap(relative.pixels / total, turn)


def load(path, turn: float = 0.0) -> HalfMap:
    """The distribution of an image file, turned by `turn` radians. It is cached until the file changes.

    Raises ImageError, which names the file and the fault.
    """
    return _load(str(path), turn, images.stamp(path))


@lru_cache(maxsize=8)
def _load(path, turn, _):
    luminance = images.luminance(path)
    try:
        return of_image(luminance, turn)
    except ImageError as error:
        raise ImageError(f"image: {path}: {error}", error.code, Path(path)) from None


def _averaged(pixels):
    """A square image of at most MOST pixels across. Each new pixel is the average over its area."""
    size = len(pixels)
    if size <= MOST:
        return pixels
    edges = np.linspace(0.0, size, MOST + 1)
    low = np.minimum(edges.astype(int), size - 1)
    # Rows, then columns: differences of the running sum at the new pixels' edges.
    for _ in (0, 1):
        sums = np.concatenate([np.zeros((1, pixels.shape[1])), np.cumsum(pixels, axis=0)])
        at = sums[low] + (edges - low)[:, None] * pixels[low]
        pixels = (np.diff(at, axis=0) * MOST / size).T
    return pixels


def _turned(h, turn):
    """Vectors (..., 3) turned about the normal by `turn` radians."""
    if not turn:
        return h
    c, s = np.cos(turn), np.sin(turn)
    return np.stack([c * h[..., 0] - s * h[..., 1], s * h[..., 0] + c * h[..., 1], h[..., 2]], axis=-1)


@lru_cache(maxsize=4)
def _squares(size, parts=8):
    """The size² squares of the unit disk: mean directions (M, 3), solid angles (M,), and centers in the plane (M, 3).

    The centers' third component is 0. Squares on the rim are cut by it, and squares outside are left out. Integrals of
    1/z, x/z, y/z and z/z along x are in closed form. Along y each square has `parts` strips.
    """
    # The integrals along x on each strip, summed over the strips of each square.
    edges = np.linspace(-1.0, 1.0, size + 1)
    y = ((np.arange(size * parts) + 0.5) * 2.0 / (size * parts) - 1.0)[:, None]
    radius = np.sqrt(1.0 - y * y)
    x = np.clip(edges, -radius, radius)
    angle = np.diff(np.arcsin(x / radius), axis=1)
    height = np.sqrt(np.maximum(radius**2 - x * x, 0.0))
    sums = np.stack([-np.diff(height, axis=1), y * angle, np.diff(x, axis=1), angle])
    sums = sums.reshape(4, size, parts, size).sum(axis=2).reshape(4, -1) * 2.0 / (size * parts)
    *mean, area = sums[:, sums[3] > 0.0]
    h = np.stack(mean, axis=-1)
    # The squares' centers.
    middle = 0.5 * (edges[1:] + edges[:-1])
    center = np.stack([*np.meshgrid(middle, middle), np.zeros((size, size))], axis=-1).reshape(-1, 3)[sums[3] > 0.0]
    return h / np.linalg.norm(h, axis=-1, keepdims=True), area, center
