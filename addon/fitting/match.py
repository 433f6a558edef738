"""Parameters that make one model's lobe as wide as another's: equal half vector angles at half of the normalised BRDF.

Source: Sawicki, "Modeling the metallic reflection using appropriate BRDF model" (properties of the reflection models),
which compares models so matched. Here the view is the normal, and the light leans by 2β from it, so that the half
vector leans by β; the half-angle is the smallest β at which f(V, L) / f(N, N) of the white lobe is 1/2.
"""
from dataclasses import dataclass

import numpy as np

from ..forms.albedo.tabulated import TABULATED
from ..models import find_model, fresnel, roughness_of_exponent
from ..models.formula_model import FormulaModel, constant

ALONG, ACROSS = 0.0, 0.5 * np.pi  # azimuths of the light: the tangent, and across it
_STEEPEST = 0.25 * np.pi  # half vector angle of a light at the horizon
_CLOSE = 1e-7  # relative error of a half-angle
_WHITE = {"base_color": (1.0, 1.0, 1.0), "f90": (1.0, 1.0, 1.0), "fresnel_type": fresnel.CONSTANT,
          "diffuse_color": (0.0, 0.0, 0.0), "retro": 0.0}
# The other way to say how wide a lobe is, and other models' slopes go by the same name.
_ROUGHNESS = ("use_roughness", "roughness")


@dataclass(frozen=True)
class Match:
    """All `parameters` that the formula of the model `target` takes, with its lobe as wide as that of `source`.

    `wanted` and `half_angles` are the source's and the target's half-angles along and across the tangent, in degrees,
    infinite where f never falls to half. `dropped` names parameters of the source that say something and have no place
    in the target; `held` those of the target that ended at their range's end, where the width wanted lies beyond.
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

    Parameters that both have are carried over, and so are the colours at normal and at grazing incidence; the others
    take their defaults. Where the target cannot be as wide or as narrow, it raises ValueError with the half-angle
    wanted and those that the target allows, or, told to `hold`, leaves the parameter at the end of its range. Raises
    ValueError also for unknown models, parameters and values, and where f is 0 at the normal.
    """
    source, target = find_model(source_id), find_model(target_id)
    given = complete(source, parameters)
    wanted = half_angles(source, given)
    if not (hold or np.isfinite(wanted).any()):
        raise ValueError(f"{source.id}: f does not fall to half of its value at the normal, so nothing can be matched")
    values, held = shaped(target, carried(source, given, target), wanted, hold)
    values = with_roughness(values)
    if "use_roughness" in values:
        values["use_roughness"] = bool(given.get("use_roughness", False))
    return Match(source.id, target.id, values, _degrees(wanted), _degrees(half_angles(target, values)),
                 dropped(source, given, target), held)


def with_roughness(values: dict) -> dict:
    """`values` with the roughness that stands for their exponent, in models that know both."""
    if "use_roughness" not in values:
        return values
    return {**values, "roughness": roughness_of_exponent(values["exponent"])}


def _degrees(pair):
    return tuple(float(angle) for angle in np.degrees(pair))


# How wide a lobe is.

def half_angles(model, values: dict) -> tuple:
    """Half-angles (radians) of a model with its `values`, along and across the tangent; inf where there is none."""
    return half_angle(model, values, ALONG), half_angle(model, values, ACROSS)


def half_angle(model, values: dict, azimuth: float) -> float:
    """The smallest angle (radians, 0 .. pi/4) between N and H at which f is half of f(N, N), light at `azimuth`.

    Infinite where f is more than that up to the horizon. Raises ValueError where there is no lobe: f(N, N) = 0.
    """
    white = {**values, **{name: value for name, value in _WHITE.items() if name in values}}
    model = model.with_albedos(TABULATED)
    top = float(model.evaluate([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], **white)[0])
    if not top > 0.0:
        raise ValueError(f"{model.id}: there is no lobe to match, f is 0 where view and light are the normal")
    beta = np.append(0.0, np.geomspace(1e-6, _STEEPEST * (1.0 - 1e-9), 400))
    for _ in range(7):
        fallen = model.evaluate([0.0, 0.0, 1.0], _light(beta, azimuth), **white) <= 0.5 * top
        if not fallen.any():
            return np.inf
        first = int(fallen.argmax())
        beta = np.linspace(beta[first - 1], beta[first], 33)
    return float(beta[0])


