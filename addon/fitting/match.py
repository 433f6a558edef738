"""Parameters that make one model's lobe as wide as another's: with equal half-angles.

The view is the normal, and the light is at the angle 2β from it, so that the half vector is at β. The half-angle is the
smallest β at which f(V, L) / f(N, N) of the white lobe is 1/2. Source: Sawicki, "Modeling the metallic reflection using
appropriate BRDF model" (properties of the reflection models), which compares models matched in this way.
"""
from dataclasses import dataclass

import numpy as np

from ..forms.albedo.tabulated import TABULATED
from ..models import find_model, fresnel, roughness_of_exponent
from ..models.formula_model import FormulaModel, constant

# Azimuths of the light: along the tangent, and across it.
ALONG, ACROSS = 0.0, 0.5 * np.pi
# The half vector's angle for a light at the horizon.
_STEEPEST = 0.25 * np.pi
# The relative error of a half-angle.
_CLOSE = 1e-7
# Values that make any lobe white, without a diffuse or a retroreflective part.
_WHITE = {"base_color": (1.0, 1.0, 1.0), "f90": (1.0, 1.0, 1.0), "fresnel_type": fresnel.CONSTANT,
          "diffuse_color": (0.0, 0.0, 0.0), "retro": 0.0}
# These are not carried over by name: they repeat the exponent, and "roughness" is also the id of other models' slopes.
_ROUGHNESS = ("use_roughness", "roughness")


@dataclass(frozen=True)
class Match:
    """A model `target` whose lobe is as wide as that of the model `source`.

    - `parameters`: all parameters of the target's formula.
    - `wanted`, `half_angles`: the source's and the target's half-angles along and across the tangent, in degrees. They
      are infinite if f never falls to half.
    - `dropped`: ids of the source's parameters that have an effect there, and no equivalent in the target.
    - `held`: ids of the target's parameters that are at the end of their range, since the source's width is beyond it.
    """

    source: str
    target: str
    parameters: dict
    wanted: tuple
    half_angles: tuple
    dropped: tuple
    held: tuple


def match(source_id: str, parameters: dict, target_id: str, hold: bool = False) -> Match:
    """The parameters of the model `target_id` that match the model `source_id` with `parameters`.

    Parameters that both models have are carried over, and so are the colors at normal and at grazing incidence. The
    others have their defaults. If the target cannot be as wide or as narrow, `hold` leaves the parameter at the end of
    its range. Without `hold` this raises ValueError, with the source's half-angle and those that the target allows.
    Raises ValueError also for unknown models, parameters and values, and if f is 0 at the normal.
    """
    # The source's half-angles.
    source, target = find_model(source_id), find_model(target_id)
    source_values = complete(source, parameters)
    wanted = half_angles(source, source_values)
    if not (hold or np.isfinite(wanted).any()):
        raise ValueError(f"{source.id}: f does not fall to half of its value at the normal, so nothing can be matched")
    # The target with these half-angles. Its width is by roughness if the source's is.
    values, held = shaped(target, carried(source, source_values, target), wanted, hold)
    values = with_roughness(values)
    if "use_roughness" in values:
        values["use_roughness"] = bool(source_values.get("use_roughness", False))
    return Match(source.id, target.id, values, _degrees(wanted), _degrees(half_angles(target, values)),
                 dropped(source, source_values, target), held)


def with_roughness(values: dict) -> dict:
    """`values` with the roughness that is equivalent to their exponent, if the model has both."""
    if "use_roughness" not in values:
        return values
    return {**values, "roughness": roughness_of_exponent(values["exponent"])}


def _degrees(pair):
    return tuple(float(angle) for angle in np.degrees(pair))


# How wide a lobe is.

def half_angles(model, values: dict) -> tuple:
    """Half-angles (radians) of a model with `values`, along and across the tangent. See `half_angle`."""
    return half_angle(model, values, ALONG), half_angle(model, values, ACROSS)


def half_angle(model, values: dict, azimuth: float) -> float:
    """The smallest angle (radians, 0 .. pi/4) between N and H at which f is half of f(N, N), for lights at `azimuth`.

    It is infinite if f is larger than that up to the horizon. Raises ValueError if there is no lobe: f(N, N) = 0.
    """
    # f(N, N) of the white lobe.
    white = {**values, **{name: value for name, value in _WHITE.items() if name in values}}
    model = model.with_albedos(TABULATED)
    top = float(model.evaluate([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], **white)[0])
    if not top > 0.0:
        raise ValueError(f"{model.id}: there is no lobe to match, f is 0 where view and light are the normal")
    # The first angle at which f is at most half of it, refined between this angle and the one before.
    beta = np.append(0.0, np.geomspace(1e-6, _STEEPEST * (1.0 - 1e-9), 400))
    for _ in range(7):
        fallen = model.evaluate([0.0, 0.0, 1.0], _light(beta, azimuth), **white) <= 0.5 * top
        if not fallen.any():
            return np.inf
        first = int(fallen.argmax())
        beta = np.linspace(beta[first - 1], beta[first], 33)
    return float(beta[0])


