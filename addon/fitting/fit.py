"""Parameters with which a model comes nearest to another or to data, by the perceptual measure. Needs SciPy.

Least is the larger of two figures: the largest relative error of f (N·L) and that of the albedo (Neumann, Neumann,
Szirmay-Kalos, report on albedo pumping-up, section 1.1).
"""
from dataclasses import dataclass, replace

import numpy as np

from ..models import find_model
from . import match, minimax, samples

# The light's and not the surface's; a factor as the colour is; a turn that only stretched lobes show.
_KEPT = ("wavelength", "scattering", "rotation")
_SHIFTS = (0.0, -0.08, 0.08)  # of the shape, in parts of its range: where searches start
_TRIAL = 10  # steps of each before the best goes on
_OTHER = (7, 24)  # nodes of the lights between


@dataclass(frozen=True)
class Fit:
    """`parameters` of `model` (all that its formula takes) fitted to `samples` by changing those in `free`.

    `start` are the parameters where the search began, matched by width. `errors` and `start_errors` are the largest
    relative errors of f (N·L) and of the albedo at the samples, see `samples.largest`; `between` and `start_between`
    those at other views and lights, None where the target is a table. `target` is a model and its parameters, or None.
    """

    model: object
    samples: samples.Samples
    free: tuple
    start: dict
    parameters: dict
    start_errors: tuple
    errors: tuple
    target: tuple | None = None
    start_between: tuple | None = None
    between: tuple | None = None


def to_model(model_id: str, target_id: str, parameters: dict, views=samples.VIEWS, own: dict | None = None,
             floor: float = samples.FLOOR, **settings) -> Fit:
    """The model `model_id` fitted to the model `target_id` with `parameters`, seen from `views` (degrees, 0 .. 85).

    `own` are values of the fitted model to begin with. `floor` and `settings` as of `fit`. A mirror spike is no part of
    f, and is not fitted. Raises ValueError as `match.match` and `fit`, but a width out of reach is approached.
    """
    model, target = find_model(model_id), find_model(target_id)
    views = sorted(set(views))
    if not views or not 0.0 <= views[0] <= views[-1] <= 85.0:
        raise ValueError(f"views: {', '.join(f'{view:g}' for view in views)} is not within 0 .. 85 degrees")
    given = match.complete(target, parameters)
    start = match.match(target_id, parameters, model_id, hold=True).parameters | _checked_values(model, own)
    stretched = samples.knows_tangent(model)
    found = fit(model, samples.of_model(target, given, views, stretched), start, floor=floor, **settings)
    halves = np.convolve(views, (0.5, 0.5), "valid") if len(views) > 1 else views
    other = samples.of_model(target, given, halves, stretched, *_OTHER)
    return replace(found, target=(target, given),
                   start_between=samples.largest(samples.errors(other, model, start, floor)),
                   between=samples.largest(samples.errors(other, model, found.parameters, floor)))


def to_table(model_id: str, path, own: dict | None = None, **settings) -> Fit:
    """The model `model_id` fitted to a table, see `samples.of_table`; `own` as of `to_model`, `settings` as of `fit`.

    The start has the half-angle of the table. Raises ValueError, OSError as `samples.of_table` and `fit`.
    """
    model = find_model(model_id)
    table = samples.of_table(path)
    wanted = samples.half_angle(table)
    own = _checked_values(model, own)
    start, _ = match.shaped(model, match.complete(model, own), (wanted, wanted), hold=True)
    return fit(model, table, start | own, **settings)


def _checked_values(model, own):
    """`own`, checked; a roughness is turned into the exponent that is fitted."""
    values, names = model.resolve(own or {}), list(own or {})
    if "use_roughness" in values:
        names += ["exponent"] if values["use_roughness"] else []
        names = [name for name in names if name not in ("use_roughness", "roughness")]
    return {name: values[name] for name in names}


