"""The inputs of Blender's Principled BSDF that are nearest to a model: for EEVEE, the viewport, and GPUs.

The fit minimizes the sum of two errors. Both are in parts of the model's own light, with the channels added up, and
means over views at 0, 30 and 60 degrees; a model with a tangent is viewed along and across it.

- The error of the lobe is ∫ |f - f_P| N·L dω over ∫ f N·L dω, 0..2: the error of a picture under a sun.
- The error of the albedo is |a - a_P| / a: the error of a picture under a white sky.

Base colors make the albedo right at 0 and at 60 degrees. A search finds roughness, metallic and IOR. A lobe misses the
light of a mirror spike; a perfect mirror has it.
"""
from dataclasses import dataclass

import numpy as np

from ...forms.albedo.tabulated import TABULATED
from ...models import quadrature
from ...models.channels import rgb
from ...models.geometry import dot, half, reflect, view_at
from . import principled_bsdf as bsdf
from .appearance import appearance

VIEWS = (0.0, 30.0, 60.0)  # degrees
# {model: fitted roughness over roughness_of_exponent of the model's `appearance`}, for nodes, which can only multiply.
# Between exponents of 10 and 3000 its error is at most 12 %, for most models 5 %. The fit is
# `plausible match --native --from MODEL --set exponent=N`.
ROUGHNESS_FACTORS = {
    "phong": 0.945, "pumped_phong": 0.965, "phong_limit": 0.965, "blinn": 0.88, "pumped_blinn": 0.905,
    "disk_scaling": 0.69, "disk_orthogonal": 0.705, "edwards_empirical": 0.54, "edwards_fit": 0.77,
    "reciprocal_disk": 0.665,
}
_POLAR, _AZIMUTHAL = 4, 14  # quadrature nodes of the lights
_NARROWEST, _WIDEST = 0.002, 0.8  # least and largest slopes that the nodes resolve
_LEAST_BODY = 1e-3  # share of the light: a model with a smaller diffuse part is a metal
_HIGHEST = 0.35  # reflectance of a dielectric at normal incidence, IOR 3.9; a higher one is in part a metal
_COLORS = np.linspace(0.0, 1.0, 65)  # base colors that are tried
_STEPS = np.geomspace(0.25, 3.0, 8)  # widths where searches start, in parts of the model's own width
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Principled(bsdf.Inputs):
    """The node's inputs, and `lobe_error` and `albedo_error` in % of the model's light."""

    lobe_error: float = 0.0
    albedo_error: float = 0.0


def fit(model, parameters: dict) -> Principled:
    """Principled's inputs for a model with `parameters` {id: value}. Raises ValueError for values that it refuses."""
    target = _Target(model, model.resolve(parameters))
    if not target.total.min() > 1e-9:  # a black model
        return Principled((0.0, 0.0, 0.0), 0.0, 1.0, ior=1.0)
    kinds = (_Body, _Mixed) if target.body.sum() > _LEAST_BODY * target.total.sum() else (_Metal,)
    return min((_Search(kind(target)) for kind in kinds), key=lambda search: search.error).refined()


def errors(model, parameters: dict, parts) -> tuple:
    """Errors (lobe, albedo) in % of Principled nodes that stand for a model with `parameters` {id: value}.

    `parts` are [(share, inputs)], see `fallback.parts`. Raises ValueError for values that the model refuses.
    """
    target = _Target(model, model.resolve(parameters))
    energy, albedo = np.zeros_like(target.energy), np.zeros_like(target.albedo)
    for share, inputs in parts:
        shares = share(target.mu)[:, None]
        energy += shares[target.seen] * bsdf.evaluate(inputs, target.view, target.light) * target.weight[:, None]
        albedo += shares * bsdf.albedo(inputs, target.mu)
    missed = target.by_view(np.abs(energy - target.energy)).sum(axis=1) + target.spike.sum(axis=1)
    sky = np.abs(albedo - target.albedo).sum(axis=1)
    return tuple(float(100.0 * (part / target.total).mean()) for part in (missed, sky))


# The target of the fit.

