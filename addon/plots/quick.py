"""Albedos and lobes of any model for the values of its parameters, in hundredths of a second.

What is integrated by formula elsewhere is integrated here with fewer nodes, for all views at once. An albedo is within
TOLERANCE of `model.albedo`, which is less than a pixel of a small picture. Three things keep it quick:

- Nodes crowd about the mirror direction by the lobe's width, so that few are enough at any sharpness. Where a lobe is
  stretched they are drawn from its half vectors instead, by the model's own sampler.
- Pumping looks at N·L and N·V alone. The lobe is integrated over the azimuth once, and all stages weigh these sums.
- An NDF map's half vectors are summed in cells.
"""
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..forms.albedo.tabulated import TABULATED
from ..models import fresnel, half_map, pumping, quadrature
from ..models.channels import luminance
from ..models.formula_model import FormulaModel
from ..models.formulas.ndf_map import SHIPPED, NdfMapModel
from ..models.geometry import half, in_plane, view_at
from ..models.lobe_model import LobeModel
from ..models.pumped_model import PumpedModel
from ..models.samplers import Cosine
from ..resources import LUTS

TOLERANCE = 0.004  # of an albedo up to 1; above it, of itself. Lafortune's lobes that grow without bound miss it
# Views of the albedo's curve in degrees. The last stands for grazing, where some albedos have no bound.
VIEWS = np.concatenate([np.arange(0.0, 80.1, 2.5), [82.5, 85.0, 86.5, 88.0, 89.0, 89.5, 89.8, 89.95]])
NAMED = (0.0, 60.0, 80.0)  # views whose albedos are told as numbers
LOBE_VIEWS = (0.0, 45.0, 70.0)
LOBE_NODES = (12, 16)  # polar and azimuthal, of quadrature.meridians
# Nodes on an interval of the light angle, and around half a turn, of lobes as sharp as this slope and of wider ones.
SHARP = 0.05
NODES_SHARP, NODES = (6, 16), (4, 12)
DRAWN = (64, 32)  # nodes along and around the half vectors that a sampler draws
CELLS = 128  # across, of an NDF map


@dataclass(frozen=True)
class Lobe:
    """f(V, L) N·L (N,) in 1/sr, luminance, for one view at `view` degrees, the lights in its plane.

    `angles` (N,) of the lights are in degrees from the normal, ascending, positive on the mirror's side.
    """

    view: float
    angles: np.ndarray
    values: np.ndarray

    @property
    def peak(self) -> float:
        """The largest value that is a number, 1/sr; 0 where there is none."""
        return float(np.max(self.values[np.isfinite(self.values)], initial=0.0))


@dataclass(frozen=True)
class Plot:
    """What is shown of a model: `albedo` (VIEWS, 1 or 3), the same before pumping or None, and a lobe a view.

    `along_tangent`: the model knows a tangent, and it is seen along that.
    """

    albedo: np.ndarray
    unpumped: np.ndarray | None
    lobes: tuple
    along_tangent: bool

    def numbers(self) -> dict:
        """{view in degrees: albedo (1,) or (3,)} of NAMED."""
        return {view: self.albedo[int(np.argmin(np.abs(VIEWS - view)))] for view in NAMED}


def plot(model, values: dict) -> Plot:
    """The plot of a model for the `values` of its parameters, by id; those left out have their defaults.

    Raises ValueError for values that are not allowed, an image that cannot be read, a table that is missing.
    """
    p, model = model.resolve(values), model.with_albedos(TABULATED)
    # A base above 1 to a large power has no number; such places are left out of the picture.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        albedo, unpumped, evaluate = _parts(model, p)
        lobes = tuple(_lobe(evaluate, view) for view in LOBE_VIEWS)
    return Plot(_channels(albedo), None if unpumped is None else _channels(unpumped), lobes,
                any(q.id == "tangent" for q in model.parameters))


def _parts(model, p):
    """Albedo and albedo before pumping (or None), (VIEWS,) or (VIEWS, 3), and f as a function of views and lights."""
    mu = np.cos(np.radians(VIEWS))
    if isinstance(model, PumpedModel):
        return _pumped(model, p)
    if isinstance(model, NdfMapModel):
        return _mapped(model, p)
    if isinstance(model, FormulaModel):
        return _integrated(model, p), None, _evaluator(model, p)
    if isinstance(model, LobeModel):
        return (*_lobed(model, p, mu), _evaluator(model, p))
    return model._albedo(mu, p), None, _evaluator(model, p)


