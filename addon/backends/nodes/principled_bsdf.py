"""Blender's Principled BSDF as Cycles renders it, in NumPy: base color, metallic, roughness, IOR, anisotropic.

The BSDF is `metallic` times a metal plus (1 - `metallic`) times a dielectric. The metal is GGX with Schlick's factor
from the base color to white (the F82 tint is white). The dielectric is GGX with the exact reflectance of its IOR, over
a Lambertian body of the base color, which receives the light that the surface does not reflect.

GGX is Walter et al. 2007, stretched, with Smith's height-correlated masking (Heitz 2014). GGX loses the light of
multiple reflections. A factor of the view alone compensates the loss: Fms (1 - E) / E + 1,
Fms = Fss E_avg / (1 - Fss (1 - E_avg)) (Turquin 2019, after Kulla and Conty 2017). E is the white GGX's albedo at the
view and E_avg its mean over N·V dω/π, both of the round lobe. Fss is the mean reflectance, 20/21 F0 + 1/21 for
Schlick's factor.
"""
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...models.geometry import dot, half, reflect

SMOOTHEST = 0.02  # least roughness: Cycles renders roughnesses below 0.018 as a perfect mirror
MOST_STRETCHED = 0.1  # width across the tangent over width along it, at anisotropic 1
_GRID = 24  # numbers each way of an integral over the visible normals


@dataclass(frozen=True)
class Inputs:
    """The node's inputs, each in Blender's own range. `ior` has its physical reflectance while `specular` is 0.5."""

    base_color: tuple
    metallic: float
    roughness: float
    ior: float = 1.5
    specular: float = 0.5
    anisotropic: float = 0.0
    rotation: float = 0.0


def alphas(roughness: float, anisotropic: float) -> tuple:
    """GGX's widths (along, across) the tangent."""
    aspect = np.sqrt(1.0 - 0.9 * anisotropic)
    return roughness**2 / aspect, roughness**2 * aspect


def anisotropic_of(ratio: float) -> float:
    """The input for a lobe that is `ratio` (0..1) times as wide across the tangent as along it; at most 1."""
    return min(max((1.0 - ratio) / (1.0 - MOST_STRETCHED), 0.0), 1.0)


def evaluate(inputs: Inputs, view, light) -> np.ndarray:
    """f(V, L) in 1/sr, (N, 3), for unit vectors (N, 3) above the horizon."""
    value = np.zeros((len(view), 3))
    lobe = ggx(view, light, *alphas(inputs.roughness, inputs.anisotropic), 2.0 * np.pi * inputs.rotation)
    # Albedos depend on the view's cosine alone: each cosine is computed once.
    view_dot_half = dot(view, half(view, light))
    mu, index = np.unique(view[:, 2], return_inverse=True)
    seen = Seen(mu, inputs.roughness)
    # The metal, then the dielectric over its body.
    if inputs.metallic > 0.0:
        scale = seen.scale(schlick_mean(np.array(inputs.base_color)))[index]
        value += inputs.metallic * lobe[:, None] * schlick(view_dot_half, inputs.base_color) * scale
    if inputs.metallic < 1.0:
        ior = effective_ior(inputs)
        scale = seen.scale(dielectric_mean(ior))[index, 0]
        diffuse = (1.0 - seen.dielectric_albedo(ior))[index, None] * np.asarray(inputs.base_color) / np.pi
        surface = lobe * dielectric(view_dot_half, ior) * scale
        value += (1.0 - inputs.metallic) * (surface[:, None] + diffuse)
    return value


def albedo(inputs: Inputs, cos_theta) -> np.ndarray:
    """Albedo (N, 3) at N·V = `cos_theta` (N,). A stretched lobe has that of the round lobe."""
    seen = Seen(cos_theta, inputs.roughness)
    color = np.asarray(inputs.base_color, dtype=np.float64)
    surface = seen.dielectric_albedo(effective_ior(inputs))[:, None]
    return inputs.metallic * seen.metal_albedo(color) + (1.0 - inputs.metallic) * (surface + (1.0 - surface) * color)