class _Target:
    """A model with resolved `values`, seen from several views.

    These have a row for each light: `view` and `light` (rows, 3), `energy` = f N·L dω (rows, 3), `weight` = N·L dω
    (rows,), and `seen` (rows,), the index of the view. These have a row for each view, (views, 3): `albedo`, its
    diffuse part `body`, and its perfect mirror `spike`. `total` (views,) is the albedo, channels added up.
    """

    def __init__(self, model, values):
        along, across = _stretch(model, values)
        self.ratio = min(along, across) / max(along, across)
        self.turn = 0.25 if across > along else 0.0
        turned = bool(model.axes) and "rotation" in values
        # A turned lobe is fitted without its turn, which is added to the result.
        self.rotation = ((values["rotation"] if turned else 0.0) + self.turn) % 1.0
        values = {**values, "rotation": 0.0} if turned else values
        self.width = _narrowest(model, values, self.ratio)
        self._evaluate_views(model, values)

    def _evaluate_views(self, model, values):
        views = view_at(np.cos(np.radians(VIEWS)))
        if self.ratio < 1.0:
            views = np.concatenate([views, views[1:, [1, 0, 2]]])
        self.mu = views[:, 2]
        # Lights of all views in one array.
        lights = [self._lights(model, view, values) for view in views]
        self.seen = np.repeat(np.arange(len(views)), [len(light) for light, _ in lights])
        self.light, self.weight = (np.concatenate(column) for column in zip(*lights, strict=True))
        self.view = views[self.seen]
        self.view_dot_half = dot(self.view, half(self.view, self.light))
        # The energy, and the albedos of surface, body and spike.
        surface = self.energy = self._energy(model, values)
        self.body = np.zeros((len(views), 3))
        if any(values.get("diffuse_color", ())):
            surface = self._energy(model, {**values, "diffuse_color": (0.0, 0.0, 0.0)})
            # Nodes made for a lobe have an error for Lambert's light. The body has the same, so their ratio is exact.
            self.body = self.by_view(self.energy - surface) / self.by_view(self.weight / np.pi)[:, None]
        spiky = getattr(model, "spike", None) is not None
        self.spike = model.spike(self.mu, values) if spiky else np.zeros_like(self.body)
        self.albedo = self.by_view(surface) + self.body + self.spike
        self.total = self.albedo.sum(axis=1)

    def _lights(self, model, view, values):
        """Lights (N, 3) seen from one view (3,), and their N·L dω (N,)."""
        if self.ratio < 1.0:
            return _stretched_lights(view, self.width / self.ratio, self.width, self.turn)
        one_sided = getattr(model, "mirrored", None) is None or model.mirrored(values)
        light, weight = quadrature.hemisphere_nodes(view, self.width, one_sided, _POLAR, _AZIMUTHAL)
        if not values.get("retro") or view[2] == 1.0:
            return light, weight
        # A retroreflective lobe has mirror images of the nodes about the mirror direction.
        chosen = light[:, 0] < 0.0
        return (np.concatenate([light[chosen], light[chosen] * [-1.0, 1.0, 1.0]]),
                np.concatenate([weight[chosen], weight[chosen]]))

    def _energy(self, model, values):
        return rgb(model.with_albedos(TABULATED).evaluate_fast(self.view, self.light, values)) * self.weight[:, None]

    def by_view(self, rows):
        """Sums of rows (rows, ...) over the lights of each view: (views, ...)."""
        return np.add.reduceat(rows, np.searchsorted(self.seen, np.arange(len(self.mu))))

    def lobe(self, roughness, anisotropic):
        """White GGX, f N·L dω, (rows,)."""
        along, across = bsdf.alphas(roughness, anisotropic)
        return bsdf.ggx(self.view, self.light, along, across, 2.0 * np.pi * self.turn) * self.weight


def _narrowest(model, values, ratio):
    """About the root mean square slope of the narrowest lobe's half vectors, along its short axis."""
    if not hasattr(model, "lumps"):
        width = np.sqrt(2.0 / max(appearance(model, values)[1], 1e-9))
    else:
        lumps = [lump for lump in model.lumps if not lump.retro or values[lump.share] > 0.0]
        width = ratio * min(max(values[name] for name in lump.radii) / np.sqrt(max(values[lump.exponent], 1e-9))
                            for lump in lumps)
    return float(np.clip(width, _NARROWEST, _WIDEST))


