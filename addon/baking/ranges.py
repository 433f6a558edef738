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
_KEPT = 2
_kept = {}  # (model, its values, ranges) -> Sets, the oldest first


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
        if self.parameter.kind == "color":
            return (number,) * 3
        return number if self.parameter.kind == "float" else self.parameter.check(round(number))

    @property
    def halfway(self) -> list:
        """The values halfway between neighbouring steps; none where there is nothing between them."""
        whole = self.parameter.kind not in ("float", "color")
        return [] if whole else [self.value(step + 0.5) for step in range(self.steps - 1)]


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
    """Weights of a model for its `parameters`, over the ranges `driven`, {id: (least, most)}; the last are kept.

    `tell(done, total)` is called before each set, and last. Raises ValueError as `weights.weights`, for what is no
    range, and where all sets together would be more than a shader can hold.
    """
    if not driven:
        return Sets((), (weights.weights(model, parameters),))
    p = model.resolve(parameters)
    ranges = tuple(_range(model, parameters, name, *driven[name]) for name in sorted(driven))
    key = (model, repr(sorted(_settled(model, p, driven).items())), ranges,
           tuple(q.stamp(p[q.id]) for q in model.parameters if q.kind == "image"))
    found = _kept.get(key) or Sets(ranges, _sets(model, parameters, ranges, tell))
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


def _settled(model, p, driven):
    """The values that stay as they are."""
    return {q.id: q.single(p[q.id]) for q in model.parameters if q.evaluated and q.id not in driven}


def _range(model, parameters, name, least, most):
    """The range of a parameter with as many steps as it needs."""
    parameter = model.parameter(name)
    least, most = check(parameter, least, most)
    if parameter.kind in ("bool", "int", "enum"):
        return Range(parameter, least, most, round(most - least) + 1)
    three = Range(parameter, least, most, 3)
    low, middle, high = _looked_at(model, [{**parameters, name: three.value(i)} for i in range(3)])
    size = max(np.abs(low).max(), np.abs(high).max())
    if max(np.abs(low - high).max(), np.abs(low - middle).max()) <= 1e-9 * size:
        return Range(parameter, least, most, 1)
    if np.abs(low + high - 2.0 * middle).max() <= 1e-9 * size:
        return Range(parameter, least, most, 2)
    if not parameter.is_width:
        return Range(parameter, least, most, EVEN_STEPS)
    apart = math.log(WIDER) * (2.0 if parameter.logarithmic else 1.0)
    return Range(parameter, least, most, 1 + math.ceil(math.log(most / least) / apart), geometric=True)


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
