"""A parameter grid: lobe rows at steps of the ranges of driven parameters, which textures, drivers or keyframes change.

At each hit a shader takes the rows of one grid node at random, in proportion to how near its steps are to the hit's
values. The expected value is the linear interpolation between steps. Each channel of a color has its own position, as
the red of a formula depends on the red of its colors only.
"""
import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from ...models.parameters import Parameter
from . import row_bake
from .layout import common_layout
from .lobe_rows import LobeRows
from .view_slice import DETAIL

WIDER = 1.2  # ratio of a lobe's width from a step to the next; for exponents it is the square of this
EVEN_STEPS = 9  # steps of a parameter that is neither a width nor an exponent, and not linear
# Most numbers of all nodes. OSL does not compile arrays of twice the length. With an array of this length a scene takes
# seconds longer to load.
MOST_NUMBERS = 1_000_000
FEWER_VIEWS = (1.0, 0.8, 0.65, 0.5)  # parts of a layout's views, tried in turn where all nodes have too many numbers
# Views (unit vectors) and positions in a range for samples of a formula's dependence on a parameter. The positions are
# uneven, as a formula with a rotation may have the same value half-way.
_VIEWS = tuple(np.array([np.sin(theta) * 0.8, np.sin(theta) * 0.6, np.cos(theta)]) for theta in (0.2, 0.9, 1.4))
_POSITIONS = (0.0, 0.23, 0.5, 0.71, 1.0)
_KEPT = 8  # number of cached grids
_kept = {}  # (model, its values, ranges, stamps of files) -> ParameterGrid, the least recently used first


@dataclass(frozen=True)
class Range:
    """The values of `parameter` at `steps` steps from `least` to `most`; those of a color are grays.

    They have equal differences, or, where `geometric`, equal ratios.
    """

    parameter: Parameter
    least: float
    most: float
    steps: int
    geometric: bool = False

    def value(self, step: float):
        """The parameter's value at a step, 0 .. steps - 1, or between two."""
        position = step / (self.steps - 1) if self.steps > 1 else 0.5
        if self.geometric:
            number = self.least * (self.most / self.least) ** position
        else:
            number = self.least + (self.most - self.least) * position
        number = min(max(number, self.least), self.most)  # rounding may exceed the range
        if self.parameter.kind == "color":
            return (number,) * 3
        return self.parameter.check(round(number)) if self.parameter.is_whole else number

    @property
    def halfway(self) -> list:
        """The values halfway between neighboring steps; [] of a whole parameter, which has no values between."""
        return [] if self.parameter.is_whole else [self.value(step + 0.5) for step in range(self.steps - 1)]


@dataclass(frozen=True)
class ParameterGrid:
    """`nodes`, the lobe rows for each combination of the steps of `ranges`, all in one layout.

    The last range changes fastest. Without ranges there is one node.
    """

    ranges: tuple
    nodes: tuple

    @property
    def channels(self) -> int:
        """Channels of the residuals' energies: 1 where all nodes are gray, else 3."""
        return 1 if all(rows.is_gray for rows in self.stored) else 3

    @property
    def stored(self) -> list:
        """The nodes that a shader stores: all that are not black, or the first if all are."""
        return [rows for rows in self.nodes if rows.brightness > 0.0] or [self.nodes[0]]

    @property
    def storage_index(self) -> list:
        """The index of each node among those `stored`, -1 for a black node."""
        indices = {id(rows): index for index, rows in enumerate(self.stored)}
        return [indices.get(id(rows), -1) for rows in self.nodes]

    @property
    def numbers(self) -> int:
        """The number of numbers of all stored nodes, see `LobeRows.numbers`."""
        return len(self.stored) * LobeRows.zeros(self.nodes[0].layout, self.channels).numbers

    def at(self, steps) -> LobeRows:
        """The node at `steps`, one of each range."""
        index = 0
        for step, driven in zip(steps, self.ranges, strict=True):
            index = index * driven.steps + step
        return self.nodes[index]


def bake(model, parameters: dict, driven: dict | None = None, tell=None) -> ParameterGrid:
    """Lobe rows of a model for its `parameters` {id: value}, over the ranges `driven`, {id: (least, most)}.

    The last 8 grids are cached. `tell(done, total)` is called before each node, and at the end. Raises ValueError as
    `row_bake.bake`, as `check`, and where all nodes together are too many numbers for a shader.
    """
    if not driven:
        return ParameterGrid((), (row_bake.bake(model, parameters),))
    # The ranges; grids are cached by them and by the fixed values in the precision of sockets.
    fixed = {name: value for name, value in parameters.items() if name not in driven}
    p = model.resolve(fixed)
    ranges = _ranges(model, fixed, {name: check(model.parameter(name), *driven[name]) for name in sorted(driven)})
    key = (model, repr([q.single(p[q.id]) for q in model.parameters if q.evaluated]), ranges,
           tuple(q.stamp(p[q.id]) for q in model.parameters if q.kind == "image"))
    grid = _kept.pop(key, None) or ParameterGrid(ranges, _nodes(model, fixed, ranges, tell))
    _kept[key] = grid
    while len(_kept) > _KEPT:
        _kept.pop(next(iter(_kept)), None)  # another thread may have removed it
    return grid


