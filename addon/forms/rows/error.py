"""The error of lobe rows against their formula, at views and values between those of the bake.

The expected value of the shader is computed as the renderer computes it. It is the mean of the rows, and of the steps
of a driven parameter, that are next to the view and the value. Each row has its base, and its cells with an energy that
is even over each cell. The blur of a kernel, which is about as large as a cell, does not count.
"""
from dataclasses import dataclass

import numpy as np

from . import grid, row_bake
from .facets import row_facet_value
from .layout import layout_of
from .view_slice import ViewSlice

VIEWS = 8  # number of angles, each halfway between two rows
STEEP = np.radians(80.0)  # errors are summed up to this angle of the view
BETWEEN_STEPS = (0.0, 0.4, 0.8)  # views for errors halfway between steps, in parts of the rows up to STEEP


@dataclass(frozen=True)
class RowsError:
    """Errors at the view angles `theta` (views,) from the normal, in radians. They are in parts of the albedo there.

    `lobe` (views,) is the integral over all lights of the absolute error of f (N·L), and `albedo` (views,) the error of
    the albedo with its sign, each in the channel where it is largest.
    """

    theta: np.ndarray
    lobe: np.ndarray
    albedo: np.ndarray

    def largest(self) -> tuple:
        """The largest of `lobe` and of |`albedo`| up to 80 degrees."""
        low = self.theta <= STEEP
        return float(self.lobe[low].max()), float(np.abs(self.albedo[low]).max())


def error(model, parameters: dict) -> RowsError:
    """The error of a model's lobe rows for its parameters {id: value}. The rows are baked unless they are cached.

    Raises ValueError as `row_bake.bake`.
    """
    return _of_one(row_bake.bake(model, parameters), model, model.resolve(parameters))


def largest(model, parameters: dict, driven: dict | None = None) -> tuple:
    """The largest errors (lobe, albedo) up to 80 degrees, over the ranges `driven`, {id: (least, most)}.

    Errors between views are measured with all driven parameters at the least value, in the middle, and at the most.
    Errors halfway between two steps of a parameter are measured with the others in the middle. A spike does not count.
    Raises ValueError as `grid.bake`.
    """
    if not driven:
        return error(model, parameters).largest()
    baked = grid.bake(model, parameters, driven)

    def values_at(steps):
        return {**parameters, **{axis.parameter.id: axis.value(step)
                                 for axis, step in zip(baked.ranges, steps, strict=True)}}

    # At nodes of the grid: both ends and the middle.
    middle = [axis.steps // 2 for axis in baked.ranges]
    corners = [[0] * len(middle), middle, [axis.steps - 1 for axis in baked.ranges]]
    errors = [_of_one(baked.at(steps), model, model.resolve(values_at(steps))).largest() for steps in corners]
    # Halfway between nodes, along each range.
    for index, axis in enumerate(baked.ranges):
        for step, value in enumerate(axis.halfway):
            nodes = [baked.at([*middle[:index], step + up, *middle[index + 1 :]]) for up in (0, 1)]
            errors += _between_nodes(nodes, model, model.resolve({**values_at(middle), axis.parameter.id: value}))
    return tuple(float(np.abs(values).max()) for values in zip(*errors, strict=True))


def _between_nodes(nodes, model, p):
    """(lobe, albedo) errors at views of rows, an iterator. `p` is halfway between the values of two `nodes`."""
    layout = nodes[0].layout
    steep = (layout.view_angles() <= STEEP).sum()
    for index in (int(share * steep) for share in BETWEEN_STEPS):
        view_slice = ViewSlice.at(model, p, layout.view_directions()[index], layout_of(model, p, layout))
        yield _error_of([(rows, index) for rows in nodes], view_slice)


def _of_one(rows, model, p):
    """The `RowsError` of the lobe rows of one node: at each angle the worst azimuth."""
    layout = rows.layout
    first = np.floor(np.linspace(0.0, layout.views - 2, VIEWS)).astype(int)
    theta = layout.angle_at(first + 0.5)
    errors = np.array([[_between_rows(rows, model, p, index, angle, turn)
                        for index, angle in zip(first, theta, strict=True)]
                       for turn in range(max(layout.azimuths - 1, 1))])
    worst = np.abs(errors[..., 1]).argmax(axis=0)
    return RowsError(theta, errors[..., 0].max(axis=0), errors[worst, np.arange(VIEWS), 1])


def _between_rows(rows, model, p, index, theta, turn):
    """(lobe, albedo) errors halfway from a row to the next, at the angle `theta`, and from an azimuth to the next."""
    layout = rows.layout
    turns = [turn, turn + 1] if layout.azimuths > 1 else [0]
    across = layout.view_directions().reshape(layout.azimuths, layout.views, 3)[turns, -1].sum(axis=0)[:2]
    view = np.array([*(np.sin(theta) * across / np.hypot(*across)), np.cos(theta)])
    view_slice = ViewSlice.at(model, p, view, layout)
    return _error_of([(rows, at * layout.views + index + step) for at in turns for step in (0, 1)], view_slice)


def _error_of(near, view_slice):
    """(lobe, albedo) errors of the mean of the rows `near`, [(LobeRows, index)], against a view's slice."""
    mean = sum(_row_density(rows, index, view_slice) for rows, index in near) / len(near)
    off = (mean - view_slice.density) * view_slice.area[..., None]
    whole = np.maximum((view_slice.density * view_slice.area[..., None]).sum(axis=(0, 1)), 1e-12)
    albedo = off.sum(axis=(0, 1)) / whole
    return (np.abs(off).sum(axis=(0, 1)) / whole).max(), albedo[np.abs(albedo).argmax()]


def _row_density(rows, index, view_slice):
    """A row's density on the grid of another view's slice: (RINGS, turns, channels), as `ViewSlice.density`."""
    row, channels = rows.row(index), rows.channels
    total = view_slice.light[..., 2:] / np.pi * row.diffuse[:channels]
    for slopes, widths, colour in row.facets.each():
        value = row_facet_value(rows.layout, view_slice.view, slopes, widths, view_slice.light)
        total = total + value[..., None] * colour[:channels]
    return total * view_slice.jacobian[..., None] + _cell_density(rows.layout, row.residual, view_slice)


def _cell_density(layout, residual, view_slice):
    """The residual's energy per solid angle of half vectors, even over each cell, (RINGS, turns, channels)."""
    # The cell (i, j) that each half vector lies in.
    x, y = (view_slice.half[..., k] / layout.stretch[k] for k in (0, 1))
    rings, turns = residual.ring_edges, residual.cell_edges
    i = np.searchsorted(rings**2, x * x + y * y, side="right") - 1
    inside = i < layout.cell_rings
    i = np.minimum(i, layout.cell_rings - 1)
    phi = np.mod(np.arctan2(y, x), 2.0 * np.pi)
    j = np.minimum((turns[i] <= phi[..., None]).sum(axis=-1) - 1, layout.cell_turns - 1)
    # Its solid angle, of both sides together.
    area = 0.5 * (rings[i + 1] ** 2 - rings[i] ** 2) * (turns[i, j + 1] - turns[i, j]) * np.prod(layout.stretch)
    area = area / np.maximum(view_slice.half[..., 2], 1e-3) * (2.0 * np.pi / layout.around)
    cells = layout.cell_rings * layout.cell_turns * np.maximum(area, 1e-30)
    return np.where(view_slice.lit & inside, 1.0, 0.0)[..., None] * residual.energies[i, j] / cells[..., None]
