"""Baking lobe rows: all rows of a model for its parameters."""
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
    """Lobe rows of a model for its parameters, in the precision of sockets; the last few are kept.

    Without a `layout` it is that of the parameters; a given one takes the stretch of these. Raises ValueError where the
    formula gives no reflectance: numbers that are negative or not finite.
    """
    p = model.resolve(parameters)
    used = [q for q in model.parameters if q.evaluated]
    values = tuple(sorted((q.id, q.single(p[q.id])) for q in used))
    stamps = tuple(q.stamp(p[q.id]) for q in used)
    return _baked(model, values, stamps, layout and replace(layout, stretch=(1.0, 1.0)))


def blank(model, parameters: dict) -> LobeRows:
    """Rows of the form that a model's have, all zero: for those who only ask whether its shader compiles."""
    return LobeRows.zeros(layout_of(model, model.resolve(parameters)), spike=bool(model.spike))


@lru_cache(maxsize=32)
def _baked(model, values, _, common):
    """`bake` for resolved `values`, ((id, value), ...); stamps of files are there for the cache to see."""
    p = model.resolve(dict(values))
    layout = layout_of(model, p, common)
    slices = [ViewSlice.at(model, p, view, layout) for view in layout.view_directions()]
    rows = [_row(view_slice, base) for view_slice, base in zip(slices, fit_bases(slices), strict=True)]
    spike = np.zeros((0, 3))
    if model.spike:
        angles = np.interp(np.arange(spike_angles(layout)) / SPIKES, np.arange(layout.views), layout.view_angles())
        spike = model.spike(np.cos(angles), p)
    return LobeRows.of(layout, rows, spike)


def _row(view_slice: ViewSlice, base: Base) -> LobeRow:
    """The row of a view slice and its base, which together have the albedo of the formula."""
    shown = np.einsum("jc,jrt->rtc", base.colours, base.densities)
    lacking, excess = np.maximum(view_slice.density - shown, 0.0), np.maximum(shown - view_slice.density, 0.0)
    # Nothing can take away the excess of the base over the formula: as much light is taken from the whole base.
    share = view_slice.energy(excess) / np.maximum(view_slice.energy(shown), 1e-12)
    facets, diffuse = _closures(base, base.colours * (1.0 - np.minimum(share, 1.0)))
    # The grid is coarse where the horizon cuts it: the row's energy is the albedo without what the base truly has.
    albedo = view_slice.albedo - _base_albedo(view_slice, facets, diffuse)[: len(view_slice.albedo)]
    lacking = lacking * np.maximum(albedo, 0.0) / np.maximum(view_slice.energy(lacking), 1e-12)
    return LobeRow(facets, diffuse, residual.cut(view_slice, lacking, max(albedo.max(), 0.0)))


def _closures(base, colours):
    """(`Facets` of one row, colour of its diffuse closure (3,)) of a base with the `colours` (closures, channels)."""
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
    """Albedo (3,) of a row's base."""
    light, weight = view_slice.quadrature()
    total = np.zeros((len(light), 3))
    for slopes, widths, colour in facets.each():
        total += row_facet_value(view_slice.layout, view_slice.view, slopes, widths, light)[:, None] * colour
    return diffuse + (weight / light[:, 2]) @ total