def _evaluator(model, p):
    return lambda view, light: model.evaluate(view, light, **{q.id: p[q.id] for q in model.parameters})


def _channels(albedo):
    """An albedo (N,) or (N, 3) as (N, 1) where its channels are alike, else (N, 3)."""
    albedo = np.asarray(albedo).reshape(len(albedo), -1)
    return albedo[:, :1] if np.all(albedo == albedo[:, :1]) else albedo


# --- lobes ---

def _lobe(evaluate, view):
    angles = _lights_in_plane(view)
    light = in_plane(angles)
    return Lobe(view, angles, luminance(evaluate(in_plane(-view), light)) * light[:, 2])


def _lights_in_plane(view):
    """Angles of lights in degrees: every half degree, and crowded about the mirror direction and the view."""
    near = np.geomspace(2e-4, 5.0, 60)
    near = np.concatenate([-near[::-1], [0.0], near])
    angles = np.unique(np.concatenate([np.arange(-89.5, 89.6, 0.5), view + near, -view + near]))
    return angles[np.abs(angles) < 90.0]


# --- albedos of single lobes and formulas ---

def _lobed(model, p, mu):
    """Albedo of a lobe over a correction term, and without that (None where there is none): `LobeModel._albedo`."""
    nodes = quadrature.meridians(model.lobe, p["exponent"], mu, *LOBE_NODES)
    tint = nodes.energy.sum(axis=2)
    if not fresnel.is_white(p):
        factor = model._factor(nodes.view_dot_half.ravel(), p).reshape(*nodes.energy.shape, 3)
        tint = np.einsum("vpa,vpac->vpc", nodes.energy, factor)
    if model.correction == "none" or p.get("pumps") == 0.0:
        return tint.sum(axis=1), None
    d = model._correction(mu[:, None], nodes.light_cosine, p)
    return (tint / (d if tint.ndim == 2 else d[..., None])).sum(axis=1), tint.sum(axis=1)


def _integrated(model, p):
    """Albedo (VIEWS,) or (VIEWS, 3) of a formula, with its mirror spike."""
    mu = np.cos(np.radians(VIEWS))
    if model.stretched is None:
        albedo = _sums(lambda view, light: model._value(view, light, p), *_meridians(mu, model.width(p))).sum(axis=1)
    elif isinstance(model.sampler(p), Cosine):
        albedo = _sums(lambda view, light: model._value(view, light, p), *_about_strand(mu, model.width(p))).sum(axis=1)
    else:
        albedo = _stretched(model, p, mu)
    if model.spike is None:
        return albedo
    return (albedo if albedo.ndim == 2 else albedo[:, None]) + model.spike(mu, p)


def _sums(value, view, light, weight):
    """`value(view, light)` times the weights, summed over the last axis of the nodes.

    `view` (V, 3), `light` (V, P, A, 3), `weight` (V, P, A), which is solid angle times N·L: (V, P) or (V, P, 3).
    """
    views = np.broadcast_to(view[:, None, None], light.shape).reshape(-1, 3)
    found = value(views, light.reshape(-1, 3))
    if found.ndim == 1:
        return (found.reshape(weight.shape) * weight).sum(axis=2)
    return np.einsum("vpac,vpa->vpc", found.reshape(*weight.shape, 3), weight)


@lru_cache(maxsize=8)
def _gauss(count):
    """Gauss-Legendre nodes and weights on 0..1."""
    return quadrature._gauss(count)


