"""Weights for driven parameters: what a texture, a driver or keyframes change is baked at steps of a range.

At each hit the shader takes one set of weights by chance, in proportion to how near its steps are to the values there:
what is expected is linear interpolation from step to step. Each channel of a colour goes by its own value, as the red
of a formula depends on the red of its colours only.
"""
import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from ..brdf.parameters import Parameter
from . import weights

WIDER = 1.2  # from a step to the next, of a lobe's width; exponents go with the square of it
EVEN_STEPS = 9  # of what is neither width nor exponent, and not linear
MOST_NUMBERS = 1_000_000  # of all sets: OSL compiles no arrays of twice the length, and with one such a scene takes
#                           seconds longer to load
FEWER = (1.0, 0.8, 0.65, 0.5)  # of a layout's views, tried in turn where all sets are too many numbers
# Of unit length: to see how a formula depends on a parameter.
_VIEWS = tuple(np.array([np.sin(theta) * 0.8, np.sin(theta) * 0.6, np.cos(theta)]) for theta in (0.2, 0.9, 1.4))
_BETWEEN = (0.0, 0.23, 0.5, 0.71, 1.0)  # of a range: uneven, as what turns may come back half way
_KEPT = 8
_kept = {}  # (model, its values, ranges) -> Sets, the least recently used first


@dataclass(frozen=True)
class Range:
    """The values of `parameter` that weights are baked for: `steps` of them, from `least` to `most`, a colour's gray.

    They are evenly apart, or, where `geometric`, in equal ratios.
    """

    parameter: Parameter
    least: float
    most: float
    steps: int
    geometric: bool = False

    def value(self, step: float):
        """The parameter's value at a step, 0 .. steps - 1, or between two."""
        along = step / (self.steps - 1) if self.steps > 1 else 0.5
        if self.geometric:
            number = self.least * (self.most / self.least) ** along
        else:
            number = self.least + (self.most - self.least) * along
        number = min(max(number, self.least), self.most)  # rounding may lead beyond
        if self.parameter.kind == "color":
            return (number,) * 3
        return self.parameter.check(round(number)) if self.parameter.is_whole else number

    @property
    def halfway(self) -> list:
        """The values halfway between neighbouring steps; none where there is nothing between them."""
        return [] if self.parameter.is_whole else [self.value(step + 0.5) for step in range(self.steps - 1)]


@dataclass(frozen=True)
class Sets:
    """`sets` of weights, one for each combination of the steps of `ranges`, those of the last changing fastest."""

    ranges: tuple
    sets: tuple

    @property
    def channels(self) -> int:
        """Of the energies of cells: 1 where all sets are gray."""
        return 1 if all(_is_gray(one) for one in self.held) else 3

    @property
    def held(self) -> list:
        """The sets that a shader holds: all that are not black, but at least one."""
        return [one for one in self.sets if one.brightness > 0.0] or [self.sets[0]]

    @property
    def slots(self) -> list:
        """The place of each set among those `held`, -1 of one that is not."""
        places = {id(one): place for place, one in enumerate(self.held)}
        return [places.get(id(one), -1) for one in self.sets]

    @property
    def numbers(self) -> int:
        """How many numbers the rows of these are."""
        return len(self.held) * weights.numbers(self.sets[0].layout, self.channels)

    def at(self, steps) -> weights.Weights:
        """The set for a step of each range."""
        place = 0
        for step, each in zip(steps, self.ranges, strict=True):
            place = place * each.steps + step
        return self.sets[place]


def bake(model, parameters: dict, driven: dict | None = None, tell=None) -> Sets:
    """Weights of a model for its `parameters`, over the ranges `driven`, {id: (least, most)}; the last few are kept.

    `tell(done, total)` is called before each set, and last. Raises ValueError as `weights.weights`, for what is no
    range, and where all sets together would be more than a shader can hold.
    """
    if not driven:
        return Sets((), (weights.weights(model, parameters),))
    settled = {name: value for name, value in parameters.items() if name not in driven}
    p = model.resolve(settled)
    ranges = _ranges(model, settled, {name: check(model.parameter(name), *driven[name]) for name in sorted(driven)})
    key = (model, repr([q.single(p[q.id]) for q in model.parameters if q.evaluated]), ranges,
           tuple(q.stamp(p[q.id]) for q in model.parameters if q.kind == "image"))
    found = _kept.pop(key, None) or Sets(ranges, _sets(model, settled, ranges, tell))
    _kept[key] = found
    while len(_kept) > _KEPT:
        _kept.pop(next(iter(_kept)), None)  # another thread may have done so
    return found


