"""Fits a model's parameters to another model or to data, by a perceptual measure. Needs SciPy.

The fit minimizes the larger of the largest relative error of f (N·L) and the largest relative error of the albedo
(Neumann, Neumann, Szirmay-Kalos, report on albedo pumping-up, section 1.1).
"""
from dataclasses import dataclass, replace

import numpy as np

from ..models import find_model
from . import match, minimax, samples

# Parameters that a fit does not change by default. The wavelength is the light's and not the surface's, the scattering
# is a factor as the color is, and a rotation matters to stretched lobes only.
_FIXED = ("wavelength", "scattering", "rotation")
# Searches start at these shifts of the width parameters, as fractions of their ranges.
_SHIFTS = (0.0, -0.08, 0.08)
# Steps of each search before the best one goes on.
_TRIAL = 10
# Polar and azimuthal nodes of the check at lights between those of the fit.
_OTHER = (7, 24)


@dataclass(frozen=True)
class Fit:
    """The result of a fit of `model` to `samples`.

    - `free`: ids of the parameters that were changed.
    - `start`: all parameters of the formula at the start of the search, matched by width.
    - `parameters`: all parameters of the formula after the fit.
    - `start_errors`, `errors`: the largest relative errors of f (N·L) and of the albedo at the samples, at the start
      and after the fit, see `samples.largest`.
    - `target`: (model, its parameters), or None if the target is a table.
    - `start_between`, `between`: as the errors, but at views and lights between the samples. None for a table.
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
    """Fits the model `model_id` to the model `target_id` with `parameters`, at `views` in degrees, 0 .. 85.

    `own` are values of the fitted model's parameters for the start. `floor` and `settings` are those of `fit`. A mirror
    spike is no part of f and is not fitted. Raises ValueError as `match.match` and `fit` do, but a width out of reach
    is approached instead.
    """
    # Models and views.
    model, target = find_model(model_id), find_model(target_id)
    views = sorted(set(views))
    if not views or not 0.0 <= views[0] <= views[-1] <= 85.0:
        raise ValueError(f"views: {', '.join(f'{view:g}' for view in views)} is not within 0 .. 85 degrees")
    # The fit starts with the lobe matched by width.
    target_values = match.complete(target, parameters)
    start = match.match(target_id, parameters, model_id, hold=True).parameters | _checked_values(model, own)
    stretched = samples.knows_tangent(model)
    result = fit(model, samples.of_model(target, target_values, views, stretched), start, floor=floor, **settings)
    # The errors between: at the means of neighboring views, and at other lights.
    halves = np.convolve(views, (0.5, 0.5), "valid") if len(views) > 1 else views
    other = samples.of_model(target, target_values, halves, stretched, *_OTHER)
    return replace(result, target=(target, target_values),
                   start_between=samples.largest(samples.errors(other, model, start, floor)),
                   between=samples.largest(samples.errors(other, model, result.parameters, floor)))


def to_table(model_id: str, path, own: dict | None = None, **settings) -> Fit:
    """Fits the model `model_id` to a table, see `samples.of_table`.

    `own` is that of `to_model`, `settings` are those of `fit`. The search starts with the table's half-angle. Raises
    ValueError and OSError as `samples.of_table` and `fit` do.
    """
    model = find_model(model_id)
    table = samples.of_table(path)
    # The lobe is as wide as the table's, unless `own` values set the width.
    aim = samples.half_angle(table)
    own = _checked_values(model, own)
    start, _ = match.shaped(model, match.complete(model, own), (aim, aim), hold=True)
    return fit(model, table, start | own, **settings)


def _checked_values(model, own):
    """`own`, checked, with the exponent, which is fitted, in place of a roughness."""
    values, names = model.resolve(own or {}), list(own or {})
    if "use_roughness" in values:
        names += ["exponent"] if values["use_roughness"] else []
        names = [name for name in names if name not in ("use_roughness", "roughness")]
    return {name: values[name] for name in names}


def fit(model, target: samples.Samples, start: dict, free=None, floor: float = samples.FLOOR, progress=None) -> Fit:
    """Changes the parameters `free`, by id, of a model from `start` until its errors at `target` are least.

    The default of `free` is `usual(model)`. Colors stay gray if the target is gray. `floor` is that of
    `samples.errors`. `progress(largest error)` is called at each step. The result is never worse than `start`. Raises
    ValueError for parameters that cannot be fitted and for a floor outside 0.001 .. 1.
    """
    # The free parameters, as a vector in 0..1. Of exponent and roughness the exponent is the one that changes.
    if not 1e-3 <= floor <= 1.0:
        raise ValueError(f"floor: {floor:g} is outside 0.001 .. 1")
    names = usual(model) if free is None else _checked(model, free)
    if "use_roughness" in start:
        start = match.with_roughness({**start, "use_roughness": False})
    space = _Space(model, names, start, grey=np.ptp(target.value, axis=1).max() == 0.0)
    channels = 1 if _is_grey(samples.errors(target, model, start, floor)) else 3

    def residuals(x):
        # Far from the solution a power of a number above 1 may overflow. No search accepts the infinite error.
        with np.errstate(over="ignore", invalid="ignore"):
            errors = samples.errors(target, model, space.values(x), floor)
        return np.concatenate([error[:, :channels].ravel() for error in errors])

    def report(worst):
        if progress is not None:
            progress(float(np.expm1(worst)))

    # Short searches from several starts, and a long one from the best of their results.
    trials = [minimax.minimise(residuals, x, _TRIAL, report) for x in space.starts()]
    best, _ = minimax.minimise(residuals, min(trials, key=lambda trial: trial[1])[0], progress=report)
    fitted = match.with_roughness(space.values(best))
    return Fit(model, target, names, start, fitted, *(samples.largest(samples.errors(target, model, values, floor))
                                                      for values in (start, fitted)))


def _is_grey(errors):
    """Whether all errors are the same in all channels, so that one channel is enough."""
    return all(np.ptp(error, axis=1).max(initial=0.0) == 0.0 for error in errors)


def usual(model) -> tuple:
    """Ids of the parameters that a fit changes by default: the formula's numbers and the base color."""
    return tuple(p.id for p in model.parameters if p.evaluated and p.id not in _FIXED
                 and (p.kind == "float" and not _other_way(model, p) or p.id == "base_color"))


