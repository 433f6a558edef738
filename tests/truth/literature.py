"""The literature's formulas for one view and one light, written again from the sources in scalar arithmetic.

`v` and `light` are unit vectors, `p` a model's parameters by id; a formula returns f in 1/sr.
"""
import math
from functools import lru_cache

import numpy as np
from scipy import ndimage, optimize, special

from addon.forms.albedo import tables
from addon.models import exr


def half_of(v, light):
    h = [a + b for a, b in zip(v, light, strict=True)]
    length = math.sqrt(sum(a * a for a in h))
    return [a / length for a in h]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def ward_peak(v, light, p):
    h = half_of(v, light)
    delta, phi = math.acos(min(h[2], 1.0)), math.atan2(h[1], h[0])
    along = math.cos(phi) ** 2 / p["roughness_u"] ** 2 + math.sin(phi) ** 2 / p["roughness_v"] ** 2
    return math.exp(-math.tan(delta) ** 2 * along) / (4.0 * math.pi * p["roughness_u"] * p["roughness_v"])


def bounded(v, light, p):
    """The form with H not of unit length, 1/(pi m_x m_y) exp(..) (H·H)/(H·N)^4."""
    h = [a + b for a, b in zip(v, light, strict=True)]
    return 4.0 * ward_peak(v, light, p) * dot(h, h) / h[2] ** 4


def grooves(v, light):
    h = half_of(v, light)
    return min(1.0, 2.0 * h[2] * v[2] / dot(v, h), 2.0 * h[2] * light[2] / dot(v, h))


def cook_torrance(v, light, p):
    m, cos_h = p["roughness"], half_of(v, light)[2]
    d = math.exp(-(math.tan(math.acos(min(cos_h, 1.0))) / m) ** 2) / (math.pi * m * m * cos_h**4)
    return d * grooves(v, light) / (4.0 * v[2] * light[2])


def cosine_microfacet(v, light, p):
    m = p["exponent"]
    return (m + 2.0) / (8.0 * math.pi) * half_of(v, light)[2] ** m * grooves(v, light) / (v[2] * light[2])


def he_torrance(v, light, p):
    """Eq. 76 to 82 in the paper's vectors; erfc and the root of eq. 81 are SciPy's."""
    sigma, tau, wavelength = p["sigma"], p["tau"], p["wavelength"]
    k_r, k_i = np.array(v), -np.array(light)  # the wave travels towards the surface
    cot = [x[2] / math.hypot(x[0], x[1]) for x in (v, light)]

    def k(c):
        return math.tan(math.atan(1.0 / c)) * special.erfc(tau * c / (2.0 * sigma))

    mean = 0.25 * (k(cot[0]) + k(cot[1]))
    z0 = optimize.brentq(lambda z: math.sqrt(math.pi / 2.0) * z - sigma * mean * math.exp(-0.5 * (z / sigma) ** 2),
                         0.0, 40.0 * sigma * (1.0 + mean), xtol=1e-15, rtol=1e-14)
    effective = sigma / math.sqrt(1.0 + (z0 / sigma) ** 2)
    g = (2.0 * math.pi * effective / wavelength * (v[2] + light[2])) ** 2
    wave = 2.0 * math.pi / wavelength * (k_r - k_i)
    across2 = wave[0] ** 2 + wave[1] ** 2
    m = np.arange(1, int(g + 12.0 * math.sqrt(g) + 60.0))
    series = np.exp(m * math.log(g) - g - across2 * tau * tau / (4.0 * m) - special.gammaln(m + 1.0)) / m
    d = math.pi**2 * tau**2 / (4.0 * wavelength**2) * series.sum()
    n = np.array([0.0, 0.0, 1.0])
    s_i, s_r = np.cross(k_i, n), np.cross(k_r, n)
    s_i, s_r = s_i / np.linalg.norm(s_i), s_r / np.linalg.norm(s_r)
    p_i, p_r = np.cross(s_i, k_i), np.cross(s_r, k_r)
    along = k_r - k_i
    geometry = ((along @ along) / along[2]) ** 2  # in units of the wave number, otherwise f has a dimension
    geometry *= ((s_r @ k_i) ** 2 + (p_r @ k_i) ** 2) * ((s_i @ k_r) ** 2 + (p_i @ k_r) ** 2)
    geometry /= np.linalg.norm(np.cross(k_r, k_i)) ** 4

    def s(c):
        x = tau * c / (2.0 * sigma)
        big = 0.5 * (2.0 / math.sqrt(math.pi) * sigma / (tau * c) * math.exp(-x * x) - special.erfc(x))
        return (1.0 - 0.5 * special.erfc(x)) / (big + 1.0)

    return geometry * s(cot[0]) * s(cot[1]) * d / (math.pi * v[2] * light[2])


def embrechts(v, light, p):
    s, cos_b = p["smoothness"], half_of(v, light)[2]

    def masking(c):
        a = s * c / math.sqrt(1.0 - c * c)
        return 2.0 / (1.0 + special.erf(a) + math.exp(-a * a) / (a * math.sqrt(math.pi)))

    c = s * s / (4.0 * math.pi) * masking(v[2]) * masking(light[2])
    return p["scattering"] * c * math.exp(-(s * math.tan(math.acos(cos_b))) ** 2) / (light[2] * v[2] * cos_b**4)


