"""The numbers of lobe rows, by name. Their storage in a shader is up to the backend."""
from dataclasses import dataclass, fields, replace

import numpy as np

from .layout import Layout

FACETS = 16  # base microfacets of a row; one off the plane of incidence stands for a pair if the formula is round
SPIKES = 8  # colors of the mirror from one row to the next: they change faster than lobes


class _Arrays:
    """A dataclass of arrays with common first axes. An index selects from every array."""

    def __getitem__(self, index):
        return type(self)(**{field.name: getattr(self, field.name)[index] for field in fields(self)})

    @classmethod
    def stacked(cls, several):
        """The arrays of `several` of these, stacked along a new first axis."""
        return cls(**{field.name: np.array([getattr(one, field.name) for one in several]) for field in fields(cls)})


@dataclass(frozen=True)
class Facets(_Arrays):
    """Beckmann microfacets of a base; `...` is (rows, FACETS), or (FACETS,) of one row.

    `slopes` (..., 2) are the lean of a facet's normal along x and y, tangents of angles. `widths` (..., 2) are
    Beckmann's alpha along x and y, 5e-4..1. `colour` (..., 3) is the closure's weight, linear RGB, 0 or more. All
    numbers of an unused facet are 0.
    """

    slopes: np.ndarray
    widths: np.ndarray
    colour: np.ndarray

    @property
    def used(self) -> np.ndarray:
        """Whether a facet has any colour, (...)."""
        return self.colour.any(axis=-1)

    def each(self):
        """(slopes (2,), widths (2,), color (3,)) of each used facet of one row, an iterator."""
        used = self[self.used]
        return zip(used.slopes, used.widths, used.colour, strict=True)


@dataclass(frozen=True)
class Residual(_Arrays):
    """The residual, formula minus base, in cells of half vectors; `...` is (rows,), or () of one row.

    `albedo` (...) is its albedo in the strongest channel, and `share` (...) the same in parts of the formula's albedo.
    `ring_edges` (..., rings + 1) are sizes of rings, see `Layout`. `cell_edges` (..., rings, turns + 1) are azimuths of
    half vectors in radians.

    `energies` (..., rings, turns, channels) are the cells' albedos, of both sides of the plane of incidence together,
    times the number of cells, over the share of the cell whose lights are above the horizon. So the mean energy of
    uniformly sampled cells is the residual's albedo.
    """

    albedo: np.ndarray
    share: np.ndarray
    ring_edges: np.ndarray
    cell_edges: np.ndarray
    energies: np.ndarray


@dataclass(frozen=True)
class LobeRow:
    """One row: `facets` and `residual` of one view, and `diffuse` (3,), the diffuse closure's weight, linear RGB."""

    facets: Facets
    diffuse: np.ndarray
    residual: Residual


@dataclass(frozen=True)
class LobeRows:
    """Rows of all views of a `layout`: `facets`, `diffuse` (rows, 3) and `residual`, as in `LobeRow`.

    `spike` (angles, 3) are the colors of a perfect mirror at the rows' angles, and at SPIKES - 1 more angles from each
    to the next. It is empty where a model has none.
    """

    layout: Layout
    facets: Facets
    diffuse: np.ndarray
    residual: Residual
    spike: np.ndarray

    @classmethod
    def of(cls, layout: Layout, rows: list, spike) -> "LobeRows":
        """Lobe rows of a `LobeRow` for each view, and the `spike`."""
        return cls(layout, Facets.stacked([row.facets for row in rows]), np.array([row.diffuse for row in rows]),
                   Residual.stacked([row.residual for row in rows]), spike)

    @classmethod
    def zeros(cls, layout: Layout, channels: int = 1, spike: bool = False) -> "LobeRows":
        """Lobe rows of a layout with all numbers 0, with or without a `spike`."""
        rows, rings, turns = layout.rows, layout.cell_rings, layout.cell_turns
        facets = Facets(*(np.zeros((rows, FACETS, numbers)) for numbers in (2, 2, 3)))
        residual = Residual(np.zeros(rows), np.zeros(rows), np.zeros((rows, rings + 1)),
                            np.zeros((rows, rings, turns + 1)), np.zeros((rows, rings, turns, channels)))
        return cls(layout, facets, np.zeros((rows, 3)), residual, np.zeros((spike_angles(layout) if spike else 0, 3)))

    def __len__(self) -> int:
        return len(self.diffuse)

    def row(self, index: int) -> LobeRow:
        """The row of one view."""
        return LobeRow(self.facets[index], self.diffuse[index], self.residual[index])

    @property
    def channels(self) -> int:
        """Channels of the residual's energies: 1 or 3."""
        return self.residual.energies.shape[-1]

    @property
    def numbers(self) -> int:
        """Number of numbers that a shader stores; the residual's share and the spike do not count."""
        facets, residual = self.facets, self.residual
        arrays = (facets.slopes, facets.widths, facets.colour, self.diffuse, residual.albedo, residual.ring_edges,
                  residual.cell_edges, residual.energies)
        return sum(array.size for array in arrays)

    @property
    def brightness(self) -> float:
        """An estimate of the mean albedo over all views, of base, residual and spike: 0 where the rows are black."""
        base = self.facets.colour.sum(axis=1) + self.diffuse
        spike = self.spike.mean() if len(self.spike) else 0.0
        return float(base.max(axis=1).mean() + self.residual.albedo.mean() + spike)

    @property
    def is_gray(self) -> bool:
        """Whether the residual's channels are equal."""
        energies = self.residual.energies
        return self.channels == 1 or bool((energies == energies[..., :1]).all())

    def with_channels(self, channels: int) -> "LobeRows":
        """The same rows with `channels`, 1 or 3, for each energy; 1 is for gray rows only."""
        if channels == self.channels:
            return self
        energies = self.residual.energies[..., :1].repeat(channels, axis=-1)
        return replace(self, residual=replace(self.residual, energies=energies))


def spike_angles(layout: Layout) -> int:
    """Number of angles, and so colors, of a spike."""
    return (layout.views - 1) * SPIKES + 1