def _stretched_lights(view, along, across, turn):
    """Lights (N, 3) and N·L dω (N,) for a `view` (3,). Their half vectors are dense in an ellipse of these slopes."""
    # Polar nodes of the ellipse, in units of its axes.
    ends = np.append([0.0], np.geomspace(0.4, max(40.0 / along, 10.0), 11))
    x, w = np.polynomial.legendre.leggauss(3)
    r = (0.5 * (ends[1:] + ends[:-1]) + 0.5 * np.diff(ends) * x[:, None]).ravel()
    dr = (0.5 * np.diff(ends) * w[:, None]).ravel()
    count = 24 if across > 0.1 * along else 48
    phi = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    if turn:
        along, across = across, along
    # Slopes to half vectors, and these to lights.
    slopes = np.stack([along * np.outer(r, np.cos(phi)), across * np.outer(r, np.sin(phi))], axis=-1).reshape(-1, 2)
    z = 1.0 / np.sqrt(1.0 + dot(slopes, slopes))
    h = np.concatenate([slopes, np.ones((len(slopes), 1))], axis=1) * z[:, None]
    light = reflect(view[None], h)
    # dω_H is (N·H)³ times the area of slopes, and dω_L = 4 (V·H) dω_H.
    area = np.repeat(r * dr, count) * along * across * 2.0 * np.pi / count
    weight = area * z**3 * 4.0 * (h @ view) * light[:, 2]
    lit = (light[:, 2] > 1e-6) & (h @ view > 0.0)
    return light[lit], weight[lit]


def _stretch(model, values):
    """Widths (along, across) the tangent of a model's lobe, up to a common factor."""
    if getattr(model, "stretched", None) is not None:
        return model.stretched(values)
    if getattr(model, "lumps", ()):
        return tuple(values[name] for name in (model.lumps[0].radii * 2)[:2])
    return 1.0, 1.0


# The kinds of fits: each gives inputs for a roughness and one further number.

class _Metal:
    """A metal, which has no further number; the base of the kinds with a body."""

    # Start of the search for the further number, and the search's half width.
    start, reach = 1.0, None

    def __init__(self, target):
        self.target = target

    def at(self, roughness: float, further: float) -> Principled:
        """The best inputs with these two numbers."""
        target = self.target
        anisotropic = bsdf.anisotropic_of(target.ratio)
        seen, white = bsdf.Seen(target.mu, roughness), target.lobe(roughness, anisotropic)
        metallic, ior = self._mix(further)
        surface = seen.dielectric_albedo(ior)[:, None] if metallic < 1.0 else 0.0
        # The albedo of a stretched lobe, from its own energies.
        of = anisotropic and tuple(map(target.by_view, (white, white * (1.0 - target.view_dot_half) ** 5)))

        def albedo(color):
            return metallic * seen.metal_albedo(color, of) + (1.0 - metallic) * (surface + (1.0 - surface) * color)

        # The color from the albedo; with it the lobe, metal first.
        color = _color(albedo, target.albedo)
        energy = np.zeros_like(target.energy)
        if metallic > 0.0:
            scale = metallic * seen.scale(bsdf.schlick_mean(color))
            energy += white[:, None] * bsdf.schlick(target.view_dot_half, color) * scale[target.seen]
        if metallic < 1.0:
            scale = seen.scale(bsdf.dielectric_mean(ior))[target.seen, 0]
            coated = white * bsdf.dielectric(target.view_dot_half, ior) * scale
            below = (1.0 - surface)[target.seen] * color * (target.weight / np.pi)[:, None]
            energy += (1.0 - metallic) * (coated[:, None] + below)
        lobe, sky = self._errors(energy, albedo(color), roughness)
        return Principled(tuple(color.tolist()), metallic, roughness, ior, 0.5, anisotropic,
                          target.rotation if anisotropic else 0.0, 100.0 * lobe, 100.0 * sky)

    def _mix(self, further):
        """(metallic, IOR) for the further number."""
        return 1.0, 1.5

    def _errors(self, energy, albedo, roughness):
        target = self.target
        missed = target.by_view(np.abs(energy - target.energy)).sum(axis=1) + target.spike.sum(axis=1)
        if roughness <= bsdf.SMOOTHEST:  # a perfect mirror, which has the spike and misses the lobe
            missed = np.abs(albedo - target.spike).sum(axis=1) + (target.albedo - target.spike).sum(axis=1)
        sky = np.abs(albedo - target.albedo).sum(axis=1)
        return float((missed / target.total).mean()), float((sky / target.total).mean())


