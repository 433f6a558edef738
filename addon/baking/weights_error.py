"""How far what baked weights show is from the formula, at views and values that none were made for.

What is expected of the shader is put together as osl/include/weights.h does: between rows, and between the steps of a
driven parameter, the base of each in proportion to how near it is, and its cells, over each of which what it holds is
even. The blur of a splat, which is about as large as a cell, is not in it.
"""
from dataclasses import dataclass

import numpy as np

from . import ranges, weights

VIEWS = 8  # angles, each halfway between two rows
STEEP = np.radians(80.0)  # up to here errors are summed up
BETWEEN_STEPS = (0.0, 0.4, 0.8)  # of the rows: views that are looked at halfway between steps


@dataclass(frozen=True)
class WeightsError:
    """Errors at views of the angles `theta` (views,) from the normal, in radians, in parts of the albedo there.

    `lobe` (views,) is the integral over all lights of how far f (N·L) is off, `albedo` (views,) the error of the
    albedo, both of the channel in which they are largest.
    """

    theta: np.ndarray
    lobe: np.ndarray
    albedo: np.ndarray

    def largest(self) -> tuple:
        """The largest of `lobe` and of |`albedo`| up to 80 degrees."""
        low = self.theta <= STEEP
        return float(self.lobe[low].max()), float(np.abs(self.albedo[low]).max())


def error(model, parameters: dict) -> WeightsError:
    """The error of a model's weights for its parameters, which are baked unless they are kept.

    Raises ValueError as `weights.weights`.
    """
    return _of_one(weights.weights(model, parameters), model, model.resolve(parameters))


def largest(model, parameters: dict, driven: dict | None = None) -> tuple:
    """The largest errors of lobe and albedo up to 80 degrees, over the ranges of those `driven`.

    Between views these are at both ends and in the middle of their ranges, all together; halfway between two steps of
    one the others are in the middle. A spike is not looked at. Raises ValueError as `ranges.bake`.
    """
    if not driven:
        return error(model, parameters).largest()
    sets = ranges.bake(model, parameters, driven)

    def at(steps):
        values = {each.parameter.id: each.value(step) for each, step in zip(sets.ranges, steps, strict=True)}
        return {**parameters, **values}

    middle = [each.steps // 2 for each in sets.ranges]
    corners = [[0] * len(middle), middle, [each.steps - 1 for each in sets.ranges]]
    found = [_of_one(sets.at(steps), model, model.resolve(at(steps))).largest() for steps in corners]
    for place, each in enumerate(sets.ranges):
        for step, value in enumerate(each.halfway):
            near = [sets.at([*middle[:place], step + up, *middle[place + 1 :]]) for up in (0, 1)]
            found += _between_steps(near, model, model.resolve({**at(middle), each.parameter.id: value}))
    return tuple(float(np.abs(part).max()) for part in zip(*found, strict=True))


def _between_steps(near, model, p):
    """(lobe, albedo) errors at a value halfway between those of two sets of weights, at views of rows."""
    layout = near[0].layout
    steep = (layout.view_angles() <= STEEP).sum()
    for row in (int(part * steep) for part in BETWEEN_STEPS):
        look = weights.Look.at(model, p, layout.seen_from()[row], weights.layout_of(model, p, layout))
        yield _off([(one, one.rows[row]) for one in near], look)


def _of_one(baked, model, p):
    """`error` of one set of weights."""
    layout = baked.layout
    first = np.floor(np.linspace(0.0, layout.views - 2, VIEWS)).astype(int)
    theta = layout.angle_at(first + 0.5)
    found = np.array([[_between(baked, model, p, row, angle, turn) for row, angle in zip(first, theta, strict=True)]
                      for turn in range(max(layout.azimuths - 1, 1))])
    worst = np.abs(found[..., 1]).argmax(axis=0)
    return WeightsError(theta, found[..., 0].max(axis=0), found[worst, np.arange(VIEWS), 1])


def _between(baked, model, p, row, theta, turn):
    """(lobe, albedo) errors at the angle `theta`, halfway from a row to the next, and from an azimuth to the next."""
    layout = baked.layout
    turns = [turn, turn + 1] if layout.azimuths > 1 else [0]
    across = layout.seen_from().reshape(layout.azimuths, layout.views, 3)[turns, -1].sum(axis=0)[:2]
    view = np.array([*(np.sin(theta) * across / np.hypot(*across)), np.cos(theta)])
    look = weights.Look.at(model, p, view, layout)
    return _off([(baked, baked.rows[turn * layout.views + row + step]) for turn in turns for step in (0, 1)], look)


def _off(near, look):
    """(lobe, albedo) errors of the mean of rows, each with the weights that it is of, seen as `look`."""
    off = (sum(_shown(*each, look) for each in near) / len(near) - look.density) * look.area[..., None]
    whole = np.maximum((look.density * look.area[..., None]).sum(axis=(0, 1)), 1e-12)
    albedo = off.sum(axis=(0, 1)) / whole
    return (np.abs(off).sum(axis=(0, 1)) / whole).max(), albedo[np.abs(albedo).argmax()]


def _shown(baked, row, look):
    """What a row shows on the grid of a view that is not its own, like `look.density`: (RINGS, turns, channels)."""
    layout, channels = baked.layout, baked.channels
    facets, diffuse, rings, turns, energies = weights.parts(row, layout, channels)
    stretch = np.where(look.lit, 4.0 * np.maximum(look.half @ look.view, 0.0), 0.0)[..., None]
    total = look.light[..., 2:] / np.pi * diffuse[:channels]
    for facet in facets[facets[:, 4:].any(axis=1)]:
        value = weights.sides_value(look, facet[:2], facet[2:4], look.light)
        total = total + value[..., None] * facet[4 : 4 + channels]
    x, y = (look.half[..., k] / layout.stretch[k] for k in (0, 1))
    i = np.searchsorted(rings**2, x * x + y * y, side="right") - 1
    inside = i < layout.cell_rings
    i = np.minimum(i, layout.cell_rings - 1)
    phi = np.mod(np.arctan2(y, x), 2.0 * np.pi)
    j = np.minimum((turns[i] <= phi[..., None]).sum(axis=-1) - 1, layout.cell_turns - 1)
    area = 0.5 * (rings[i + 1] ** 2 - rings[i] ** 2) * (turns[i, j + 1] - turns[i, j]) * np.prod(layout.stretch)
    area = area / np.maximum(look.half[..., 2], 1e-3) * (2.0 * np.pi / layout.around)
    cells = energies[i, j] / (layout.cell_rings * layout.cell_turns * np.maximum(area, 1e-30))[..., None]
    return total * stretch + np.where(look.lit & inside, 1.0, 0.0)[..., None] * cells
