"""Lobes in the plane of incidence, the x-z plane, and their width: what models are compared by.

The plane holds the tangent, so strands and stretched lobes are cut along it. Angles are in degrees from the normal; of
views the mirror direction's side is positive. `given` are a model's parameters, by id.
"""
import numpy as np

from ...fitting import match
from ...models.channels import mean
from ...models.geometry import in_plane

WIDEST = 45.0  # of half vectors at normal incidence: their lights are at the horizon


def value(model, view, light, given) -> np.ndarray:
    """f(V, L) in 1/sr, the mean of its channels, (N,)."""
    return mean(model.evaluate(view, light, **given))


def those(model, **values) -> dict:
    """Of `values` those that the model has parameters for."""
    known = {p.id for p in model.parameters}
    return {name: x for name, x in values.items() if name in known}


def glossy(model, given) -> dict:
    """`given` without diffuse part and color: the lobe alone."""
    white = {"base_color": (1.0, 1.0, 1.0), "diffuse_color": (0.0, 0.0, 0.0), "fresnel_type": "constant"}
    return {**given, **those(model, **white)}


def lobe(model, light_angle: float, view_angles, given) -> np.ndarray:
    """f (N,) of the lobe alone in 1/sr at `view_angles` (N,), the light at `light_angle` on the other side."""
    return value(model, in_plane(view_angles), in_plane(-light_angle), glossy(model, given))


def seen_from_above(model, half_angles, given) -> np.ndarray:
    """f (N,) of the lobe alone in 1/sr, the view at the normal and half vectors at `half_angles` (N,), 0 to WIDEST."""
    return value(model, in_plane(0.0), in_plane(2.0 * np.asarray(half_angles)), glossy(model, given))


def half_angle(model, given) -> float:
    """Half vector's angle at which f, seen from above, has fallen to one half; WIDEST where it never does."""
    return min(float(np.degrees(match.half_angle(model, match.complete(model, given), match.ALONG))), WIDEST)


def crossing(x, y, part: float) -> float:
    """Where `y` (N,) first falls below `part` of y[0], `x` (N,) ascending; the last x where it never does."""
    low = y < part * y[0]
    if not low.any():
        return float(x[-1])
    i = int(low.argmax())
    return float(np.interp(part * y[0], y[[i, i - 1]], x[[i, i - 1]]))


def matched(model, angle: float, given=None) -> dict:
    """All parameters of the model, `given` and others, with the lobe as wide as `angle`, and round (fitting/match.py).

    Pumped ones are matched as they are before, which is nearly the same. Raises ValueError where no value of the
    parameter of shape gives that width.
    """
    values = match.complete(model, {**(given or {}), **those(model, use_roughness=False)})
    shaped, _ = match.shaped(model, {**values, **those(model, pumps=0.0)}, (np.radians(angle), np.radians(angle)))
    return {**shaped, **{name: values[name] for name in those(model, pumps=0.0)}}
