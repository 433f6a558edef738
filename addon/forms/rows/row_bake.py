"""The bake of lobe rows: all rows of a model for its parameters."""
from dataclasses import replace
from functools import lru_cache

import numpy as np

from . import residual
from .facets import row_facet_value
from .fit import Base, fit_bases
from .layout import Layout, layout_of
from .lobe_rows import FACETS, SPIKES, Facets, LobeRow, LobeRows, spike_angles
from .view_slice import ViewSlice


def bake(model, parameters: dict, layout: Layout | None = None) -> LobeRows:
    """Lobe rows of a model for its parameters {id: value}, in the precision of sockets. The last 32 are cached.

    Without `layout`, `layout_of` chooses one. A `layout` gets the stretch for the parameters. Raises ValueError where
    the formula gives numbers that are negative or not finite.
    """
    p = model.resolve(parameters)
    used = [q for q in model.parameters if q.evaluated]
    values = tuple(sorted((q.id, q.single(p[q.id])) for q in used))
    stamps = tuple(q.stamp(p[q.id]) for q in used)
    return _baked(model, values, stamps, layout and replace(layout, stretch=(1.0, 1.0)))


def blank(model, parameters: dict) -> LobeRows:
    """Rows of the same shape as the model's, with all numbers 0: enough to check whether its shader compiles."""
    return LobeRows.zeros(layout_of(model, model.resolve(parameters)), spike=bool(model.spike))


@lru_cache(maxsize=32)
def _baked(model, values, _, common):
    """`bake` for resolved `values`, ((id, value), ...). The stamps of files only serve as a part of the cache's key."""
    # A row for each view; all bases are fitted together.
    p = model.resolve(dict(values))
    layout = layout_of(model, p, common)
    slices = [ViewSlice.at(model, p, view, layout) for view in layout.view_directions()]
    rows = [_row(view_slice, base) for view_slice, base in zip(slices, fit_bases(slices), strict=True)]
    # The spike, at more angles.
    spike = np.zeros((0, 3))
    if model.spike:
        angles = np.interp(np.arange(spike_angles(layout)) / SPIKES, np.arange(layout.views), layout.view_angles())
        spike = model.spike(np.cos(angles), p)
    return LobeRows.of(layout, rows, spike)


def _row(view_slice: ViewSlice, base: Base) -> LobeRow:
    """The row of a view slice with a fitted base. Its albedo is the formula's."""
    total = np.einsum("jc,jrt->rtc", base.colours, base.densities)
    lack, excess = np.maximum(view_slice.density - total, 0.0), np.maximum(total - view_slice.density, 0.0)
    # No closure takes light away: the base's excess over the formula is taken from the whole base.
    share = view_slice.energy(excess) / np.maximum(view_slice.energy(total), 1e-12)
    facets, diffuse = _closures(base, base.colours * (1.0 - np.minimum(share, 1.0)))
    # The slice's grid is coarse at the horizon, and its sums are not exact. So the residual's albedo is the formula's
    # albedo minus the base's, and the residual's density is scaled to it.
    albedo = view_slice.albedo - _base_albedo(view_slice, facets, diffuse)[: len(view_slice.albedo)]
    lack = lack * np.maximum(albedo, 0.0) / np.maximum(view_slice.energy(lack), 1e-12)
    return LobeRow(facets, diffuse, residual.cut(view_slice, lack, max(albedo.max(), 0.0)))


def _closures(base, colours):
    """(`Facets` of a row, color (3,) of its diffuse closure) of a base with weights `colours` (closures, channels)."""
    facets = Facets(np.zeros((FACETS, 2)), np.zeros((FACETS, 2)), np.zeros((FACETS, 3)))
    diffuse = np.zeros(3)
    count = 0
    for closure, colour in zip(base.closures, colours, strict=True):
        if closure is None:
            diffuse = np.broadcast_to(colour, 3)
        else:
            facets.slopes[count], facets.widths[count], facets.colour[count] = *closure, colour
            count += 1
    return facets, diffuse


def _base_albedo(view_slice, facets, diffuse):
    """Albedo (3,) of a row's base, by the slice's quadrature."""
    light, weight = view_slice.quadrature()
    total = np.zeros((len(light), 3))
    for slopes, widths, colour in facets.each():
        total += row_facet_value(view_slice.layout, view_slice.view, slopes, widths, light)[:, None] * colour
    return diffuse + (weight / light[:, 2]) @ total