def fit(model, target: samples.Samples, start: dict, free=None, floor: float = samples.FLOOR, progress=None) -> Fit:
    """The model with the parameters `free`, by id, changed from `start` until it comes nearest to `target`.

    Without `free` these are its numbers and its base colour. Colours stay grey where the target is. `floor` as of
    `samples.errors`. `progress(largest error)` is called at each step. The result is never worse than `start`. Raises
    ValueError for parameters that cannot be fitted and for a floor outside 0.001 .. 1.
    """
    if not 1e-3 <= floor <= 1.0:
        raise ValueError(f"floor: {floor:g} is outside 0.001 .. 1")
    names = usual(model) if free is None else _checked(model, free)
    if "use_roughness" in start:
        start = match.with_roughness({**start, "use_roughness": False})  # the exponent is what changes
    space = _Space(model, names, start, grey=np.ptp(target.value, axis=1).max() == 0.0)
    channels = 1 if _is_grey(samples.errors(target, model, start, floor)) else 3

    def residuals(x):
        # Far from the solution a power of more than 1 may overflow: an infinite error, which no search accepts.
        with np.errstate(over="ignore", invalid="ignore"):
            errors = samples.errors(target, model, space.values(x), floor)
        return np.concatenate([error[:, :channels].ravel() for error in errors])

    def told(worst):
        if progress is not None:
            progress(float(np.expm1(worst)))

    tried = [minimax.minimise(residuals, x, _TRIAL, told) for x in space.starts()]
    best, _ = minimax.minimise(residuals, min(tried, key=lambda each: each[1])[0], progress=told)
    found = match.with_roughness(space.values(best))
    return Fit(model, target, names, start, found, *(samples.largest(samples.errors(target, model, values, floor))
                                                     for values in (start, found)))


def _is_grey(errors):
    return all(np.ptp(error, axis=1).max(initial=0.0) == 0.0 for error in errors)


def usual(model) -> tuple:
    """The parameters of a model that a fit changes when it is not told which."""
    return tuple(p.id for p in model.parameters if p.evaluated and p.id not in _KEPT
                 and (p.kind == "float" and not _other_way(model, p) or p.id == "base_color"))


def _other_way(model, parameter):
    """Whether it is the roughness that stands for an exponent."""
    return parameter.id == "roughness" and any(p.id == "use_roughness" for p in model.parameters)


def _checked(model, names):
    possible = [p.id for p in model.parameters if p.evaluated and not _other_way(model, p)
                and (p.kind == "float" or p.kind == "color" and p.maximum <= 1.0)]
    for name in names:
        model.parameter(name)
        if name not in possible:
            raise ValueError(f"{name} of {model.id} cannot be fitted; these can: {', '.join(possible)}")
    return tuple(dict.fromkeys(names))


class _Space:
    """Free parameters as numbers 0..1 on the scales that `match.line` gives, and back."""

    def __init__(self, model, names, start, grey):
        self.model, self.start = model, start
        self.slots = []  # (parameter, channels that the number stands for or None)
        for parameter in map(model.parameter, names):
            if parameter.kind == "float":
                self.slots.append((parameter, None))
            else:
                triples = [(0, 1, 2)] if grey else [(0,), (1,), (2,)]
                self.slots += [(parameter, triple) for triple in triples]

    def values(self, x):
        """All parameters at x (slots,)."""
        found = dict(self.start)
        for (parameter, triple), part in zip(self.slots, x, strict=True):
            low, high = _ends(parameter)
            value = match.unline(parameter, low + part * (high - low))
            if triple is None:
                found[parameter.id] = value
            else:
                found[parameter.id] = tuple(value if i in triple else c for i, c in enumerate(found[parameter.id]))
        return found

    def starts(self):
        """The start, and with its lobe narrower and wider, each as x (slots,)."""
        x = np.array([self._part(parameter, triple) for parameter, triple in self.slots])
        moves = np.array([parameter.id in self.model.widths for parameter, _ in self.slots])
        return [np.clip(x + shift * moves, 0.0, 1.0) for shift in _SHIFTS]

    def _part(self, parameter, triple):
        low, high = _ends(parameter)
        value = self.start[parameter.id]
        value = value if triple is None else np.mean([value[i] for i in triple])
        return np.clip((match.line(parameter, value) - low) / (high - low), 0.0, 1.0)


def _ends(parameter):
    return match.line(parameter, parameter.minimum), match.line(parameter, parameter.maximum)