def effective_ior(inputs: Inputs) -> float:
    """The index whose reflectance at normal incidence is 2 `specular` times that of `ior`."""
    return ior_of(min(2.0 * inputs.specular * reflectance_of(inputs.ior), 0.9999))


def reflectance_of(ior):
    """Reflectance, 0..1, of an index at normal incidence."""
    return ((ior - 1.0) / (ior + 1.0)) ** 2


def ior_of(reflectance):
    """The index, 1 or more, with a `reflectance` from 0 to less than 1 at normal incidence."""
    return (1.0 + np.sqrt(reflectance)) / (1.0 - np.sqrt(reflectance))


# GGX.

def ggx(view, light, along, across, turn=0.0) -> np.ndarray:
    """D G / (4 (N·L)(N·V)) in 1/sr, (N,), for unit vectors (N, 3) above the horizon.

    The widths are `along` and `across` a tangent, which is x turned by `turn` radians.
    """
    h = half(view, light)
    if along == across:
        stretched = (h[:, 0] ** 2 + h[:, 1] ** 2) / along**2 + h[:, 2] ** 2
    else:
        c, s = np.cos(turn), np.sin(turn)
        stretched = ((c * h[:, 0] + s * h[:, 1]) / along) ** 2 + ((c * h[:, 1] - s * h[:, 0]) / across) ** 2 \
            + h[:, 2] ** 2
    d = 1.0 / (np.pi * along * across * stretched**2)
    masking = 1.0 + _lambda(view, along, across, turn) + _lambda(light, along, across, turn)
    return d / (4.0 * view[:, 2] * light[:, 2] * masking)


def _lambda(v, along, across, turn):
    c, s = np.cos(turn), np.sin(turn)
    x, y = along * (c * v[..., 0] + s * v[..., 1]), across * (c * v[..., 1] - s * v[..., 0])
    return 0.5 * (np.sqrt(1.0 + (x * x + y * y) / np.maximum(v[..., 2], 1e-9) ** 2) - 1.0)


# Reflectances.

def schlick(cosine, color) -> np.ndarray:
    """Schlick's factor from `color` (3,) at normal incidence to 1 at grazing, (N, 3), for V·H = `cosine` (N,)."""
    return np.asarray(color) + (1.0 - np.asarray(color)) * ((1.0 - cosine) ** 5)[:, None]


def dielectric(cosine, ior: float) -> np.ndarray:
    """Exact unpolarized reflectance of an index of 1 or more, in the shape of `cosine`, V·H."""
    g = np.sqrt(np.maximum(ior * ior - 1.0 + cosine * cosine, 1e-30))
    a, b = (g - cosine) / (g + cosine), ((g + cosine) * cosine - 1.0) / ((g - cosine) * cosine + 1.0)
    return 0.5 * a * a * (1.0 + b * b)


def schlick_mean(color):
    """Mean of Schlick's factor over 2 cosθ d cosθ."""
    return (20.0 * color + 1.0) / 21.0


def dielectric_mean(ior: float) -> np.ndarray:
    """Mean reflectance over 2 cosθ d cosθ, (1,), by the fit that Cycles uses (Kulla and Conty 2017)."""
    return np.array([(ior - 1.0) / (4.08567 + 1.00071 * ior)])


# Albedos: integrals over the visible normals, all with the same numbers.

