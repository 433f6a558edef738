"""Albedo integrals over the hemisphere: light angle by light angle, around each the azimuth.

A correction term depends on the light through N·L alone, and every edge it has (max(a(L), a(V)) changing branch at
N·L = N·V, control setting in) is a line of constant N·L. With the light's polar angle as the outer variable those
edges are points of a one-dimensional integral, where intervals can end, and the inner integral over the azimuth sees
the smooth lobe only.
"""
from dataclasses import dataclass

import numpy as np

_FLOOR = 1e-9  # of the lobe's peak: what lies beyond cannot change an albedo by 1e-8


@dataclass(frozen=True)
class Meridians:
    """Nodes for several views: `light_cosine` (views, polar), the others (views, polar, azimuth).

    `energy` is f_0 (N·L) times the node's solid angle, so that its sum is the albedo of f_0.
    """

    light_cosine: np.ndarray
    view_dot_half: np.ndarray
    energy: np.ndarray


def _gauss(count):
    """Gauss-Legendre nodes and weights on 0..1."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def _polar_nodes(lobe, exponent, theta, count, edges):
    """Light angles (views, nodes) and weights, `count` on each interval between places where the integrand bends."""
    reach, core = (lobe.reach(exponent, floor, theta) for floor in (_FLOOR, 0.3))
    low, high = np.maximum(theta - reach, 0.0), np.minimum(theta + reach, 0.5 * np.pi)
    inside = [theta - core, theta, theta + core, 0.5 * np.pi - theta]
    inside += [np.full_like(theta, np.arccos(edge)) for edge in edges] + lobe.ends(theta)
    ends = np.sort(np.clip(np.stack([low, *inside, high], axis=-1), low[:, None], high[:, None]), axis=-1)
    # Flattening both ends of an interval (x = s^2 (3 - 2 s)) absorbs square roots there.
    s, w = _gauss(count)
    begin, width = ends[..., :-1], np.diff(ends, axis=-1)
    # Most edges lie outside a narrow lobe. Intervals of no length go last, and those that all views have go away.
    order = np.argsort(width == 0.0, axis=-1, kind="stable")[:, :max(np.count_nonzero(width, axis=-1).max(), 1)]
    begin, width = (np.take_along_axis(x, order, axis=-1)[..., None] for x in (begin, width))
    nodes = begin + width * (s * s * (3.0 - 2.0 * s))
    weights = width * (w * 6.0 * s * (1.0 - s))
    return nodes.reshape(len(theta), -1), weights.reshape(len(theta), -1)


def meridians(lobe, exponent: float, cos_theta, polar: int = 24, azimuthal: int = 40, edges=()) -> Meridians:
    """Quadrature for the views at `cos_theta` (N,).

    `polar` nodes lie on each interval of the light angle, `azimuthal` on half a turn around each; `edges` are light
    cosines at which the correction term to come has an edge.
    """
    cosine = np.clip(np.atleast_1d(np.asarray(cos_theta, dtype=np.float64)), 0.0, 1.0)
    theta_view = np.minimum(np.arccos(cosine), lobe.steepest)
    mu_view = np.maximum(cosine, 0.5 * np.pi - lobe.steepest)
    theta, theta_weight = _polar_nodes(lobe, exponent, theta_view, polar, edges)
    mu_light = np.maximum(np.cos(theta), 0.0)

    # phi = scale sinh(u) follows the lobe at every width: even near its axis, logarithmic in its tails.
    scale, end = lobe.azimuths(theta_view[:, None], theta, exponent)
    span = np.arcsinh(end / scale)
    s, w = _gauss(azimuthal)
    if lobe.ends_steeply:
        s, w = s * (2.0 - s), w * 2.0 * (1.0 - s)
    u = span[..., None] * s
    phi = scale[..., None] * np.sinh(u)
    phi_weight = 2.0 * scale[..., None] * np.cosh(u) * span[..., None] * w

    # The in-plane part of V+L, squared, without cancellation: it decides, and is small for sharp lobes.
    sines = np.sin(theta_view)[:, None] * np.sin(theta)
    nearest = 2.0 * np.cos(0.5 * (theta_view[:, None] + theta)) * np.sin(0.5 * (theta_view[:, None] - theta))
    across2 = nearest[..., None] ** 2 + 4.0 * sines[..., None] * np.sin(0.5 * phi) ** 2
    value = lobe.value_of_angles(across2, mu_view[:, None, None], mu_light[..., None], exponent)
    energy = value * phi_weight * (theta_weight * np.sin(theta) * mu_light)[..., None]
    squared = across2 + ((mu_view[:, None] + mu_light) ** 2)[..., None]  # |V+L|^2 = 4 (V·H)^2
    view_dot_half = np.clip(0.5 * np.sqrt(squared), 0.0, 1.0)
    return Meridians(mu_light, view_dot_half, energy)


def polar_energy(lobe, exponent: float, cos_theta, polar: int, azimuthal: int, edges=(), block: int = 24):
    """`meridians` summed over the azimuth, (light_cosine, energy), both (views, polar), for many views at once.

    Views are taken `block` by block, so that the arrays over the azimuth stay in the processor's cache.
    """
    parts = [
        (nodes.light_cosine, nodes.energy.sum(axis=-1))
        for start in range(0, len(cos_theta), block)
        for nodes in [meridians(lobe, exponent, cos_theta[start : start + block], polar, azimuthal, edges)]
    ]
    # Blocks may have nodes of different number; where one has fewer, the rest gets no energy.
    most = max(light.shape[1] for light, _ in parts)
    fill = [((0, 0), (0, most - light.shape[1])) for light, _ in parts]
    return (np.concatenate([np.pad(light, f, constant_values=1.0) for (light, _), f in zip(parts, fill, strict=True)]),
            np.concatenate([np.pad(energy, f) for (_, energy), f in zip(parts, fill, strict=True)]))


def hemisphere(evaluate, view, width: float, mirrored: bool = True, polar: int = 12, azimuthal: int = 48):
    """Integral of `evaluate(view, light)`, (N,) or (N, 3) in 1/sr, times N·L over the lights above the horizon.

    The other arguments are those of `hemisphere_nodes`. Returns a number or (3,).
    """
    light, weight = hemisphere_nodes(view, width, mirrored, polar, azimuthal)
    value = evaluate(np.broadcast_to(view, light.shape), light)
    return (value * (weight if value.ndim == 1 else weight[:, None])).sum(axis=0)


def hemisphere_nodes(view, width: float, mirrored: bool = True, polar: int = 12, azimuthal: int = 48):
    """Lights (N, 3) above the horizon and weights (N,), solid angle times N·L, to integrate what is seen from `view`.

    They are dense where half vectors lean by `width` (a slope) or less. `mirrored`: both sides of the plane of
    incidence are alike, and the lights lie on one and count twice.
    """
    light, weight = _one_side(float(view[2]), width, polar, azimuthal)
    if mirrored:
        weight = 2.0 * weight
    else:
        light = np.concatenate([light, light * [1.0, -1.0, 1.0]])
        weight = np.concatenate([weight, weight])
    across = np.hypot(view[0], view[1])
    if view[1] and across:
        c, s = view[0] / across, view[1] / across
        light = np.stack([c * light[:, 0] - s * light[:, 1], s * light[:, 0] + c * light[:, 1], light[:, 2]], axis=-1)
    return light, weight


def _one_side(mu_view, width, polar, azimuthal):
    """Lights (N, 3) on the side y <= 0 and weights (N,): solid angle times N·L."""
    theta_view = np.arccos(min(mu_view, 1.0))
    # Intervals of the light angle grow geometrically from the mirror direction, and from the horizon.
    steps = 2.0 * width * np.geomspace(0.3, max(3.2 / width, 1.0), 12)
    ends = np.concatenate([[0.0, theta_view, 0.5 * np.pi], theta_view - steps, theta_view + steps,
                           0.5 * np.pi - np.geomspace(1e-4, 0.3, 5)])
    ends = np.unique(ends[(ends >= 0.0) & (ends <= 0.5 * np.pi)])
    x, w = _gauss(polar)
    theta = (ends[:-1, None] + np.diff(ends)[:, None] * x).ravel()
    theta_weight = (np.diff(ends)[:, None] * w).ravel()
    # Over the azimuth from the mirror plane a lobe is as wide as half vectors say (as a half-vector power's is).
    sines = np.maximum(np.sin(theta_view) * np.sin(theta), 1e-12)
    near = np.maximum(1.0 + np.cos(theta_view + theta), 1e-12)
    scale = np.clip(width * np.sqrt(2.0 * near / sines), 1e-6, 10.0)
    span = np.arcsinh(np.pi / scale)
    s, v = _gauss(azimuthal)
    u = span[:, None] * s
    phi = np.pi + scale[:, None] * np.sinh(u)
    weight = (scale * span)[:, None] * np.cosh(u) * v * (theta_weight * np.sin(theta) * np.cos(theta))[:, None]
    sine, cosine = np.sin(theta)[:, None], np.cos(theta)[:, None]
    light = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(cosine, phi.shape)], axis=-1)
    return light.reshape(-1, 3), weight.ravel()