def _meridians(mu, width):
    """Views (V, 3), lights (V, P, A, 3) and weights (V, P, A) for lobes that are alike on both sides of the plane.

    As quadrature.hemisphere_nodes, but for all views at once: each has as many intervals, some of them of no length.
    """
    theta_view = np.arccos(mu)[:, None]
    steps = 2.0 * width * np.geomspace(0.3, max(3.2 / width, 1.0), 12)
    fixed = np.concatenate([[0.0, 0.5 * np.pi], 0.5 * np.pi - np.geomspace(1e-4, 0.3, 5)])
    ends = np.concatenate([theta_view, theta_view - steps, theta_view + steps,
                           np.broadcast_to(fixed, (len(mu), len(fixed)))], axis=1)
    ends = np.sort(np.clip(ends, 0.0, 0.5 * np.pi), axis=1)
    polar, azimuthal = NODES_SHARP if width < SHARP else NODES
    x, w = _gauss(polar)
    theta = (ends[:, :-1, None] + np.diff(ends)[..., None] * x).reshape(len(mu), -1)
    theta_weight = (np.diff(ends)[..., None] * w).reshape(len(mu), -1)
    sines = np.maximum(np.sin(theta_view) * np.sin(theta), 1e-12)
    near = np.maximum(1.0 + np.cos(theta_view + theta), 1e-12)
    scale = np.clip(width * np.sqrt(2.0 * near / sines), 1e-6, 10.0)[..., None]
    span = np.arcsinh(np.pi / scale)
    s, v = _gauss(azimuthal)
    phi = np.pi + scale * np.sinh(span * s)
    around = scale * span * np.cosh(span * s) * v
    weight = 2.0 * around * (theta_weight * np.sin(theta) * np.cos(theta))[..., None]
    sine, cosine = np.sin(theta)[..., None], np.cos(theta)[..., None]
    light = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(cosine, phi.shape)], axis=-1)
    return view_at(mu), light, weight


def _about_strand(mu, width):
    """As `_meridians`, for lobes that are cones about x: P angles out of the strand's normal plane, A turns about x."""
    middle = -np.arcsin(np.clip(view_at(mu)[:, :1], -1.0, 1.0))
    steps = width * np.geomspace(0.3, max(3.2 / width, 1.0), 14)
    ends = np.concatenate([middle, middle - steps, middle + steps, np.full((len(mu), 2), [-0.5 * np.pi, 0.5 * np.pi])],
                          axis=1)
    ends = np.sort(np.clip(ends, -0.5 * np.pi, 0.5 * np.pi), axis=1)
    x, w = _gauss(NODES_SHARP[0])
    out = (ends[:, :-1, None] + np.diff(ends)[..., None] * x).reshape(len(mu), -1)[..., None]
    out_weight = (np.diff(ends)[..., None] * w).reshape(len(mu), -1)[..., None]
    s, v = _gauss(NODES_SHARP[1])
    light = np.stack(np.broadcast_arrays(np.sin(out), np.cos(out) * np.cos(np.pi * s), np.cos(out) * np.sin(np.pi * s)),
                     axis=-1)
    return view_at(mu), light, np.pi * v * out_weight * np.cos(out) * light[..., 2]


def _stretched(model, p, mu):
    """Albedo (V,) or (V, 3) of a model with a tangent, along which it is seen: its lobe by half vectors as drawn."""
    dark = {**p, "diffuse_color": (0.0, 0.0, 0.0)}
    sampler = model.sampler(dark)
    along, around = np.meshgrid(_gauss(DRAWN[0])[0], np.arange(DRAWN[1]) / DRAWN[1], indexing="ij")
    # Each ring is turned against the last by the golden angle, or the horizon would cut all at the same places.
    u = np.stack([along, (around + np.arange(DRAWN[0])[:, None] * 0.5 * (3.0 - np.sqrt(5.0))) % 1.0], axis=-1)
    chance = np.repeat(_gauss(DRAWN[0])[1] / DRAWN[1], DRAWN[1])
    view = view_at(np.maximum(mu, 1e-6))
    u, views = np.tile(u.reshape(-1, 2), (len(mu), 1)), np.repeat(view, len(chance), axis=0)
    light = sampler.sample(views, u)
    above = light[:, 2] > 1e-9
    density = sampler.pdf(views[above], light[above])
    weight = np.tile(chance, len(mu))[above] * light[above, 2] / density
    found = model._value(views[above], light[above], dark).reshape(int(above.sum()), -1) * weight[:, None]
    drawn = np.zeros((len(views), found.shape[1]))
    drawn[above] = found
    albedo = drawn.reshape(len(mu), len(chance), -1).sum(axis=1)
    if any(p["diffuse_color"]):
        none = replace(model, lobe=lambda view, light, p: np.zeros(len(view)), colour=None)
        albedo = albedo + _sums(lambda v, light: none._value(v, light, p), *_meridians(mu, 0.5)).sum(axis=1)
    return albedo