def _other_way(model, parameter):
    """Whether `parameter` is the roughness that can replace the model's exponent."""
    return parameter.id == "roughness" and any(p.id == "use_roughness" for p in model.parameters)


def _checked(model, names):
    """`names` as a tuple. Raises ValueError for parameters that are unknown or cannot be fitted."""
    possible = [p.id for p in model.parameters if p.evaluated and not _other_way(model, p)
                and (p.kind == "float" or p.kind == "color" and p.maximum <= 1.0)]
    for name in names:
        model.parameter(name)
        if name not in possible:
            raise ValueError(f"{name} of {model.id} cannot be fitted; these can: {', '.join(possible)}")
    return tuple(dict.fromkeys(names))


class _Space:
    """The free parameters as a vector in 0..1, on the scales of `match.line`, and the conversion back."""

    def __init__(self, model, names, start, grey):
        self.model, self.start = model, start
        # One slot for each entry of the vector: (parameter, the color channels that it sets, or None for a number).
        self.slots = []
        for parameter in map(model.parameter, names):
            if parameter.kind == "float":
                self.slots.append((parameter, None))
            else:
                triples = [(0, 1, 2)] if grey else [(0,), (1,), (2,)]
                self.slots += [(parameter, triple) for triple in triples]

    def values(self, x):
        """All parameters {id: value} at x (slots,)."""
        values = dict(self.start)
        for (parameter, triple), fraction in zip(self.slots, x, strict=True):
            low, high = _ends(parameter)
            value = match.unline(parameter, low + fraction * (high - low))
            if triple is None:
                values[parameter.id] = value
            else:
                values[parameter.id] = tuple(value if i in triple else c for i, c in enumerate(values[parameter.id]))
        return values

    def starts(self):
        """The vectors x (slots,) where searches start: `start`, and with its lobe narrower and wider."""
        x = np.array([self._fraction(parameter, triple) for parameter, triple in self.slots])
        moves = np.array([parameter.id in self.model.widths for parameter, _ in self.slots])
        return [np.clip(x + shift * moves, 0.0, 1.0) for shift in _SHIFTS]

    def _fraction(self, parameter, triple):
        """The entry, 0..1, of the start's value in one slot."""
        low, high = _ends(parameter)
        value = self.start[parameter.id]
        value = value if triple is None else np.mean([value[i] for i in triple])
        return np.clip((match.line(parameter, value) - low) / (high - low), 0.0, 1.0)


def _ends(parameter):
    """The ends of the parameter's range on its scale."""
    return match.line(parameter, parameter.minimum), match.line(parameter, parameter.maximum)
