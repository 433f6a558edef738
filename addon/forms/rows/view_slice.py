"""A view slice: a formula seen from one view, on a polar grid of half vectors."""
from dataclasses import dataclass

import numpy as np

from .layout import Layout

RINGS = 72  # rings of half vectors in a slice, over sin(theta_h)
EVEN = 0.35  # share of the rings that are spaced without regard to energy
DETAIL = 0.3  # largest slope that the quadrature of bases may skip


@dataclass(frozen=True)
class ViewSlice:
    """A formula seen from one `view` (3,), on a polar grid of half vectors. Round formulas have the side y >= 0 only.

    `ring_edges` (RINGS + 1,) are sizes of rings, see `Layout`. These are for the middles of the grid's cells: `light`
    and `half`, unit vectors (RINGS, turns, 3); `lit` (RINGS, turns), whether both are above the horizon; and `density`
    (RINGS, turns, channels), f (N·L) dω_L / dω_H. `area` (RINGS, turns) is the cells' solid angle of half vectors, of
    both sides together. `albedo` (channels,) is the formula's: on ever finer grids the density's sum converges to it.
    `quadrature()` gives lights (N, 3) and weights (N,), as `FormulaModel.lights`, which resolve bases.
    """

    layout: Layout
    view: np.ndarray
    ring_edges: np.ndarray
    light: np.ndarray
    half: np.ndarray
    lit: np.ndarray
    area: np.ndarray
    density: np.ndarray
    albedo: np.ndarray
    quadrature: object

    @classmethod
    def at(cls, model, p: dict, view, layout: Layout) -> "ViewSlice":
        """The slice of a model for resolved parameters `p` at a `view` (3,).

        Raises ValueError where the formula gives negative numbers, or numbers that are not finite.
        """
        # The rings' spacing, by the energy on a coarser grid.
        largest = 1.0 / min(layout.stretch)
        coarse = np.unique(np.concatenate([[0.0], np.geomspace(0.01 * model.width(p), largest, 160),
                                           np.linspace(0.0, largest, 80)]))
        edges = _quantiles(coarse, *_ring_energies(model, p, view, coarse, layout), model.width(p))
        light, half, lit, area = _grid(view, edges, layout.turns, layout)
        density = _density(model, p, view, light, half, lit)
        return cls(layout, view, edges, light, half, lit, area, density, np.atleast_1d(model.albedo_from(view, p)),
                   lambda: model.lights(view, p, DETAIL, polar=6, azimuthal=24))

    @property
    def jacobian(self) -> np.ndarray:
        """dω_L / dω_H, (RINGS, turns): 4 (V·H) where the cell is lit, and 0 elsewhere."""
        return np.where(self.lit, 4.0 * np.maximum(self.half @ self.view, 0.0), 0.0)

    def energy(self, density) -> np.ndarray:
        """The albedo (channels,) of a density like `density`: its sum over the grid."""
        return np.einsum("rt,rtc->c", self.area, density)


def half_vectors(layout: Layout, size, phi) -> np.ndarray:
    """Half vectors (..., 3) at the `size` of a ring and the azimuth `phi` on it in radians, which broadcast."""
    x, y = size * np.cos(phi) * layout.stretch[0], size * np.sin(phi) * layout.stretch[1]
    return np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)


def _ring_energies(model, p, view, edges, layout):
    """(energy (N,) of the strongest channel in the rings between N + 1 `edges`, last edge of a lit ring)."""
    light, half, lit, area = _grid(view, edges, 24, layout)
    energy = (_density(model, p, view, light, half, lit).max(axis=-1) * area).sum(axis=1)
    return energy, edges[1:][lit.any(axis=1)].max()


def _quantiles(edges, energy, last, width):
    """RINGS + 1 edges up to `last`: most at equal steps of energy, the others at equal steps of a logarithm."""
    before = np.concatenate([[0.0], np.cumsum(energy)])
    if not before[-1] > 0.0:
        return np.linspace(0.0, last, RINGS + 1)
    even = np.log1p(np.minimum(edges, last) / width) / np.log1p(last / width)
    mixed = (1.0 - EVEN) * before / before[-1] + EVEN * even
    inside = edges <= last * (1.0 + 1e-12)
    return np.interp(np.linspace(0.0, 1.0, RINGS + 1), mixed[inside] / mixed[inside][-1], edges[inside])


def _grid(view, edges, turns, layout):
    """(light, half vector (rings, turns, 3), whether lit, solid angle (rings, turns)) of the cells between `edges`."""
    # Half vectors in the middles of the cells, by area, and their lights.
    middle2 = 0.5 * (edges[1:] ** 2 + edges[:-1] ** 2)
    size, phi = np.meshgrid(np.sqrt(middle2), (np.arange(turns) + 0.5) / turns * layout.around, indexing="ij")
    half = half_vectors(layout, size, phi)
    up = half[..., 2]
    view_half = half @ view
    light = 2.0 * view_half[..., None] * half - view
    lit = (view_half > 1e-6) & (light[..., 2] > 1e-9) & (up > 1e-3)
    # The solid angle: the area of the ellipse's rings over the cosine.
    ring_area = np.pi / turns * (edges[1:] ** 2 - edges[:-1] ** 2)[:, None]
    return light, half, lit, ring_area * np.prod(layout.stretch) / np.maximum(up, 1e-3)


def _density(model, p, view, light, half, lit):
    """f (N·L) dω_L / dω_H (rings, turns, channels); 0 where it is not lit. Raises ValueError as `ViewSlice.at`."""
    evaluated = {q.id: p[q.id] for q in model.parameters if q.evaluated}
    value = model.evaluate(view, light[lit], **evaluated) if lit.any() else np.zeros(0)
    value = value if value.ndim == 2 else value[:, None]
    if not np.isfinite(value).all() or value.min(initial=0.0) < 0.0:
        bad = value[~np.isfinite(value) | (value < 0.0)][0]
        raise ValueError(f"{model.id}: the formula gives {bad:g} at a view of {np.degrees(np.arccos(view[2])):.1f} "
                         "degrees; a reflectance is a finite number, 0 or more")
    density = np.zeros((*lit.shape, value.shape[1]))
    density[lit] = value * (4.0 * light[lit][:, 2] * (half[lit] @ view))[:, None]
    return density