# --- NDF maps ---

def _mapped(model, p):
    """As `_parts`, of an NDF map. The image is read unturned: a turn is one of half vectors."""
    found = half_map.load(p["image"] or LUTS / SHIPPED)
    turn = 2.0 * np.pi * p["rotation"]
    h, mass = _cells(found)
    view = view_at(np.cos(np.radians(VIEWS)))
    light, facing = _reflected(half_map._turned(h, turn), view)
    weight = mass * np.where((facing > 0.0) & (light[..., 2] > 0.0), light[..., 2], 0.0)
    weight = weight / np.maximum(np.maximum(light[..., 2], view[:, 2:]), 1e-12)
    views = np.broadcast_to(view[:, None], light.shape).reshape(-1, 3)
    tint = model.colour(views, light.reshape(-1, 3), p)
    albedo = weight.sum(axis=1) if tint is None else np.einsum("vm,vmc->vc", weight, tint.reshape(light.shape))
    if any(p["diffuse_color"]):
        albedo = albedo.reshape(len(VIEWS), -1) + np.asarray(p["diffuse_color"])

    def lobe(view, light, p):
        h = half(view, light)
        return (found.density(half_map._turned(h, -turn))
                / (4.0 * np.sum(view * h, axis=-1) * np.maximum(view[:, 2], light[:, 2])))

    return albedo, None, _evaluator(replace(model, lobe=lobe), p)


def _reflected(h, view):
    """Lights (V, M, 3) of half vectors (M, 3) and views (V, 3), and V·H (V, M)."""
    facing = view @ h.T
    return 2.0 * facing[..., None] * h - view[:, None], facing


@lru_cache(maxsize=4)
def _cells(found):
    """Half vectors (M, 3) of a HalfMap and p dω_H of each, (M,): those of each of CELLS² squares put together."""
    h, _, mass = found.few_nodes
    square = np.minimum((0.5 * CELLS * (h[:, :2] + 1.0)).astype(int), CELLS - 1) @ (1, CELLS)
    sums = [np.bincount(square, part, CELLS * CELLS) for part in (mass, *(mass * h.T))]
    used = sums[0] > 0.0
    middle = np.stack(sums[1:], axis=-1)[used]
    return middle / np.linalg.norm(middle, axis=-1, keepdims=True), sums[0][used]


# --- pumped formulas ---

def _pumped(model, p):
    """As `_parts`, of a pumped formula."""
    mu = np.cos(np.radians(VIEWS))
    view, light, weight = _meridians(mu, model.width(p))
    views, lights = np.broadcast_to(view[:, None, None], light.shape).reshape(-1, 3), light.reshape(-1, 3)
    energy = model.base.lobe(views, lights, p).reshape(weight.shape) * weight
    colour = model.colour and model.colour(views, lights, p)
    lobe = tint = energy.sum(axis=2)  # (V, P)
    if colour is not None:
        tint = np.einsum("vpa,vpac->vpc", energy, colour.reshape(light.shape))
    mu_light, pumps, control = light[:, :, 0, 2], p["pumps"], p["control"]
    stages = pumping.stage_albedos(lobe, mu, mu_light, int(np.ceil(pumps)), control,
                                   lambda row: _between(row, mu_light))

    def correction(mu_view, mu_light):
        return pumping.correction_at(lambda at, _: np.stack([_between(row, at) for row in stages.T], axis=-1),
                                     mu_view, mu_light, pumps, control)

    d = correction(mu[:, None], mu_light)
    before = tint.sum(axis=1) if pumps else None
    quick = replace(model, lobe=lambda v, at, p: model.base.lobe(v, at, p) / correction(v[:, 2], at[:, 2]))
    return (tint / (d if tint.ndim == 2 else d[..., None])).sum(axis=1), before, _evaluator(quick, p)


def _between(row, mu):
    """An albedo of VIEWS at the cosines `mu`, by powers between two of them, as pumped_model.py reads its own."""
    nodes = np.log(np.cos(np.radians(VIEWS[::-1])))
    return np.exp(np.interp(np.log(np.maximum(mu, 1e-12)), nodes, np.log(row[::-1])))
