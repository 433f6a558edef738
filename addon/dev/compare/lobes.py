"""Lobes in the plane of incidence, the x-z plane, and their widths, for comparing models.

The plane contains the tangent, so strands and stretched lobes are cut along it. Angles are in degrees from the normal;
views on the mirror direction's side have positive angles. `given` are a model's parameters {id: value}.
"""
import numpy as np

from ...fitting import match
from ...models.channels import mean
from ...models.geometry import in_plane

WIDEST = 45.0  # degrees; at normal incidence the light of such a half vector is at the horizon


def value(model, view, light, given) -> np.ndarray:
    """f(V, L) in 1/sr, the mean of its channels, (N,)."""
    return mean(model.evaluate(view, light, **given))


def those(model, **values) -> dict:
    """The items of `values` that are parameters of the model."""
    known = {p.id for p in model.parameters}
    return {name: x for name, x in values.items() if name in known}


def glossy(model, given) -> dict:
    """`given` with a white color and no diffuse part: the lobe alone."""
    white = {"base_color": (1.0, 1.0, 1.0), "diffuse_color": (0.0, 0.0, 0.0), "fresnel_type": "constant"}
    return {**given, **those(model, **white)}


def lobe(model, light_angle: float, view_angles, given) -> np.ndarray:
    """f (N,) of the lobe alone in 1/sr at `view_angles` (N,), the light at `light_angle` on the other side."""
    return value(model, in_plane(view_angles), in_plane(-light_angle), glossy(model, given))


def seen_from_above(model, half_angles, given) -> np.ndarray:
    """f (N,) of the lobe alone in 1/sr, the view at the normal and half vectors at `half_angles` (N,), 0 to WIDEST."""
    return value(model, in_plane(0.0), in_plane(2.0 * np.asarray(half_angles)), glossy(model, given))


def half_angle(model, given) -> float:
    """The half vector's angle (degrees) where f, seen from above, falls to one half; WIDEST where it never does."""
    return min(float(np.degrees(match.half_angle(model, match.complete(model, given), match.ALONG))), WIDEST)


def crossing(x, y, part: float) -> float:
    """The x where `y` (N,) first falls below `part` of y[0]; `x` (N,) ascends. The last x where y never falls."""
    low = y < part * y[0]
    if not low.any():
        return float(x[-1])
    i = int(low.argmax())
    return float(np.interp(part * y[0], y[[i, i - 1]], x[[i, i - 1]]))


def matched(model, angle: float, given=None) -> dict:
    """All parameters of the model with its lobe round and of half angle `angle` (fitting/match.py); others as `given`.

    Pumped models are matched unpumped, which is nearly the same. Raises ValueError where no value of the width
    parameter gives that width.
    """
    values = match.complete(model, {**(given or {}), **those(model, use_roughness=False)})
    shaped, _ = match.shaped(model, {**values, **those(model, pumps=0.0)}, (np.radians(angle), np.radians(angle)))
    return {**shaped, **{name: values[name] for name in those(model, pumps=0.0)}}
