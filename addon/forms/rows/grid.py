"""A parameter grid: lobe rows at steps of the ranges of driven parameters, which textures, drivers or keyframes change.

At each hit a shader takes the rows of one grid node by chance, in proportion to how near its steps are to the values
there. The expected value is linear interpolation from step to step. Each channel of a colour goes by its own value, as
the red of a formula depends on the red of its colours only.
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

WIDER = 1.2  # from a step to the next, of a lobe's width; exponents go with the square of it
EVEN_STEPS = 9  # of a parameter that is neither a width nor an exponent, and not linear
MOST_NUMBERS = 1_000_000  # of all nodes: OSL compiles no arrays of twice the length, and with one such a scene takes
#                           seconds longer to load
FEWER_VIEWS = (1.0, 0.8, 0.65, 0.5)  # of a layout's, tried in turn where all nodes are too many numbers
# Views of unit length, and positions in a range, where the dependence of a formula on a parameter is looked at. The
# positions are uneven, as a formula with a rotation may return half-way.
_VIEWS = tuple(np.array([np.sin(theta) * 0.8, np.sin(theta) * 0.6, np.cos(theta)]) for theta in (0.2, 0.9, 1.4))
_POSITIONS = (0.0, 0.23, 0.5, 0.71, 1.0)
_KEPT = 8
_kept = {}  # (model, its values, ranges, stamps of files) -> ParameterGrid, the least recently used first


@dataclass(frozen=True)
class Range:
    """The values of `parameter` at `steps` steps from `least` to `most`; of a colour they are grays.

    They are evenly apart, or, where `geometric`, in equal ratios.
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
        number = min(max(number, self.least), self.most)  # rounding may lead beyond
        if self.parameter.kind == "color":
            return (number,) * 3
        return self.parameter.check(round(number)) if self.parameter.is_whole else number

    @property
    def halfway(self) -> list:
        """The values halfway between neighbouring steps; none where there is nothing between them."""
        return [] if self.parameter.is_whole else [self.value(step + 0.5) for step in range(self.steps - 1)]


@dataclass(frozen=True)
class ParameterGrid:
    """`nodes`, lobe rows of one layout for each combination of the steps of `ranges`; the last range changes fastest.

    Without ranges it has one node.
    """

    ranges: tuple
    nodes: tuple

    @property
    def channels(self) -> int:
        """Channels of the residuals' energies, 1 or 3: 1 where all nodes are gray."""
        return 1 if all(rows.is_gray for rows in self.stored) else 3

    @property
    def stored(self) -> list:
        """The nodes that a shader stores: all that are not black, but at least one."""
        return [rows for rows in self.nodes if rows.brightness > 0.0] or [self.nodes[0]]

    @property
    def storage_index(self) -> list:
        """The index of each node among those `stored`, -1 of a black one."""
        indices = {id(rows): index for index, rows in enumerate(self.stored)}
        return [indices.get(id(rows), -1) for rows in self.nodes]

    @property
    def numbers(self) -> int:
        """How many numbers the rows of the stored nodes are, see `LobeRows.numbers`."""
        return len(self.stored) * LobeRows.zeros(self.nodes[0].layout, self.channels).numbers

    def at(self, steps) -> LobeRows:
        """The node at a step of each range."""
        index = 0
        for step, driven in zip(steps, self.ranges, strict=True):
            index = index * driven.steps + step
        return self.nodes[index]


def bake(model, parameters: dict, driven: dict | None = None, tell=None) -> ParameterGrid:
    """Lobe rows of a model for its `parameters`, over the ranges `driven`, {id: (least, most)}; the last few are kept.

    `tell(done, total)` is called before each node, and last. Raises ValueError as `row_bake.bake`, as `check`, and
    where all nodes together would be more than a shader can store.
    """
    if not driven:
        return ParameterGrid((), (row_bake.bake(model, parameters),))
    fixed = {name: value for name, value in parameters.items() if name not in driven}
    p = model.resolve(fixed)
    ranges = _ranges(model, fixed, {name: check(model.parameter(name), *driven[name]) for name in sorted(driven)})
    key = (model, repr([q.single(p[q.id]) for q in model.parameters if q.evaluated]), ranges,
           tuple(q.stamp(p[q.id]) for q in model.parameters if q.kind == "image"))
    grid = _kept.pop(key, None) or ParameterGrid(ranges, _nodes(model, fixed, ranges, tell))
    _kept[key] = grid
    while len(_kept) > _KEPT:
        _kept.pop(next(iter(_kept)), None)  # another thread may have done so
    return grid


def check(parameter, least: float, most: float) -> tuple:
    """(least, most). Raises ValueError where this is no range that a parameter can be driven over."""
    if not parameter.can_be_driven:
        raise ValueError(f"{parameter.id}: it has no range that a model could be baked over")
    numbers = [parameter.check(bound) for bound in (least, most)]
    least, most = (float(np.max(number)) for number in numbers)
    if not least < most:
        raise ValueError(f"{parameter.id}: a range from {least:g} to {most:g} is none")
    return least, most


def _ranges(model, fixed, bounds):
    """The ranges of driven parameters, {id: (least, most)}, each with as many steps as it needs.

    How f depends on a parameter may depend on the others: these are at their ends, and switches at all their values.
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
    """The range between the `ends` of one parameter, with as many steps as it needs for `parameters`."""
    samples = _samples(model, [{**parameters, ends.parameter.id: ends.value(position)} for position in _POSITIONS])
    low, high = samples[0], samples[-1]
    bound = 1e-9 * max(np.abs(low).max(), np.abs(high).max())
    # One step where f does not depend on it, two where it does so linearly.
    if all(np.abs(f - low).max() <= bound for f in samples):
        return replace(ends, steps=1)
    if all(np.abs(f - low - position * (high - low)).max() <= bound
           for f, position in zip(samples, _POSITIONS, strict=True)):
        return ends
    if not ends.parameter.is_width:
        return replace(ends, steps=EVEN_STEPS)
    apart = math.log(WIDER) * (2.0 if ends.parameter.logarithmic else 1.0)
    return replace(ends, steps=1 + math.ceil(math.log(ends.most / ends.least) / apart), geometric=True)


def _samples(model, several) -> list:
    """f (N, 3) for each of `several` parameters, at the same views and lights, which resolve the lobes of all."""
    lights = [(view, model.lights(view, model.resolve(values), DETAIL, polar=6, azimuthal=12)[0])
              for values in several for view in _VIEWS]
    view = np.concatenate([np.broadcast_to(view, light.shape) for view, light in lights])
    light = np.concatenate([light for _, light in lights])
    found = [model.evaluate(view, light, **values) for values in several]
    return [f if f.ndim == 2 else np.repeat(f[:, None], 3, axis=1) for f in found]


def _nodes(model, parameters, ranges, tell):
    """Lobe rows at all combinations of the ranges' steps, all in one layout."""
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
    """`layout`, with fewer views where a shader cannot store all nodes.

    `samples` are f (N, 3) of each node: black ones are not stored. Raises ValueError where half of the views are too
    many too.
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