class Seen:
    """Round GGX of a `roughness`, seen from the views at N·V = `mu` (views,).

    `white` (views,) is the albedo of the white lobe, and `edge` (views,) that of its part (1 - V·H)^5.
    """

    def __init__(self, mu, roughness: float):
        self.roughness = roughness
        self.cosine, self.weight = seen_normals(np.asarray(mu, dtype=np.float64), roughness**2)
        self.white = self.weight.sum(axis=1)
        self.edge = (self.weight * (1.0 - self.cosine) ** 5).sum(axis=1)

    def scale(self, mean):
        """The factor (views, C) that compensates lost light, for a metal or dielectric of `mean` reflectance (C,)."""
        average = mean_albedo(self.roughness)
        multiple = mean * average / (1.0 - mean * (1.0 - average))
        return 1.0 + multiple * ((1.0 - self.white) / self.white)[:, None]

    def metal_albedo(self, color, of=None):
        """Albedo (views, C) of a metal of the base colors `color` (C,).

        `of` are `white` and `edge` of a stretched lobe. The compensation is that of the round lobe all the same.
        """
        white, edge = (sums[:, None] for sums in of or (self.white, self.edge))
        return (white * color + edge * (1.0 - color)) * self.scale(schlick_mean(color))

    def dielectric_albedo(self, ior: float):
        """Albedo (views,) of a dielectric's surface."""
        single = (self.weight * dielectric(self.cosine, ior)).sum(axis=1)
        return single * self.scale(dielectric_mean(ior))[:, 0]


def seen_normals(mu, alpha: float):
    """(V·H, weights), both (views, normals), of round GGX of width `alpha` at N·V = `mu` (views,).

    The weights sum to the white albedo. The normals are samples of the visible normals (Heitz 2018) at the middles of
    an even grid of numbers, so that every width needs as many. A weight is G / G_1 over their count where the light is
    above the horizon, and 0 elsewhere.
    """
    middle = (np.arange(_GRID) + 0.5) / _GRID
    # Points of the unit disk, dense towards the rim: the part of a narrow lobe below the horizon lies there.
    inward = np.repeat(1.0 - middle, _GRID)
    r, share = np.sqrt(1.0 - inward**3), 3.0 * inward**2
    phi = np.pi * np.tile(middle, _GRID)  # one side; the other is its mirror image
    # The view, stretched so that GGX becomes a hemisphere.
    view = np.stack([np.sqrt(np.maximum(1.0 - mu * mu, 0.0)), np.zeros_like(mu), np.maximum(mu, 1e-6)], axis=-1)
    warped = view * [alpha, alpha, 1.0]
    warped /= np.linalg.norm(warped, axis=1, keepdims=True)
    x, y, z = warped[:, :1], warped[:, 1:2], warped[:, 2:]
    # The disk's points on the hemisphere: one axis of the disk is y, the other leans with the view.
    first, second = r * np.sin(phi), r * np.cos(phi)
    lean = 0.5 * (1.0 + z)
    second = (1.0 - lean) * np.sqrt(np.maximum(1.0 - first**2, 0.0)) + lean * second
    up = np.sqrt(np.maximum(1.0 - first**2 - second**2, 0.0))
    # The normals, and their lights.
    normal = np.stack([alpha * (up * x - second * z), alpha * (first + 0.0 * x + 0.0 * y),
                       np.maximum(up * z + second * x, 1e-9)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    light = reflect(view[:, None, :], normal)
    cosine = np.clip(dot(view[:, None, :], normal), 0.0, 1.0)
    # Masking and shadowing.
    toward, away = _lambda(view, alpha, alpha, 0.0)[:, None], _lambda(light, alpha, alpha, 0.0)
    weight = np.where(light[..., 2] > 0.0, (1.0 + toward) / (1.0 + toward + away), 0.0)
    return cosine, weight * share / share.sum()


def mean_albedo(roughness: float) -> float:
    """E_avg of white GGX, interpolated linearly between 33 roughnesses."""
    nodes, values = _mean_albedos()
    return float(np.interp(roughness, nodes, values))


@lru_cache(maxsize=1)
def _mean_albedos():
    x, w = np.polynomial.legendre.leggauss(12)
    mu = 0.5 * (x + 1.0)
    nodes = np.linspace(0.0, 1.0, 33)
    return nodes, np.array([(w * mu * seen_normals(mu, max(node**2, 1e-6))[1].sum(axis=1)).sum() for node in nodes])