class _Body(_Metal):
    """A dielectric; the further number is the logarithm of its reflectance at normal incidence."""

    reach = 0.7

    def __init__(self, target):
        super().__init__(target)
        self.start = float(np.log(np.clip((target.albedo - target.body)[0].mean(), 1e-4, _HIGHEST)))

    def _mix(self, further):
        return 0.0, float(bsdf.ior_of(min(np.exp(further), _HIGHEST)))


class _Mixed(_Metal):
    """A metal and a dielectric of index 1.5 of one color; the further number is the metal's share."""

    reach = 0.25

    def __init__(self, target):
        super().__init__(target)
        body = target.body[0].mean() / target.total[0] * 3.0
        self.start = float(np.clip(1.0 - body, 0.05, 0.95))

    def _mix(self, further):
        return float(np.clip(further, 0.0, 1.0)), 1.5


def _color(albedo, target):
    """The colors (3,) for which `albedo(colors)`, (views, colors), is nearest to the `target` (views, 3).

    Logarithms are compared, at the first view and the third, 0 and 60 degrees.
    """
    tried = albedo(_COLORS)[[0, 2], :, None]
    target = target[[0, 2], None, :]
    miss = (np.log(np.maximum(tried, 1e-3) / np.maximum(target, 1e-3)) ** 2).sum(axis=0)  # (colors, 3)
    best = np.clip(miss.argmin(axis=0), 1, len(_COLORS) - 2)
    low, middle, high = (np.take_along_axis(miss, (best + step)[None], axis=0)[0] for step in (-1, 0, 1))
    # The lowest point of the parabola through three neighbors.
    shift = 0.5 * (low - high) / np.maximum(low - 2.0 * middle + high, 1e-30)
    return np.clip(_COLORS[best] + np.clip(shift, -1.0, 1.0) * _COLORS[1], 0.0, 1.0)


# The search.

class _Search:
    """The search for one kind's best inputs: `error` is that of the best of a few roughnesses, `refined` goes on."""

    def __init__(self, kind):
        target, self.kind = kind.target, kind
        along = target.width / target.ratio
        starts = np.sqrt(along * np.sqrt(max(target.ratio, bsdf.MOST_STRETCHED)) * _STEPS)  # roughness² is a width
        self.tried = np.unique(np.clip(starts, bsdf.SMOOTHEST, 1.0))
        if target.spike.any():
            self.tried = np.unique(np.append(self.tried, bsdf.SMOOTHEST))
        errors = [self._error(r, kind.start) for r in self.tried]
        self.best, self.error = int(np.argmin(errors)), min(errors)

    def _error(self, roughness, further):
        inputs = self.kind.at(roughness, further)
        return inputs.lobe_error + inputs.albedo_error

    def refined(self) -> Principled:
        """The best inputs: the roughness is refined, then the further number, then the roughness again."""
        tried, best, further, reach = self.tried, self.best, self.kind.start, self.kind.reach
        low, high = tried[max(best - 1, 0)], tried[min(best + 1, len(tried) - 1)]
        r = _lowest(lambda r: self._error(r, further), low, high, 7, (tried[best], self.error))
        if reach:
            further = _lowest(lambda x: self._error(r, x), further - reach, further + reach, 6)
            r = _lowest(lambda r: self._error(r, further), max(0.85 * r, bsdf.SMOOTHEST), min(1.15 * r, 1.0), 4)
        return self.kind.at(float(r), further)


def _lowest(error, low, high, steps, known=(0.0, np.inf)):
    """The number between `low` and `high` of the lowest `error`, by `steps` of the golden section.

    It is that of `known`, (number, error), if its error is lower.
    """
    inner = [high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)]
    values = [error(x) for x in inner]
    for _ in range(steps):
        if values[0] < values[1]:
            high, inner[1], values[1] = inner[1], inner[0], values[0]
            inner[0] = high - _GOLDEN * (high - low)
            values[0] = error(inner[0])
        else:
            low, inner[0], values[0] = inner[0], inner[1], values[1]
            inner[1] = low + _GOLDEN * (high - low)
            values[1] = error(inner[1])
    return min((values[0], inner[0]), (values[1], inner[1]), known[::-1])[1]
