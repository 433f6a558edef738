"""Albedos and lobes of any model, in hundredths of a second.

Integrals have fewer nodes than `model.albedo`, and all views are integrated at once. An albedo is within TOLERANCE of
`model.albedo`, which is less than a pixel of a small picture. Three things save time:

- Nodes crowd about the mirror direction by the lobe's width, so that few are enough at any sharpness. Nodes of a
  stretched lobe are drawn from its half vectors instead, by the model's own sampler.
- Pumping depends on N·L and N·V only. The lobe is integrated over the azimuth once, and all stages use these sums.
- An NDF map's half vectors are merged into cells.
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

# The largest error: absolute for albedos up to 1, relative above. Lafortune's lobes that grow without bound exceed it.
TOLERANCE = 0.004
# Views of the albedo's curve in degrees. The last one represents grazing, where some albedos are unbounded.
VIEWS = np.concatenate([np.arange(0.0, 80.1, 2.5), [82.5, 85.0, 86.5, 88.0, 89.0, 89.5, 89.8, 89.95]])
# Views whose albedos are shown as numbers.
NAMED = (0.0, 60.0, 80.0)
# Views whose lobes are shown.
LOBE_VIEWS = (0.0, 45.0, 70.0)
# Polar and azimuthal nodes of `quadrature.meridians`.
LOBE_NODES = (12, 16)
# Lobes of a smaller slope than this are sharp.
SHARP = 0.05
# Nodes on each interval of the light's polar angle, and on half a turn, for sharp lobes and for the others.
NODES_SHARP, NODES = (6, 16), (4, 12)
# Nodes along and around the half vectors of a sampler.
DRAWN = (64, 32)
# An NDF map has CELLS² cells.
CELLS = 128


@dataclass(frozen=True)
class Lobe:
    """The luminance of f(V, L) N·L, `values` (N,) in 1/sr, for one view and lights in the plane of incidence.

    `view` is the view's angle in degrees. `angles` (N,) are those of the lights, in degrees from the normal, ascending,
    positive on the mirror direction's side.
    """

    view: float
    angles: np.ndarray
    values: np.ndarray

    @property
    def peak(self) -> float:
        """The largest finite value in 1/sr, or 0 if there is none."""
        return float(np.max(self.values[np.isfinite(self.values)], initial=0.0))


@dataclass(frozen=True)
class Plot:
    """The data of a model's plot.

    - `albedo` (VIEWS, 1 or 3), and `unpumped`, the same before pumping or None.
    - `lobes`: a `Lobe` for each of LOBE_VIEWS.
    - `along_tangent`: the model has a tangent, and the views lie along it.
    """

    albedo: np.ndarray
    unpumped: np.ndarray | None
    lobes: tuple
    along_tangent: bool

    def numbers(self) -> dict:
        """{view in degrees: albedo (1,) or (3,)} for the views NAMED."""
        return {view: self.albedo[int(np.argmin(np.abs(VIEWS - view)))] for view in NAMED}


def plot(model, values: dict) -> Plot:
    """The plot of a model for `values` {id: value} of its parameters. Missing ones have their defaults.

    Raises ValueError for values that are not allowed, an image that cannot be read or a missing table.
    """
    p, model = model.resolve(values), model.with_albedos(TABULATED)
    # A number above 1 to a large power may overflow. The picture leaves out values that are not finite.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        albedo, unpumped, evaluate = _by_kind(model, p)
        lobes = tuple(_lobe(evaluate, view) for view in LOBE_VIEWS)
    return Plot(_channels(albedo), None if unpumped is None else _channels(unpumped), lobes,
                any(q.id == "tangent" for q in model.parameters))


def _by_kind(model, p):
    """(albedo, albedo before pumping or None, f as a function of views and lights), by the kind of model.

    Albedos are (VIEWS,) or (VIEWS, 3). `p` are resolved parameters.
    """
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
    """f as a function of views and lights."""
    return lambda view, light: model.evaluate(view, light, **{q.id: p[q.id] for q in model.parameters})


def _channels(albedo):
    """An albedo (N,) or (N, 3) as (N, 1) if its channels are equal, else as (N, 3)."""
    albedo = np.asarray(albedo).reshape(len(albedo), -1)
    return albedo[:, :1] if np.all(albedo == albedo[:, :1]) else albedo


# --- lobes ---

def _lobe(evaluate, view):
    """The `Lobe` of a view at `view` degrees."""
    angles = _lights_in_plane(view)
    light = in_plane(angles)
    return Lobe(view, angles, luminance(evaluate(in_plane(-view), light)) * light[:, 2])


def _lights_in_plane(view):
    """Angles of lights in degrees: every half degree, and denser about the mirror direction and about the view."""
    near = np.geomspace(2e-4, 5.0, 60)
    near = np.concatenate([-near[::-1], [0.0], near])
    angles = np.unique(np.concatenate([np.arange(-89.5, 89.6, 0.5), view + near, -view + near]))
    return angles[np.abs(angles) < 90.0]


# --- albedos of single lobes and formulas ---

def _lobed(model, p, mu):
    """Albedo of a LobeModel, and albedo without its correction term (None if it has none). See `LobeModel._albedo`."""
    # The energy with its color, summed over the azimuth.
    nodes = quadrature.meridians(model.lobe, p["exponent"], mu, *LOBE_NODES)
    tint = nodes.energy.sum(axis=2)
    if not fresnel.is_white(p):
        factor = model._factor(nodes.view_dot_half.ravel(), p).reshape(*nodes.energy.shape, 3)
        tint = np.einsum("vpa,vpac->vpc", nodes.energy, factor)
    # The sum over the light's polar angle, with the correction.
    if model.correction == "none" or p.get("pumps") == 0.0:
        return tint.sum(axis=1), None
    d = model._correction(mu[:, None], nodes.light_cosine, p)
    return (tint / (d if tint.ndim == 2 else d[..., None])).sum(axis=1), tint.sum(axis=1)


def _integrated(model, p):
    """Albedo (VIEWS,) or (VIEWS, 3) of a FormulaModel, including its mirror spike."""
    mu = np.cos(np.radians(VIEWS))
    # Round lobes, strands (whose sampler is Lambert's), and stretched lobes.
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
    """`value(view, light)` times the weights, summed over the nodes' last axis A: (V, P) or (V, P, 3).

    `view` (V, 3), `light` (V, P, A, 3). `weight` (V, P, A) is the solid angle times N·L.
    """
    views = np.broadcast_to(view[:, None, None], light.shape).reshape(-1, 3)
    values = value(views, light.reshape(-1, 3))
    if values.ndim == 1:
        return (values.reshape(weight.shape) * weight).sum(axis=2)
    return np.einsum("vpac,vpa->vpc", values.reshape(*weight.shape, 3), weight)


@lru_cache(maxsize=8)
def _gauss(count):
    """Gauss-Legendre nodes and weights on 0..1."""
    return quadrature._gauss(count)


def _meridians(mu, width):
    """Views (V, 3), lights (V, P, A, 3) and weights (V, P, A) for lobes symmetric about the plane of incidence.

    As `quadrature.hemisphere_nodes`, but for all views at once. All views have the same number of intervals, some of
    length 0.
    """
    # Polar angles, on intervals that grow from the mirror direction and from the horizon.
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
    # Azimuths, dense about the plane of incidence by the lobe's width there.
    sines = np.maximum(np.sin(theta_view) * np.sin(theta), 1e-12)
    near = np.maximum(1.0 + np.cos(theta_view + theta), 1e-12)
    scale = np.clip(width * np.sqrt(2.0 * near / sines), 1e-6, 10.0)[..., None]
    span = np.arcsinh(np.pi / scale)
    s, v = _gauss(azimuthal)
    phi = np.pi + scale * np.sinh(span * s)
    phi_weight = scale * span * np.cosh(span * s) * v
    # Both sides of the plane count.
    weight = 2.0 * phi_weight * (theta_weight * np.sin(theta) * np.cos(theta))[..., None]
    sine, cosine = np.sin(theta)[..., None], np.cos(theta)[..., None]
    light = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.broadcast_to(cosine, phi.shape)], axis=-1)
    return view_at(mu), light, weight


def _about_strand(mu, width):
    """As `_meridians`, for lobes that are cones about x.

    P is the number of angles from the strand's normal plane, A that of angles about the strand.
    """
    # Angles from the normal plane, on intervals that grow from the cone.
    middle = -np.arcsin(np.clip(view_at(mu)[:, :1], -1.0, 1.0))
    steps = width * np.geomspace(0.3, max(3.2 / width, 1.0), 14)
    ends = np.concatenate([middle, middle - steps, middle + steps, np.full((len(mu), 2), [-0.5 * np.pi, 0.5 * np.pi])],
                          axis=1)
    ends = np.sort(np.clip(ends, -0.5 * np.pi, 0.5 * np.pi), axis=1)
    x, w = _gauss(NODES_SHARP[0])
    out = (ends[:, :-1, None] + np.diff(ends)[..., None] * x).reshape(len(mu), -1)[..., None]
    out_weight = (np.diff(ends)[..., None] * w).reshape(len(mu), -1)[..., None]
    # Angles about the strand, even.
    s, v = _gauss(NODES_SHARP[1])
    light = np.stack(np.broadcast_arrays(np.sin(out), np.cos(out) * np.cos(np.pi * s), np.cos(out) * np.sin(np.pi * s)),
                     axis=-1)
    return view_at(mu), light, np.pi * v * out_weight * np.cos(out) * light[..., 2]


def _stretched(model, p, mu):
    """Albedo (V, 1) or (V, 3) of a model with a tangent, seen along it, by samples of its half vectors."""
    # A grid of uniform numbers.
    dark = {**p, "diffuse_color": (0.0, 0.0, 0.0)}
    sampler = model.sampler(dark)
    along, around = np.meshgrid(_gauss(DRAWN[0])[0], np.arange(DRAWN[1]) / DRAWN[1], indexing="ij")
    # Each ring is turned by the golden angle relative to the last, since otherwise the horizon cuts all rings alike.
    u = np.stack([along, (around + np.arange(DRAWN[0])[:, None] * 0.5 * (3.0 - np.sqrt(5.0))) % 1.0], axis=-1)
    chance = np.repeat(_gauss(DRAWN[0])[1] / DRAWN[1], DRAWN[1])
    # The samples' lights and weights.
    view = view_at(np.maximum(mu, 1e-6))
    u, views = np.tile(u.reshape(-1, 2), (len(mu), 1)), np.repeat(view, len(chance), axis=0)
    light = sampler.sample(views, u)
    above = light[:, 2] > 1e-9
    density = sampler.pdf(views[above], light[above])
    weight = np.tile(chance, len(mu))[above] * light[above, 2] / density
    # The lobe's albedo.
    lit = model._value(views[above], light[above], dark).reshape(int(above.sum()), -1) * weight[:, None]
    energy = np.zeros((len(views), lit.shape[1]))
    energy[above] = lit
    albedo = energy.reshape(len(mu), len(chance), -1).sum(axis=1)
    # The diffuse part's albedo.
    if any(p["diffuse_color"]):
        diffuse = replace(model, lobe=lambda view, light, p: np.zeros(len(view)), colour=None)
        albedo = albedo + _sums(lambda v, light: diffuse._value(v, light, p), *_meridians(mu, 0.5)).sum(axis=1)
    return albedo


# --- NDF maps ---

def _mapped(model, p):
    """As `_by_kind`, for an NDF map. The image is loaded without a turn, and half vectors are turned instead."""
    half_vectors = half_map.load(p["image"] or LUTS / SHIPPED)
    turn = 2.0 * np.pi * p["rotation"]
    h, mass = _cells(half_vectors)
    # Each cell's energy, without color.
    view = view_at(np.cos(np.radians(VIEWS)))
    light, facing = _reflected(half_map._turned(h, turn), view)
    weight = mass * np.where((facing > 0.0) & (light[..., 2] > 0.0), light[..., 2], 0.0)
    weight = weight / np.maximum(np.maximum(light[..., 2], view[:, 2:]), 1e-12)
    # The sum over the cells, with their colors, and the diffuse part.
    views = np.broadcast_to(view[:, None], light.shape).reshape(-1, 3)
    tint = model.colour(views, light.reshape(-1, 3), p)
    albedo = weight.sum(axis=1) if tint is None else np.einsum("vm,vmc->vc", weight, tint.reshape(light.shape))
    if any(p["diffuse_color"]):
        albedo = albedo.reshape(len(VIEWS), -1) + np.asarray(p["diffuse_color"])

    def lobe(view, light, p):
        h = half(view, light)
        return (half_vectors.density(half_map._turned(h, -turn))
                / (4.0 * np.sum(view * h, axis=-1) * np.maximum(view[:, 2], light[:, 2])))

    return albedo, None, _evaluator(replace(model, lobe=lobe), p)


def _reflected(h, view):
    """Lights (V, M, 3) by reflection of views (V, 3) about half vectors `h` (M, 3), and V·H (V, M)."""
    facing = view @ h.T
    return 2.0 * facing[..., None] * h - view[:, None], facing


@lru_cache(maxsize=4)
def _cells(half_vectors):
    """Mean half vectors (M, 3) and p dω_H (M,) of the cells of a HalfMap that are not empty."""
    h, _, mass = half_vectors.few_nodes
    cell = np.minimum((0.5 * CELLS * (h[:, :2] + 1.0)).astype(int), CELLS - 1) @ (1, CELLS)
    sums = [np.bincount(cell, weights, CELLS * CELLS) for weights in (mass, *(mass * h.T))]
    used = sums[0] > 0.0
    middle = np.stack(sums[1:], axis=-1)[used]
    return middle / np.linalg.norm(middle, axis=-1, keepdims=True), sums[0][used]


# --- pumped formulas ---

def _pumped(model, p):
    """As `_by_kind`, for a pumped formula."""
    # The lobe's energy, without and with its color, summed over the azimuth.
    mu = np.cos(np.radians(VIEWS))
    view, light, weight = _meridians(mu, model.width(p))
    views, lights = np.broadcast_to(view[:, None, None], light.shape).reshape(-1, 3), light.reshape(-1, 3)
    energy = model.base.lobe(views, lights, p).reshape(weight.shape) * weight
    colour = model.colour and model.colour(views, lights, p)
    lobe = tint = energy.sum(axis=2)  # (V, P)
    if colour is not None:
        tint = np.einsum("vpa,vpac->vpc", energy, colour.reshape(light.shape))
    # The stages' albedos, and D by interpolation of them.
    mu_light, pumps, control = light[:, :, 0, 2], p["pumps"], p["control"]
    stages = pumping.stage_albedos(lobe, mu, mu_light, int(np.ceil(pumps)), control,
                                   lambda row: _between(row, mu_light))

    def correction(mu_view, mu_light):
        return pumping.correction_at(lambda at, _: np.stack([_between(row, at) for row in stages.T], axis=-1),
                                     mu_view, mu_light, pumps, control)

    # The albedos, and f with the same D.
    d = correction(mu[:, None], mu_light)
    before = tint.sum(axis=1) if pumps else None
    quick = replace(model, lobe=lambda v, at, p: model.base.lobe(v, at, p) / correction(v[:, 2], at[:, 2]))
    return (tint / (d if tint.ndim == 2 else d[..., None])).sum(axis=1), before, _evaluator(quick, p)


def _between(row, mu):
    """An albedo (VIEWS,) interpolated to cosines `mu`, by powers of the cosine as in pumped_model.py."""
    nodes = np.log(np.cos(np.radians(VIEWS[::-1])))
    return np.exp(np.interp(np.log(np.maximum(mu, 1e-12)), nodes, np.log(row[::-1])))
