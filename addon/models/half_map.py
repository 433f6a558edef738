"""A distribution of half vectors that is an image: the hemisphere as it is seen from above, N in the middle.

The pixel at (x, y), both -1..1, x along the tangent, to the right, and y across it, up, is the half vector with these
parts in the plane; its value is in proportion to the density p in 1/sr. Between pixels' centres p is bilinear, and the
scale is such that its integral over the hemisphere is 1. What lies outside the unit circle is no half vector.
"""
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from . import images
from .errors import ImageError
from .samplers import HalfCells, half_vectors

MOST = 256  # pixels across: larger images are averaged down
ENOUGH, FINE = 96, 256  # nodes across that integrals have at least
LARGEST = 8192
EVERYWHERE = 1e-3  # share of samples that is spread evenly: none is left out where p is small


@dataclass(frozen=True, eq=False)
class HalfMap:
    """p of the square image `pixels` (N, N) in 1/sr, row 0 at the bottom, turned about N by `turn` radians."""

    pixels: np.ndarray
    turn: float = 0.0

    def density(self, h):
        """p in 1/sr of unit half vectors (..., 3) above the horizon, shape (...)."""
        h, size, p = _turned(h, -self.turn), len(self.pixels), self.pixels
        x, y = (np.clip(0.5 * size * (h[..., i] + 1.0) - 0.5, 0.0, size - 1.0) for i in (0, 1))
        i, j = (np.minimum(at.astype(int), size - 2) for at in (x, y))
        x, y = x - i, y - j
        return (1.0 - y) * ((1.0 - x) * p[j, i] + x * p[j, i + 1]) + y * ((1.0 - x) * p[j + 1, i] + x * p[j + 1, i + 1])

    @cached_property
    def nodes(self):
        """Half vectors (M, 3) to integrate by, the solid angle of each, and p times that, (M,) both.

        They are pixels' centres, of most images others between them: the integral of what is bilinear is the sum of its
        values there. FINE is for what bends in addition, N·L / max(N·L, N·V) at grazing most.
        """
        return self._nodes(FINE)

    @cached_property
    def few_nodes(self):
        """As `nodes`, for what is as smooth as the image."""
        return self._nodes(ENOUGH)

    def _nodes(self, least):
        size = len(self.pixels)
        h, area, centre = _squares(size if size >= least else size * (1 + 2 * -(-(least - size) // (2 * size))))
        return _turned(h, self.turn), area, self.density(_turned(centre, self.turn)) * area

    @cached_property
    def sampler(self):
        """Draws half vectors by cells of the hemisphere, rings times turns, which unlike pixels end where it does."""
        size = max(len(self.pixels), ENOUGH)
        rings, turns = np.linspace(0.0, 0.5 * np.pi, round(0.25 * np.pi * size) + 1), round(np.pi * size)
        z, found = np.cos(rings), 0.0
        for along, around in ((0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)):
            phi = 2.0 * np.pi * (np.arange(turns) + around) / turns
            found = found + self.density(half_vectors((z[:-1] + along * np.diff(z))[:, None], phi))
        even = np.broadcast_to(-np.diff(z)[:, None], found.shape)
        share = (1.0 - EVERYWHERE) * found * even / (found * even).sum() + EVERYWHERE * even / even.sum()
        return HalfCells(rings, share)

    @cached_property
    def slope(self) -> float:
        """Root of twice the mean square distance of half vectors from their mean, along the narrower axis.

        In the plane, as m is of microfacets; at least a pixel.
        """
        h, _, mass = self.few_nodes
        variance = mass @ h[:, :2] ** 2 - (mass @ h[:, :2]) ** 2
        return float(np.clip(np.sqrt(2.0 * max(variance.min(), 0.0)), 2.0 / len(self.pixels), 1.0))

    @cached_property
    def is_mirrored(self) -> bool:
        """Whether p is its own mirror image about the tangent and about the direction across it."""
        quarters = 2.0 * self.turn / np.pi
        flips = (self.pixels[::-1], self.pixels[:, ::-1])
        close = 1e-4 * self.pixels.max()
        return abs(quarters - round(quarters)) < 1e-6 and all(np.abs(f - self.pixels).max() <= close for f in flips)


def lights(nodes, view):
    """Lights (M, 3) above the horizon, solid angles times N·L, and p dω_H, (M,) both, that `view` (3,) sees by nodes.

    The nodes are those of a HalfMap: dω_L = 4 V·H dω_H.
    """
    h, area, mass = nodes
    facing = h @ view
    light = 2.0 * facing[:, None] * h - view
    lit = (facing > 0.0) & (light[:, 2] > 0.0)
    return light[lit], 4.0 * facing[lit] * light[lit, 2] * area[lit], mass[lit]


def of_image(luminance, turn: float = 0.0) -> HalfMap:
    """The distribution of an image (N, N) of any unit, row 0 at the top. Raises ImageError for one of no use."""
    height, width = luminance.shape
    if height != width:
        raise ImageError(f"{width} x {height} pixels; it must be square, or half vectors would be stretched", "square")
    if not 2 <= width <= LARGEST:
        raise ImageError(f"{width} pixels across are not within 2 .. {LARGEST}", "size")
    if not np.isfinite(luminance).all() or luminance.min() < 0.0:
        bad = luminance[~np.isfinite(luminance) | (luminance < 0.0)][0]
        raise ImageError(f"a pixel is {bad:g}; densities are finite numbers, 0 or more", "pixel")
    relative = HalfMap(_averaged(luminance[::-1] / max(luminance.max(), 1e-300)))
    total = relative.nodes[2].sum()
    if not total > 0.0:
        raise ImageError("every pixel inside the unit circle is 0; there is no half vector to reflect by", "black")
    return HalfMap(relative.pixels / total, turn)


def load(path, turn: float = 0.0) -> HalfMap:
    """The distribution of an image file, turned by `turn` radians; kept until the file changes.

    Raises ImageError that names the file and what is wrong with it.
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
    """A square image brought down to MOST pixels across by averages over the area of the new ones."""
    size = len(pixels)
    if size <= MOST:
        return pixels
    edges = np.linspace(0.0, size, MOST + 1)
    low = np.minimum(edges.astype(int), size - 1)
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
    """Middles on the hemisphere (M, 3) and solid angles (M,) of the size² squares of the disk, and their centres there.

    The centres (M, 3) have no height. Squares on the rim are cut off by it. Along x integrals of 1/z, x/z, y/z and z/z
    are in closed form.
    """
    edges = np.linspace(-1.0, 1.0, size + 1)
    y = ((np.arange(size * parts) + 0.5) * 2.0 / (size * parts) - 1.0)[:, None]
    radius = np.sqrt(1.0 - y * y)
    x = np.clip(edges, -radius, radius)
    angle = np.diff(np.arcsin(x / radius), axis=1)
    height = np.sqrt(np.maximum(radius**2 - x * x, 0.0))
    sums = np.stack([-np.diff(height, axis=1), y * angle, np.diff(x, axis=1), angle])
    sums = sums.reshape(4, size, parts, size).sum(axis=2).reshape(4, -1) * 2.0 / (size * parts)
    *middle, area = sums[:, sums[3] > 0.0]
    h = np.stack(middle, axis=-1)
    at = 0.5 * (edges[1:] + edges[:-1])
    centre = np.stack([*np.meshgrid(at, at), np.zeros((size, size))], axis=-1).reshape(-1, 3)[sums[3] > 0.0]
    return h / np.linalg.norm(h, axis=-1, keepdims=True), area, centre
