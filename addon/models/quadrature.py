"""Albedo integrals over the hemisphere: the outer variable is the light's polar angle, the inner one its azimuth.

A correction term depends on the light only through N·L. Each of its kinks is therefore a line of constant N·L: where
max(a(L), a(V)) changes branch, at N·L = N·V, and where control begins to act. With the polar angle as the outer
variable, the kinks are points of a one-dimensional integral, and intervals can end at them. The integrand of the inner
integral is the smooth lobe alone.
"""
from dataclasses import dataclass

import numpy as np

# The integral ends where the lobe falls to this fraction of its peak. The tail changes an albedo by less than 1e-8.
_FLOOR = 1e-9


@dataclass(frozen=True)
class Meridians:
    """Quadrature nodes for several views.

    - `light_cosine` (views, polar): N·L.
    - `view_dot_half` (views, polar, azimuth): V·H.
    - `energy` (views, polar, azimuth): f_0 (N·L) times the node's solid angle. Its sum is the albedo of f_0.
    """

    light_cosine: np.ndarray
    view_dot_half: np.ndarray
    energy: np.ndarray


def _gauss(count):
    """Gauss-Legendre nodes and weights on 0..1."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def _polar_nodes(lobe, exponent, theta, count, edges):
    """Light angles (views, nodes) and weights, `count` on each interval between two kinks of the integrand."""
    # The ends of the intervals: the lobe's reach, its core, the mirror direction, kinks, and the lobe's own ends.
    reach, core = (lobe.reach(exponent, floor, theta) for floor in (_FLOOR, 0.3))
    low, high = np.maximum(theta - reach, 0.0), np.minimum(theta + reach, 0.5 * np.pi)
    inside = [theta - core, theta, theta + core, 0.5 * np.pi - theta]
    inside += [np.full_like(theta, np.arccos(edge)) for edge in edges] + lobe.ends(theta)
    ends = np.sort(np.clip(np.stack([low, *inside, high], axis=-1), low[:, None], high[:, None]), axis=-1)
    # x = s^2 (3 - 2 s) flattens the integrand at both ends of an interval, where it may behave like a square root.
    s, w = _gauss(count)
    begin, width = ends[..., :-1], np.diff(ends, axis=-1)
    # Most kinks lie outside a narrow lobe. Intervals of length 0 are sorted last, and dropped where all views have one.
    order = np.argsort(width == 0.0, axis=-1, kind="stable")[:, :max(np.count_nonzero(width, axis=-1).max(), 1)]
    begin, width = (np.take_along_axis(x, order, axis=-1)[..., None] for x in (begin, width))
    nodes = begin + width * (s * s * (3.0 - 2.0 * s))
    weights = width * (w * 6.0 * s * (1.0 - s))
    return nodes.reshape(len(theta), -1), weights.reshape(len(theta), -1)


def meridians(lobe, exponent: float, cos_theta, polar: int = 24, azimuthal: int = 40, edges=()) -> Meridians:
    """Quadrature nodes for the views at `cos_theta` (N,). `lobe` is one of `lobes`.

    `polar` is the number of nodes on each interval of the light's polar angle, `azimuthal` the number on half a turn.
    `edges` are the light cosines at which the correction term has a kink.
    """
    # Polar angles of views and lights.
    cosine = np.clip(np.atleast_1d(np.asarray(cos_theta, dtype=np.float64)), 0.0, 1.0)
    theta_view = np.minimum(np.arccos(cosine), lobe.steepest)
    mu_view = np.maximum(cosine, 0.5 * np.pi - lobe.steepest)
    theta, theta_weight = _polar_nodes(lobe, exponent, theta_view, polar, edges)
    mu_light = np.maximum(np.cos(theta), 0.0)

    # Azimuths phi = scale sinh(u): even near the lobe's axis, logarithmic in its tails, at every width.
    scale, end = lobe.azimuths(theta_view[:, None], theta, exponent)
    span = np.arcsinh(end / scale)
    s, w = _gauss(azimuthal)
    if lobe.ends_steeply:
        s, w = s * (2.0 - s), w * 2.0 * (1.0 - s)
    u = span[..., None] * s
    phi = scale[..., None] * np.sinh(u)
    phi_weight = 2.0 * scale[..., None] * np.cosh(u) * span[..., None] * w

    # The squared in-plane part of V+L, without cancellation: sharp lobes depend on small values of it.
    sines = np.sin(theta_view)[:, None] * np.sin(theta)
    nearest = 2.0 * np.cos(0.5 * (theta_view[:, None] + theta)) * np.sin(0.5 * (theta_view[:, None] - theta))
    across2 = nearest[..., None] ** 2 + 4.0 * sines[..., None] * np.sin(0.5 * phi) ** 2
    value = lobe.value_of_angles(across2, mu_view[:, None, None], mu_light[..., None], exponent)
    # The lobe's energy at each node, and V·H.
    energy = value * phi_weight * (theta_weight * np.sin(theta) * mu_light)[..., None]
    squared = across2 + ((mu_view[:, None] + mu_light) ** 2)[..., None]  # |V+L|^2 = 4 (V·H)^2
    view_dot_half = np.clip(0.5 * np.sqrt(squared), 0.0, 1.0)
    return Meridians(mu_light, view_dot_half, energy)


def polar_energy(lobe, exponent: float, cos_theta, polar: int, azimuthal: int, edges=(), block: int = 24):
    """`meridians` of many views, with the energy summed over the azimuth: (light_cosine, energy), both (views, polar).

    Blocks of `block` views are integrated one after the other, so that their arrays fit the processor's cache.
    """
    blocks = [
        (nodes.light_cosine, nodes.energy.sum(axis=-1))
        for start in range(0, len(cos_theta), block)
        for nodes in [meridians(lobe, exponent, cos_theta[start : start + block], polar, azimuthal, edges)]
    ]
    # Blocks may have different numbers of nodes. They are padded with nodes of no energy.
    most = max(light.shape[1] for light, _ in blocks)
    fill = [((0, 0), (0, most - light.shape[1])) for light, _ in blocks]
    return (np.concatenate([np.pad(light, f, constant_values=1.0) for (light, _), f in zip(blocks, fill, strict=True)]),
            np.concatenate([np.pad(energy, f) for (_, energy), f in zip(blocks, fill, strict=True)]))


def hemisphere(evaluate, view, width: float, mirrored: bool = True, polar: int = 12, azimuthal: int = 48):
    """Integral of `evaluate(view, light)` times N·L over the lights above the horizon, for one view (3,).

    `evaluate` returns (N,) or (N, 3) in 1/sr. The other arguments are those of `hemisphere_nodes`. Returns a number or
    (3,).
    """
    light, weight = hemisphere_nodes(view, width, mirrored, polar, azimuthal)
    value = evaluate(np.broadcast_to(view, light.shape), light)
    return (value * (weight if value.ndim == 1 else weight[:, None])).sum(axis=0)


def hemisphere_nodes(view, width: float, mirrored: bool = True, polar: int = 12, azimuthal: int = 48):
    """Quadrature over the lights that `view` (3,) sees: lights (N, 3) above the horizon and weights (N,).

    A weight is the solid angle times N·L. The lights are dense where the half vector's slope is `width` or less.
    `mirrored`: the integrand is the same on both sides of the plane of incidence. The lights then lie on one side, and
    their weights are doubled. `polar` is the number of nodes on each interval of the light's polar angle, `azimuthal`
    the number on half a turn.
    """
    # Lights for a view in the x-z plane, on one side or on both.
    light, weight = _one_side(float(view[2]), width, polar, azimuthal)
    if mirrored:
        weight = 2.0 * weight
    else:
        light = np.concatenate([light, light * [1.0, -1.0, 1.0]])
        weight = np.concatenate([weight, weight])
    # Turned to the view's azimuth.
    across = np.hypot(view[0], view[1])
    if view[1] and across:
        c, s = view[0] / across, view[1] / across
        light = np.stack([c * light[:, 0] - s * light[:, 1], s * light[:, 0] + c * light[:, 1], light[:, 2]], axis=-1)
    return light, weight


def _one_side(mu_view, width, polar, azimuthal):
    """Lights (N, 3) on the side y <= 0 and weights (N,), solid angle times N·L, for a view in the x-z plane."""
    theta_view = np.arccos(min(mu_view, 1.0))
    # Intervals of the light angle grow geometrically from the mirror direction, and from the horizon.
    steps = 2.0 * width * np.geomspace(0.3, max(3.2 / width, 1.0), 12)
    ends = np.concatenate([[0.0, theta_view, 0.5 * np.pi], theta_view - steps, theta_view + steps,
                           0.5 * np.pi - np.geomspace(1e-4, 0.3, 5)])
    ends = np.unique(ends[(ends >= 0.0) & (ends <= 0.5 * np.pi)])
    x, w = _gauss(polar)
    theta = (ends[:-1, None] + np.diff(ends)[:, None] * x).ravel()
    theta_weight = (np.diff(ends)[:, None] * w).ravel()
    # Azimuths phi = pi + scale sinh(u), where `scale` is the azimuthal width of a half-vector power's lobe.
    sines = np.maximum(np.sin(theta_view) * np.sin(theta), 1e-12)
    near = np.maximum(1.0 + np.cos(theta_view + theta), 1e-12)
    scale = np.clip(width * np.sqrt(2.0 * near / sines), 1e-6, 10.0)
    span = np.arcsinh(np.pi / scale)
    s, v = _gauss(azimuthal)
    u = span[:, None] * s
    phi = np.pi + scale[:, None] * np.sinh(u)
    weight = (scale * span)[:, None] * np.cosh(u) * v * (theta_weight * np.sin(theta) * np.cos(theta))[:, None]
    # The directions.
    sine, cosine = np.sin(theta)[:, None], np.cos(theta)[:, None]
    light = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(cosine, phi.shape)], axis=-1)
    return light.reshape(-1, 3), weight.ravel()