def ashikhmin_shirley(v, light, p):
    nu, nv, h = p["exponent_u"], p["exponent_v"], half_of(v, light)
    power = (nu * h[0] ** 2 + nv * h[1] ** 2) / (1.0 - h[2] ** 2)
    return (math.sqrt((nu + 1.0) * (nv + 1.0)) / (8.0 * math.pi) * h[2] ** power
            / (dot(h, light) * max(v[2], light[2])))


def lafortune(v, light, p):
    total = 0.0
    for i in (1, 2, 3):
        n, c = p[f"exponent_{i}"], (p[f"cxy_{i}"], p[f"cxy_{i}"], p[f"cz_{i}"])
        total += p[f"weight_{i}"] * (n + 2.0) / (2.0 * math.pi) * max(
            sum(a * b * d for a, b, d in zip(c, v, light, strict=True)), 0.0) ** n
    return total


def phong_original(v, light, p):
    return max(dot([-v[0], -v[1], v[2]], light), 0.0) ** p["exponent"]


def blinn_original(v, light, p):
    return half_of(v, light)[2] ** p["exponent"]


@lru_cache(maxsize=1)
def star():
    """The shipped image, row 0 at the bottom, and its integral over the hemisphere from 4e6 half vectors."""
    pixels = exr.read(tables.PACKAGED / "ndf_star.exr")[0][::-1, :, 1].astype(np.float64)
    # Rings are narrow near the normal, where the image is bright.
    edges = np.linspace(0.0, 0.5 * np.pi, 2001)
    z, phi = 0.5 * (np.cos(edges[1:]) + np.cos(edges[:-1])), np.arange(2000) * np.pi / 1000.0
    s = np.sqrt(1.0 - z * z)
    mean = ndimage.map_coordinates(pixels, [np.outer(s, f(phi)) * 64.0 + 63.5 for f in (np.sin, np.cos)], order=1,
                                   mode="nearest").mean(axis=1)
    return pixels, 2.0 * np.pi * float(mean @ -np.diff(np.cos(edges)))


def ndf_map(v, light, p):
    """Ashikhmin and Shirley's form with the star image, bilinear between pixels' centers, over the image's integral."""
    pixels, total = star()
    h, turn = half_of(v, light), 2.0 * math.pi * p["rotation"]
    x, y = (min(max(64.0 * (a + 1.0) - 0.5, 0.0), 127.0) for a in (math.cos(turn) * h[0] + math.sin(turn) * h[1],
                                             math.cos(turn) * h[1] - math.sin(turn) * h[0]))
    i, j = min(int(x), 126), min(int(y), 126)
    density = sum((1.0 - abs(x - k)) * (1.0 - abs(y - n)) * pixels[n, k] for k in (i, i + 1) for n in (j, j + 1))
    return density / total / (4.0 * dot(v, h) * max(v[2], light[2]))


def kajiya_kay(v, light, p):
    """A power of the cosine between V and the cone of mirrored light, times the light that a strand receives."""
    to_strand = abs(math.asin(light[0]) + math.asin(v[0]))
    value = max(math.cos(to_strand), 0.0) ** p["exponent"] * math.cos(math.asin(light[0]))
    return value * ((p["exponent"] + 2.0) / (2.0 * math.pi) if p["normalized"] else 1.0) / light[2]

FORMULA = {
    "ward": lambda v, light, p: ward_peak(v, light, p) / math.sqrt(v[2] * light[2]),
    "ward_duer": lambda v, light, p: ward_peak(v, light, p) / (v[2] * light[2]),
    "ward_bounded": bounded, "cook_torrance": cook_torrance, "cosine_microfacet": cosine_microfacet,
    "he_torrance": he_torrance, "embrechts": embrechts, "ashikhmin_shirley": ashikhmin_shirley, "lafortune": lafortune,
    "phong_original": phong_original, "blinn_original": blinn_original, "kajiya_kay": kajiya_kay,
    "ndf_map": ndf_map,
    "blinn_fresnel": lambda v, light, p: (p["exponent"] + 8.0) / (8.0 * math.pi) * blinn_original(v, light, p),
    "weighted_lobes": lambda v, light, p: sum(
        p[f"weight_{i}"] * (p[f"exponent_{i}"] + 8.0) / (8.0 * math.pi) * half_of(v, light)[2] ** p[f"exponent_{i}"]
        for i in (1, 2, 3)),
}


def by_hand(name, v, light, p):
    """f (3,) in 1/sr of the model `name`: the formula above times its color, plus its diffuse part."""
    # The color, by Schlick's approximation where the model has Fresnel's effect.
    base, diffuse = np.array(p["base_color"]), np.array(p["diffuse_color"])
    color = base
    if name == "ashikhmin_shirley" or p.get("fresnel_type") == 1:
        edge = np.array(p.get("f90", (1.0, 1.0, 1.0)))
        color = base + (edge - base) * (1.0 - dot(v, half_of(v, light))) ** 5
    # The diffuse part's f, Lambert's unless the model has its own.
    amount = 1.0 / math.pi
    if name == "ashikhmin_shirley":
        amount = 28.0 / (23.0 * math.pi) * (1.0 - base) * math.prod(
            1.0 - (1.0 - 0.5 * x[2]) ** 5 for x in (v, light))
    if name == "kajiya_kay":
        amount = math.cos(math.asin(light[0])) / (math.pi * light[2])
    return FORMULA[name](v, light, p) * color + diffuse * amount