def _light(beta, azimuth):
    """Lights (N, 3) whose half vectors with the normal lean by `beta` (N,)."""
    s = np.sin(2.0 * beta)
    return np.stack([s * np.cos(azimuth), s * np.sin(azimuth), np.cos(2.0 * beta)], axis=-1)


# The search for the width.

def shaped(model, values: dict, wanted: tuple, hold: bool = False) -> tuple:
    """(`values` with the lobe as wide as `wanted` (radians, along and across the tangent), names held at an end).

    A lobe that is round gets the geometric mean of the two. One with a width for each axis gets both; a lump on the
    disk gets its exponent by the wider axis and the radius of the other. Of an infinite half-angle it comes as near as
    it can where there is an axis for each, else the other one decides. Where nothing changes the width, all stays.
    Raises ValueError as `match`.
    """
    if model.width_parameter is None:
        if not hold:
            raise ValueError(f"{model.id}: no parameter changes how wide its lobe is")
        return values, ()
    axes = dict(zip(model.axes, ((ALONG, wanted[0]), (ACROSS, wanted[1])), strict=False))
    if not axes:
        strands = isinstance(model, FormulaModel) and model.stretched is not None  # nothing sets their other width
        finite = [angle for angle in wanted[: 1 if strands else 2] if np.isfinite(angle)] or [_STEEPEST]
        plan = [((model.width_parameter, *model.widened_with), ALONG, float(np.exp(np.mean(np.log(finite)))))]
    elif model.width_parameter in axes:
        plan = [((name,), *aim) for name, aim in axes.items()]
    else:
        narrower, wider = sorted(axes, key=lambda name: axes[name][1])
        plan = [((model.width_parameter, *model.widened_with), *axes[wider]), ((narrower,), *axes[narrower])]
    held = []
    for names, azimuth, aim in plan:
        values, reached = _search(model, values, names, azimuth, min(aim, _STEEPEST), hold or np.isinf(aim))
        held += [] if reached else [names[0]]
    return values, tuple(held)


def line(parameter, value):
    """`value` on the scale on which equal steps look alike: logarithmic where the range does not begin at 0."""
    if parameter.minimum > 0.0:
        return np.log(value)
    return np.log1p(value) if parameter.logarithmic else value


def unline(parameter, x):
    """The value, held to the range, that `line` puts at `x`."""
    value = np.exp(x) if parameter.minimum > 0.0 else np.expm1(x) if parameter.logarithmic else x
    return float(min(max(value, parameter.minimum), parameter.maximum))


def _search(model, values, names, azimuth, aim, hold):
    """`values` with names[0] such that the half-angle is `aim`, the others scaled with it; whether it is reached."""
    leader = model.parameter(names[0])

    def at(x):
        moved = {names[0]: unline(leader, x)}
        factor = moved[names[0]] / values[names[0]]
        for name in names[1:]:
            moved[name] = model.parameter(name).clamp(values[name] * factor)
        for name in model.power_bases:
            moved[name] = model.parameter(name).clamp(float(np.copysign(abs(values[name]) ** (1.0 / factor),
                                                                        values[name])))
        return {**values, **moved}

    def miss(x):
        return float(np.log(half_angle(model, at(x), azimuth) / aim))

    if abs(miss(line(leader, values[names[0]]))) < _CLOSE:
        return values, True
    ends = sorted((miss(line(leader, end)), line(leader, end)) for end in (leader.minimum, leader.maximum))
    if ends[0][0] <= 0.0 <= ends[1][0]:
        return at(_root(miss, *ends)), True
    if not hold:
        allowed = " to ".join(f"{_shown(np.exp(end[0]) * aim)}" for end in ends)
        raise ValueError(f"{model.id}: a half-angle of {_shown(aim)} degrees is out of reach: {names[0]} from "
                         f"{leader.minimum:g} to {leader.maximum:g} allows {allowed} degrees")
    return at(ends[0][1] if ends[0][0] > 0.0 else ends[1][1]), False


