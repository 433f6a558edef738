"""Lobes in the plane of incidence, the x-z plane, and their width: what models are compared by.

The plane holds the tangent, so strands and stretched lobes are cut along it. Angles are in degrees from the normal; of
views the mirror direction's side is positive. `given` are a model's parameters, by id.
"""
import numpy as np

WIDEST = 45.0  # of half vectors at normal incidence: their lights are at the horizon


def direction(angle) -> np.ndarray:
    """Unit vectors (N, 3) in the x-z plane at the signed `angle` (N,)."""
    angle = np.radians(np.atleast_1d(np.asarray(angle, dtype=np.float64)))
    return np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)


def value(model, view, light, given) -> np.ndarray:
    """f(V, L) in 1/sr, the mean of its channels, (N,)."""
    f = model.evaluate(view, light, **given)
    return f if f.ndim == 1 else f.mean(axis=1)


def those(model, **values) -> dict:
    """Of `values` those that the model has parameters for."""
    known = {p.id for p in model.parameters}
    return {name: x for name, x in values.items() if name in known}


def glossy(model, given) -> dict:
    """`given` without diffuse part and colour: the lobe alone."""
    white = {"base_color": (1.0, 1.0, 1.0), "diffuse_color": (0.0, 0.0, 0.0), "fresnel_type": "constant"}
    return {**given, **those(model, **white)}


def lobe(model, light_angle: float, view_angles, given) -> np.ndarray:
    """f (N,) of the lobe alone in 1/sr at `view_angles` (N,), the light at `light_angle` on the other side."""
    return value(model, direction(view_angles), direction(-light_angle), glossy(model, given))


def seen_from_above(model, half_angles, given) -> np.ndarray:
    """f (N,) of the lobe alone in 1/sr, the view at the normal and half vectors at `half_angles` (N,), 0 to WIDEST."""
    return value(model, direction(0.0), direction(2.0 * np.asarray(half_angles)), glossy(model, given))


def half_angle(model, given) -> float:
    """Half vector's angle at which f, seen from above, has fallen to one half; WIDEST where it never does."""
    beta = np.concatenate([[0.0], np.geomspace(0.01, WIDEST, 2000)])
    return crossing(beta, seen_from_above(model, beta, given), 0.5)


def crossing(x, y, part: float) -> float:
    """Where `y` (N,) first falls below `part` of y[0], `x` (N,) ascending; the last x where it never does."""
    low = y < part * y[0]
    if not low.any():
        return float(x[-1])
    i = int(low.argmax())
    return float(np.interp(part * y[0], y[[i, i - 1]], x[[i, i - 1]]))


def matched(model, angle: float, given=None) -> dict:
    """`given` with the model's parameter of shape such that `half_angle` is `angle`: a round lobe.

    So Sawicki compares models (see published.py). Pumped ones are matched as they are before, which is nearly the same.
    Raises ValueError where no value of the parameter gives that width.
    """
    given, name = dict(given or {}), getattr(model, "shape", "exponent")
    across = name.removesuffix("_u") + "_v"

    def shaped(x):
        return {**given, name: x, **those(model, use_roughness=False, **{across: x})}

    def is_wider(x):
        return half_angle(model, {**shaped(x), **those(model, pumps=0.0)}) > angle

    low, high = max(model.parameter(name).minimum, 1e-3), model.parameter(name).maximum
    narrows = is_wider(low)  # as the parameter grows: with exponents it does, with roughnesses not
    if is_wider(high) == narrows:
        raise ValueError(f"{model.id}: no {name} makes a lobe whose half angle is {angle:.3g} degrees")
    for _ in range(50):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if is_wider(middle) == narrows else (low, middle)
    return shaped(float(np.sqrt(low * high)))
