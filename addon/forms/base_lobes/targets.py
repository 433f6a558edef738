"""The targets of base lobes: the formulas with all their gains, and the lights over which they are fitted.

A target is f_0 gain(M) min(1, N·L / N·V) with M = max(N·L, N·V) and gain(M) = M / D(M).
"""
import numpy as np

from ...models import MODELS
from ...models.lobes import BLINN, PHONG
from ..albedo.tabulated import TABULATED
from .closures import Family, feature_cosines

HORIZON = 48  # number of lights on the horizon
# The targets of the fit, (pumps, control); None is the limit of pumping, whose gain is 1.
GAINS = (None, (0.0, False), (0.5, True), (2.0, False), (4.0, False))


def gains(family: Family, cosines, n):
    """Gains M / D(M) (GAINS, N) at `cosines` M (N,), 0..1, one row for each of GAINS."""
    light = np.stack([np.sqrt(1.0 - cosines**2), np.zeros_like(cosines), cosines], axis=-1)
    view = light * [-1.0, 1.0, 1.0]
    f0 = family.lobe.value(view, light, n)
    pumped = MODELS[f"pumped_{family.lobe.id}"].with_albedos(TABULATED)
    rows = []
    for choice in GAINS:
        if choice is None:
            rows.append(np.ones_like(cosines))
        else:
            f = pumped.evaluate(view, light, exponent=n, pumps=choice[0], control=choice[1])
            rows.append(cosines * f / f0)
    return np.array(rows)


def lights(family: Family, view, n):
    """Light directions (N, 3) above the horizon and their solid angles (N,), over the target and all of its closures.

    A half-vector lobe at grazing is oblong, and round closures reach far beyond it. So half of the lights are spread
    over it, and half over the Phong lobe of equal width. A few lie on the horizon, where leaning closures may be
    negative.
    """
    light, angle = _lights(PHONG, view, family.phong_exponent(n))
    if family.lobe is BLINN:
        own, own_angle = _lights(BLINN, view, n)
        light, angle = np.concatenate([light, own]), 0.5 * np.concatenate([angle, own_angle])
    phi = np.pi * (np.arange(HORIZON) + 0.5) / HORIZON
    horizon = np.stack([-np.cos(phi), np.sin(phi), np.full(HORIZON, 1e-3)], axis=-1)
    return np.concatenate([light, horizon]), np.append(angle, np.full(HORIZON, 0.5 * angle.mean()))


def _lights(lobe, view, n, rings=40, around=24):
    """Lights and solid angles on rings about the axis of a lobe, on one side of the plane of incidence."""
    # Rings at the angle delta from the mirror direction; for half-vector lobes the half vector turns by delta / 2.
    theta = np.arccos(view[2])
    reach = min(1.4 * lobe.reach(n, 1e-5), np.pi - 1e-3)
    delta = reach * (np.arange(rings) + 0.5) / rings
    # Each ring ends at the horizon. For both lobes N·L = cos(delta) cos(theta) + sin(delta) sin(theta) cos(phi).
    a, b = np.cos(delta) * np.cos(theta), np.maximum(np.sin(delta) * np.sin(theta), 1e-12)
    end = np.arccos(np.clip(-a / b, -1.0, 1.0))
    phi = (end[:, None] * (np.arange(around) + 0.5) / around).ravel()
    delta, angle = np.repeat(delta, around), np.repeat(end, around) * 2.0 * reach / (rings * around)
    if lobe is PHONG:
        mirror, toward_normal = np.array([-view[0], 0.0, view[2]]), np.array([view[2], 0.0, view[0]])
        inplane = np.cos(delta)[:, None] * mirror + (np.sin(delta) * np.cos(phi))[:, None] * toward_normal
        return inplane + (np.sin(delta) * np.sin(phi))[:, None] * [0.0, 1.0, 0.0], angle * np.sin(delta)
    h = 0.5 * delta
    halves = np.stack([np.sin(h) * np.cos(phi), np.sin(h) * np.sin(phi), np.cos(h)], axis=-1)
    along = (halves @ view).clip(0.0)
    # dL = 4 (V·H) dH, and the half vector turns half as far as delta.
    return 2.0 * along[:, None] * halves - view, angle * 2.0 * along * np.sin(h)


def targets(family, view, light, n):
    """(features (GAINS, FEATURES), targets (GAINS, N), f (N·L) (GAINS, N)) at a view (3,) and lights (N, 3).

    With `plain`, features and targets are without the part that is exactly a multiple of phong_ramp.
    """
    # f_0, and the gain at the larger cosine of view and light.
    theta, mu = np.arccos(view[2]), np.maximum(light[:, 2], 0.0)
    lobe = family.lobe.value(np.broadcast_to(view, light.shape), light, n)
    fine = np.cos(np.linspace(theta, 0.0, 400))
    gain = np.array([np.interp(np.maximum(mu, view[2]), fine, row) for row in gains(family, fine, n)])
    # The gain at the features. With `plain` its least slope over M is the multiple of phong_ramp.
    at = feature_cosines(family, theta, n)
    features, whole = gains(family, at, n), lobe * np.minimum(1.0, mu / view[2]) * gain
    slope = (features / at).min(axis=1, keepdims=True) if family.plain else 0.0
    return features - slope * at, whole - slope * lobe * mu, whole