def _shown(angle):
    return f"{np.degrees(angle):.4g}" if np.isfinite(angle) else "45 (none up to the horizon)"


def _root(miss, low, high):
    """Where `miss` is 0, between two (miss, x) of either sign.

    False position with Illinois' rule; halving while one end is infinite.
    """
    side = 0
    for _ in range(200):
        part = -low[0] / (high[0] - low[0]) if np.isfinite(high[0]) else 0.5
        x = low[1] + part * (high[1] - low[1])
        y = miss(x)
        if abs(y) < 0.01 * _CLOSE or abs(high[1] - low[1]) < 1e-13:
            break
        if y > 0.0:
            low = (0.5 * low[0], low[1]) if side == 1 else low
            high, side = (y, x), 1
        else:
            high = (0.5 * high[0], high[1]) if side == -1 else high
            low, side = (y, x), -1
    return x


# What goes along.

def complete(model, parameters: dict) -> dict:
    """All parameters that the model's formula takes, checked and completed with defaults, by id."""
    values = model.resolve(parameters)
    return {p.id: values[p.id] for p in model.parameters if p.evaluated}


def carried(source, given: dict, target) -> dict:
    """All parameters of `target`: those that `source` has too with its values, held to the range; else defaults."""
    values = complete(target, {})
    shared = {name: target.parameter(name).clamp(given[name]) for name in values if name in given}
    if not set(target.widened_with) <= set(shared):
        shared.pop(target.width_parameter, None)  # the lobes of a sum keep their proportions
    values |= {name: value for name, value in shared.items() if name not in _ROUGHNESS}
    if "fresnel_type" in given and "fresnel_type" in values:
        return values
    normal, grazing = _ends_of_colour(source, given)
    colours = {"base_color": normal, "f90": grazing,
               "fresnel_type": fresnel.CONSTANT if normal == grazing else fresnel.SCHLICK}
    return values | {name: value for name, value in colours.items() if name in values}


def _ends_of_colour(source, given):
    """What the source reflects at normal and at grazing incidence, two triples."""
    if "fresnel_type" in given:
        names = ("fresnel_type", "base_color", "f90", "ior", "extinction")
        choice, *rest = (given[name] for name in names)
        return tuple(tuple(np.clip(fresnel.factor(choice, mu, *rest)[0], 0.0, 1.0).tolist()) for mu in (1.0, 0.0))
    if isinstance(source, FormulaModel) and source.colour is constant:
        return given["base_color"], given["base_color"]
    return given["base_color"], given.get("f90", (1.0, 1.0, 1.0))


def dropped(source, given: dict, target) -> tuple:
    """Parameters of the source, by id, that say something at the values `given` and that `target` lacks."""
    there = {p.id for p in target.parameters} | {*source.widths, *_ROUGHNESS}
    return tuple(name for name, value in given.items()
                 if name not in there and (isinstance(value, str) or np.any(value)) and _is_read(name, given, there))


def _is_read(name, given, there):
    """Whether a parameter that is not 0 changes the source's formula, in a way that the target cannot say otherwise."""
    choice = given.get("fresnel_type", fresnel.SCHLICK)
    if name == "fresnel_type":
        return "f90" not in there
    if name == "f90":
        return choice == fresnel.SCHLICK and given["f90"] != given["base_color"]
    if name in ("ior", "extinction"):
        return choice == fresnel.CONDUCTOR
    if name == "control":
        return given["pumps"] > 0.0
    if name.endswith("grazing_exponent") and not given["vary_exponents"]:
        return False
    return not name.startswith("retro") or given["retro"] > 0.0