def check(parameter, least: float, most: float) -> tuple:
    """(least, most) as floats. Raises ValueError where a parameter cannot be driven over this range."""
    if not parameter.can_be_driven:
        raise ValueError(f"{parameter.id}: it has no range that a bake could cover")
    numbers = [parameter.check(bound) for bound in (least, most)]
    least, most = (float(np.max(number)) for number in numbers)
    if not least < most:
        raise ValueError(f"{parameter.id}: a range from {least:g} to {most:g} is none")
    return least, most


def _ranges(model, fixed, bounds):
    """The `Range` of each driven parameter, for `bounds` {id: (least, most)}, with as many steps as it needs.

    A parameter's dependence may depend on the others. So it is sampled for all combinations of the others' ends, and of
    all values of whole parameters. The largest number of steps counts.
    """
    ends = {name: Range(model.parameter(name), *least_most, 2) for name, least_most in bounds.items()}
    for name, driven in ends.items():
        if driven.parameter.is_whole:
            ends[name] = replace(driven, steps=round(driven.most - driven.least) + 1)
    ranges = []
    for name, driven in ends.items():
        if driven.parameter.is_whole:
            ranges.append(driven)
            continue
        others = [[(q, other.value(i)) for i in range(other.steps)] for q, other in ends.items() if q != name]
        needs = (_range(model, {**fixed, **dict(values)}, driven) for values in itertools.product(*others))
        ranges.append(max(needs, key=lambda need: need.steps))
    return tuple(ranges)


def _range(model, parameters, ends):
    """The range between the `ends` of one parameter, with as many steps as it needs for the other `parameters`."""
    samples = _samples(model, [{**parameters, ends.parameter.id: ends.value(position)} for position in _POSITIONS])
    low, high = samples[0], samples[-1]
    bound = 1e-9 * max(np.abs(low).max(), np.abs(high).max())
    # One step where f does not depend on it, two where it does so linearly.
    if all(np.abs(f - low).max() <= bound for f in samples):
        return replace(ends, steps=1)
    if all(np.abs(f - low - position * (high - low)).max() <= bound
           for f, position in zip(samples, _POSITIONS, strict=True)):
        return ends
    # Else even steps, or, for widths and exponents, steps in equal ratios.
    if not ends.parameter.is_width:
        return replace(ends, steps=EVEN_STEPS)
    apart = math.log(WIDER) * (2.0 if ends.parameter.logarithmic else 1.0)
    return replace(ends, steps=1 + math.ceil(math.log(ends.most / ends.least) / apart), geometric=True)


def _samples(model, several) -> list:
    """f (N, 3) for each of `several` {id: value}, at the same views and lights, which resolve the lobes of all."""
    lights = [(view, model.lights(view, model.resolve(values), DETAIL, polar=6, azimuthal=12)[0])
              for values in several for view in _VIEWS]
    view = np.concatenate([np.broadcast_to(view, light.shape) for view, light in lights])
    light = np.concatenate([light for _, light in lights])
    samples = [model.evaluate(view, light, **values) for values in several]
    return [f if f.ndim == 2 else np.repeat(f[:, None], 3, axis=1) for f in samples]


def _nodes(model, parameters, ranges, tell):
    """The lobe rows for all combinations of the ranges' steps, all in one layout. Raises ValueError as `bake`."""
    several = [{**parameters, **{driven.parameter.id: driven.value(step)
                                 for driven, step in zip(ranges, steps, strict=True)}}
               for steps in itertools.product(*(range(driven.steps) for driven in ranges))]
    layout = _with_room(ranges, common_layout(model, [model.resolve(values) for values in several]),
                        [_samples(model, [values])[0] for values in several])
    nodes = []
    for done, values in enumerate(several):
        if tell:
            tell(done, len(several))
        nodes.append(row_bake.bake(model, values, layout))
    if tell:
        tell(len(several), len(several))
    return tuple(nodes)


def _with_room(ranges, layout, samples):
    """`layout`, with fewer views where all nodes are too many numbers for a shader.

    `samples` are f (N, 3) of each node: black nodes are not stored. Raises ValueError where half of the views are still
    too many numbers.
    """
    bright = sum(f.any() for f in samples)
    channels = 1 if all((f == f[:, :1]).all() for f in samples) else 3
    for views in (round(layout.views * share) for share in FEWER_VIEWS):
        fewer = replace(layout, views=views)
        if bright * LobeRows.zeros(fewer, channels).numbers <= MOST_NUMBERS:
            return fewer
    steps = " times ".join(f"{driven.steps} of {driven.parameter.label}" for driven in ranges)
    raise ValueError(f"these are too many steps for one shader, {steps}: shorter ranges, or fewer driven parameters, "
                     "have fewer")