def _light(beta, azimuth):
    """Lights (N, 3) whose half vectors with the view N are at the angles `beta` (N,) from N."""
    s = np.sin(2.0 * beta)
    return np.stack([s * np.cos(azimuth), s * np.sin(azimuth), np.cos(2.0 * beta)], axis=-1)


# The search for the width.

def shaped(model, values: dict, wanted: tuple, hold: bool = False) -> tuple:
    """Changes a model's width until its half-angles are `wanted` (radians, along and across the tangent).

    Returns (all values, ids of parameters at the end of their range). A round lobe gets the geometric mean of the two
    half-angles. A lobe with a width for each axis gets both. A lump on the disk gets its exponent from the wider axis,
    and then the radius along the other one. An infinite half-angle is approached if the lobe has two axes. A round lobe
    ignores it. If no parameter changes the width, `values` are returned. Raises ValueError as `match` does.
    """
    if model.width_parameter is None:
        if not hold:
            raise ValueError(f"{model.id}: no parameter changes how wide its lobe is")
        return values, ()
    # The plan: (ids of parameters scaled together, azimuth, half-angle) of each search.
    axes = dict(zip(model.axes, ((ALONG, wanted[0]), (ACROSS, wanted[1])), strict=False))
    if not axes:
        # Strands have no parameter for their width across the tangent.
        strands = isinstance(model, FormulaModel) and model.stretched is not None
        finite = [angle for angle in wanted[: 1 if strands else 2] if np.isfinite(angle)] or [_STEEPEST]
        plan = [((model.width_parameter, *model.widened_with), ALONG, float(np.exp(np.mean(np.log(finite)))))]
    elif model.width_parameter in axes:
        plan = [((name,), *aim) for name, aim in axes.items()]
    else:
        narrower, wider = sorted(axes, key=lambda name: axes[name][1])
        plan = [((model.width_parameter, *model.widened_with), *axes[wider]), ((narrower,), *axes[narrower])]
    # The searches, one after the other.
    held = []
    for names, azimuth, aim in plan:
        values, reached = _search(model, values, names, azimuth, min(aim, _STEEPEST), hold or np.isinf(aim))
        held += [] if reached else [names[0]]
    return values, tuple(held)


def line(parameter, value):
    """`value` on a scale where equal steps look alike: logarithmic unless the range begins at 0.

    Exponents that begin at 0 are on the scale log(1 + value).
    """
    if parameter.minimum > 0.0:
        return np.log(value)
    return np.log1p(value) if parameter.logarithmic else value


def unline(parameter, x):
    """The inverse of `line`: the value at `x`, clamped to the range."""
    value = np.exp(x) if parameter.minimum > 0.0 else np.expm1(x) if parameter.logarithmic else x
    return float(min(max(value, parameter.minimum), parameter.maximum))


def _search(model, values, names, azimuth, aim, hold):
    """Finds the value of names[0] for which the half-angle is `aim`. The other names are scaled by the same factor.

    Returns (all values, whether the aim is reached). If it is out of reach, `hold` returns the nearest end of the range
    instead of raising ValueError.
    """
    leader = model.parameter(names[0])

    def at(x):
        """All values with the leader at `x` on its scale."""
        moved = {names[0]: unline(leader, x)}
        factor = moved[names[0]] / values[names[0]]
        for name in names[1:]:
            moved[name] = model.parameter(name).clamp(values[name] * factor)
        for name in model.power_bases:
            moved[name] = model.parameter(name).clamp(float(np.copysign(abs(values[name]) ** (1.0 / factor),
                                                                        values[name])))
        return {**values, **moved}

    def miss(x):
        """The logarithm of the half-angle over the aim."""
        return float(np.log(half_angle(model, at(x), azimuth) / aim))

    # The values fit already, or the aim is between the ends of the range, or it is out of reach.
    if abs(miss(line(leader, values[names[0]]))) < _CLOSE:
        return values, True
    ends = sorted((miss(line(leader, end)), line(leader, end)) for end in (leader.minimum, leader.maximum))
    if ends[0][0] <= 0.0 <= ends[1][0]:
        return at(_root(miss, *ends)), True
    if not hold:
        allowed = " to ".join(f"{_in_degrees(np.exp(end[0]) * aim)}" for end in ends)
        raise ValueError(f"{model.id}: a half-angle of {_in_degrees(aim)} degrees is out of reach: {names[0]} from "
                         f"{leader.minimum:g} to {leader.maximum:g} allows {allowed} degrees")
    return at(ends[0][1] if ends[0][0] > 0.0 else ends[1][1]), False