def check(parameter, least: float, most: float) -> tuple:
    """(least, most). Raises ValueError where this is no range that a parameter can be driven over."""
    if not parameter.can_be_driven:
        raise ValueError(f"{parameter.id}: it has no range that a model could be baked over")
    numbers = [parameter.check(bound) for bound in (least, most)]
    least, most = (float(np.max(number)) for number in numbers)
    if not least < most:
        raise ValueError(f"{parameter.id}: a range from {least:g} to {most:g} is none")
    return least, most


def _ranges(model, settled, bounds):
    """The ranges of driven parameters, {id: (least, most)}, each with as many steps as it needs.

    How it bends f may depend on the others that are driven: they are at their ends, and switches at all their values.
    """
    ends = {name: Range(model.parameter(name), *each, 2) for name, each in bounds.items()}
    for name, each in ends.items():
        if each.parameter.is_whole:
            ends[name] = replace(each, steps=round(each.most - each.least) + 1)
    found = []
    for name, each in ends.items():
        if each.parameter.is_whole:
            found.append(each)
            continue
        others = [[(q, other.value(i)) for i in range(other.steps)] for q, other in ends.items() if q != name]
        needs = (_range(model, {**settled, **dict(values)}, each) for values in itertools.product(*others))
        found.append(max(needs, key=lambda need: need.steps))
    return tuple(found)


def _range(model, parameters, ends):
    """The range between the `ends` of one parameter, with as many steps as it needs for `parameters`."""
    looked_at = _looked_at(model, [{**parameters, ends.parameter.id: ends.value(along)} for along in _BETWEEN])
    low, high = looked_at[0], looked_at[-1]
    bound = 1e-9 * max(np.abs(low).max(), np.abs(high).max())
    if all(np.abs(f - low).max() <= bound for f in looked_at):
        return replace(ends, steps=1)
    if all(np.abs(f - low - along * (high - low)).max() <= bound for f, along in zip(looked_at, _BETWEEN, strict=True)):
        return ends
    if not ends.parameter.is_width:
        return replace(ends, steps=EVEN_STEPS)
    apart = math.log(WIDER) * (2.0 if ends.parameter.logarithmic else 1.0)
    return replace(ends, steps=1 + math.ceil(math.log(ends.most / ends.least) / apart), geometric=True)


def _looked_at(model, several) -> list:
    """f (N, 3) for each of `several` parameters, at the same views and lights, which resolve the lobes of all."""
    lights = [(view, model.lights(view, model.resolve(each), weights.DETAIL, polar=6, azimuthal=12)[0])
              for each in several for view in _VIEWS]
    view = np.concatenate([np.broadcast_to(view, light.shape) for view, light in lights])
    light = np.concatenate([light for _, light in lights])
    values = [model.evaluate(view, light, **each) for each in several]
    return [value if value.ndim == 2 else np.repeat(value[:, None], 3, axis=1) for value in values]


def _sets(model, parameters, ranges, tell):
    values = [{**parameters, **{each.parameter.id: each.value(step) for each, step in zip(ranges, steps, strict=True)}}
              for steps in itertools.product(*(range(each.steps) for each in ranges))]
    layout = _with_room(ranges, weights.common_layout(model, [model.resolve(each) for each in values]),
                        [_looked_at(model, [each])[0] for each in values])
    sets = []
    for done, each in enumerate(values):
        if tell:
            tell(done, len(values))
        sets.append(weights.weights(model, each, layout))
    if tell:
        tell(len(values), len(values))
    return tuple(sets)


def _with_room(ranges, layout, looked_at):
    """`layout`, with fewer views where a shader cannot hold as many of all sets, of which (N, 3) each were looked at.

    Raises ValueError where it cannot hold half of them either.
    """
    bright = sum(f.any() for f in looked_at)
    channels = 1 if all((f == f[:, :1]).all() for f in looked_at) else 3
    for views in (round(layout.views * share) for share in FEWER):
        fewer = replace(layout, views=views)
        if bright * weights.numbers(fewer, channels) <= MOST_NUMBERS:
            return fewer
    steps = " times ".join(f"{each.steps} of {each.parameter.label}" for each in ranges)
    raise ValueError(f"these are too many steps for one shader, {steps}: shorter ranges, or fewer driven parameters, "
                     "have fewer")


def _is_gray(one):
    return one.channels == 1 or bool((one.energies == one.energies[..., :1]).all())