def _in_degrees(angle):
    """A half-angle in radians as text in degrees."""
    return f"{np.degrees(angle):.4g}" if np.isfinite(angle) else "45 (none up to the horizon)"


def _root(miss, low, high):
    """The root x of `miss`, between `low` and `high`: (miss(x), x), negative at `low` and positive at `high`.

    By false position with the Illinois rule, or by bisection while `high` is infinite.
    """
    side = 0
    for _ in range(200):
        fraction = -low[0] / (high[0] - low[0]) if np.isfinite(high[0]) else 0.5
        x = low[1] + fraction * (high[1] - low[1])
        y = miss(x)
        if abs(y) < 0.01 * _CLOSE or abs(high[1] - low[1]) < 1e-13:
            break
        # An end that stays twice in a row counts half.
        if y > 0.0:
            low = (0.5 * low[0], low[1]) if side == 1 else low
            high, side = (y, x), 1
        else:
            high = (0.5 * high[0], high[1]) if side == -1 else high
            low, side = (y, x), -1
    return x


# The other parameters.

def complete(model, parameters: dict) -> dict:
    """{id: value} of all parameters of the model's formula: `parameters` checked, the others' defaults."""
    values = model.resolve(parameters)
    return {p.id: values[p.id] for p in model.parameters if p.evaluated}


def carried(source, given: dict, target) -> dict:
    """All parameters of `target`: the values `given` of `source` where both have them, clamped; else defaults."""
    # Parameters with the same id.
    values = complete(target, {})
    shared = {name: target.parameter(name).clamp(given[name]) for name in values if name in given}
    if not set(target.widened_with) <= set(shared):
        # The target's other lobes keep their proportions to the first.
        shared.pop(target.width_parameter, None)
    values |= {name: value for name, value in shared.items() if name not in _ROUGHNESS}
    if "fresnel_type" in given and "fresnel_type" in values:
        return values
    # Colors, in models with different Fresnel factors.
    normal, grazing = _end_colors(source, given)
    colors = {"base_color": normal, "f90": grazing,
              "fresnel_type": fresnel.CONSTANT if normal == grazing else fresnel.SCHLICK}
    return values | {name: value for name, value in colors.items() if name in values}


def _end_colors(source, given):
    """The source's reflectances at normal and at grazing incidence, two triples."""
    if "fresnel_type" in given:
        names = ("fresnel_type", "base_color", "f90", "ior", "extinction")
        choice, *colors = (given[name] for name in names)
        return tuple(tuple(np.clip(fresnel.factor(choice, mu, *colors)[0], 0.0, 1.0).tolist()) for mu in (1.0, 0.0))
    if isinstance(source, FormulaModel) and source.colour is constant:
        return given["base_color"], given["base_color"]
    return given["base_color"], given.get("f90", (1.0, 1.0, 1.0))


def dropped(source, given: dict, target) -> tuple:
    """Ids of the source's parameters that have an effect at the values `given` and that `target` lacks."""
    matched = {p.id for p in target.parameters} | {*source.widths, *_ROUGHNESS}
    return tuple(name for name, value in given.items()
                 if name not in matched and (isinstance(value, str) or np.any(value))
                 and _has_effect(name, given, matched))


def _has_effect(name, given, matched):
    """Whether a parameter other than 0 changes the source's formula in a way that no `matched` parameter expresses."""
    choice = given.get("fresnel_type", fresnel.SCHLICK)
    if name == "fresnel_type":
        return "f90" not in matched
    if name == "f90":
        return choice == fresnel.SCHLICK and given["f90"] != given["base_color"]
    if name in ("ior", "extinction"):
        return choice == fresnel.CONDUCTOR
    if name == "control":
        return given["pumps"] > 0.0
    if name.endswith("grazing_exponent") and not given["vary_exponents"]:
        return False
    return not name.startswith("retro") or given["retro"] > 0.0
