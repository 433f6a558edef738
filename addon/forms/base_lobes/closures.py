"""The closures of base lobes, as Cycles evaluates them, and the families of models that share them.

Most base lobes are `phong_ramp`. Its eight colors make it any function of the distance from its axis, and Cycles allows
negative colors, so a few ramps about the mirror direction follow nearly any lobe.
"""
from dataclasses import dataclass

import numpy as np

from ...models.lobes import BLINN, PHONG
from ...models.microfacet import beckmann_lambda
from ..closures import (
    CREASE_COSINE,
    CREASE_LEAN,
    GRAZING_WIDTH,
    LEAN_DOWN,
    LEAN_MARGIN,
    LEAN_UP,
    LEANEST,
    LEVELS,
    PHONG_PER_HALF,
    SHARPEST,
    VIEW_SLOPE_SHARE,
)

GRAZING = 0.3  # height of the mean of N·L over a lobe at grazing above N·V, in the lobe's widths
FEATURES = (0.0, 0.8, 2.5)  # angles from the mirror direction to the normal where the gain is read, in widths
HIGHEST = 1e5  # exponent at v = 0
STEEPEST = np.radians(89.9)  # angle of the steepest view


@dataclass(frozen=True)
class Ramp:
    """phong_ramp about the mirror direction turned by `lean` s towards the normal, and by `side` s out of the plane.

    s = 1 / sqrt(m) is the lobe's width in radians, and m * `sharp` the closure's exponent. With a `side` there are two
    closures of the same colors, one on each side. Colors are in units of 1 / mean N·L, as the closure has a cosine
    factor.

    The closure is smooth between two colors, and may have a kink at a color, on a circle about its axis. A target has a
    kink of its own, a crease, on the circle N·L = N·V about the normal. `crease` is the index of a color, or 0. With it
    the axis leans at most to the normal, and the exponent is that for which the color's circle goes through the mirror
    direction. Within `lean` widths of the normal the circle is the whole crease.
    """

    lean: float
    sharp: float = 1.0
    side: float = 0.0
    crease: int = 0

    @property
    def sides(self):
        """`side` of each closure."""
        return (-self.side, self.side) if self.side else (0.0,)


@dataclass(frozen=True)
class Facet:
    """Beckmann microfacets about the normal turned by `lean` s towards the view, alpha^2 = 2 / (4 m sharp), at most 1.

    They are as oblong as a half-vector lobe, which round lobes follow badly at grazing. Weights are in units of the
    mean N·L, and cannot be negative.
    """

    lean: float
    sharp: float


@dataclass(frozen=True)
class Family:
    """The closures for all models of one lobe.

    With `plain`, phong_ramp itself is f_0 (N·L), and only the difference is fitted. There are `u_nodes` times `v_nodes`
    nodes, even in v = n^-power and in u = (w / (1 + w) + theta / (pi/2)) / 2, w = tan(theta) / sqrt(m). The slope at
    the crease, in parts of the lobe's width, depends on w, and the lobe's shape around the crease on theta. `ridge` is
    the penalty of the squares of coefficients: with it those of neighboring nodes are similar, and may be interpolated.
    """

    lobe: object
    ramps: tuple
    facets: tuple
    plain: bool
    u_nodes: int
    v_nodes: int
    power: float
    ridge: float

    def phong_exponent(self, n):
        """Exponent m of the Phong lobe of equal width."""
        return n if self.lobe is PHONG else PHONG_PER_HALF * n

    def width(self, mu_view, n):
        """Least width of the lobe in radians: across the plane of incidence a half-vector lobe's shrinks with N·V."""
        s = 1.0 / np.sqrt(self.phong_exponent(n))
        return s if self.lobe is PHONG else s * min(mu_view + GRAZING_WIDTH * s, 1.0)

    @property
    def columns(self):
        """Number of coefficients of one gain: the ramps' colors, then the facets' weights."""
        return LEVELS * len(self.ramps) + len(self.facets)


FAMILIES = {
    "phong": Family(PHONG, (Ramp(0.0), Ramp(0.0, 2.0, 1.0), Ramp(0.45), Ramp(0.7, crease=5)), (),
                    plain=True, u_nodes=25, v_nodes=17, power=0.5, ridge=1e-7),
    "blinn": Family(BLINN, (Ramp(0.0, 1.5), Ramp(0.5), Ramp(-0.25, 4.0), Ramp(0.25, 2.0), Ramp(1.2),
                            Ramp(1.0, crease=3)), (Facet(0.0, 1.0), Facet(0.1, 1.25)),
                    plain=False, u_nodes=28, v_nodes=33, power=0.25, ridge=1.5e-5),
}


def axis_of(ramp: Ramp, theta, m):
    """(lean of the axis in radians, exponent of the closure) for a view at `theta`, 0..pi/2.

    `m` is the exponent of the Phong lobe of equal width, 1/4 or more. The lean is limited near the horizons: Cycles
    bends closures that mirror into the surface.
    """
    s, height = 1.0 / np.sqrt(m), 0.5 * np.pi - theta
    if not ramp.crease:
        lean = np.clip(ramp.lean * s, -LEAN_DOWN * max(height - LEAN_MARGIN, 0.0), np.pi - height - LEAN_UP)
        return lean, m * ramp.sharp
    lean = max(min(ramp.lean * s, theta), CREASE_LEAN * s)
    return lean, min(np.log(ramp.crease / (LEVELS - 1)) / np.log(max(np.cos(lean), CREASE_COSINE)), SHARPEST)


def ramp(ramp: Ramp, view, light, m):
    """Value (N, LEVELS) of a phong_ramp (N·L included) per color, in units of 1 / mean N·L; view (3,), lights (N, 3).

    (e+2)/(2 pi) (R·L)^e (N'·L) times the color at (R·L)^e, which Cycles interpolates between LEVELS equidistant ones.
    """
    s, theta = 1.0 / np.sqrt(m), np.arctan2(view[0], view[2])
    lean, e = axis_of(ramp, theta, m)
    # With `crease` the exponent is large where the circle is small: scaled colors have the same effect.
    height = (m if ramp.crease else e) + 2.0
    total = 0.0
    for side in ramp.sides:
        turn = np.cos(side * s)
        axis = np.array([turn * np.sin(lean - theta), np.sin(side * s), turn * np.cos(lean - theta)])
        facet = (axis + view) / np.linalg.norm(axis + view)
        power = np.maximum(light @ axis, 0.0) ** e
        # The linear interpolation between colors: a hat function for each.
        hats = np.maximum(1.0 - np.abs((LEVELS - 1) * power[:, None] - np.arange(LEVELS)), 0.0)
        total = total + (height / (2.0 * np.pi) * power * np.maximum(light @ facet, 0.0))[:, None] * hats
    return total / (view[2] + GRAZING * s)


def facet(facet: Facet, view, light, m):
    """Value (N,) of a Beckmann closure (N·L included) times the mean N·L; unit vectors view (3,), lights (N, 3).

    D G2 / (4 N'·V), Walter et al. 2007, eq. 20 and 25, with the fit of `beckmann_lambda`. `m` is as in `axis_of`.
    """
    s = 1.0 / np.sqrt(m)
    alpha2 = min(0.5 / (m * facet.sharp), 1.0)
    lean = min(facet.lean * s, LEANEST / s)
    normal = np.array([np.sin(lean), 0.0, np.cos(lean)])
    h = light + view
    cos_h = np.maximum(h @ normal / np.maximum(np.linalg.norm(h, axis=1), 1e-12), 1e-6)
    nl, nv = light @ normal, max(normal @ view, 1e-6)
    density = np.exp((1.0 - cos_h**-2) / alpha2) / (np.pi * alpha2 * cos_h**4)
    shadowing = 1.0 + _lambda(alpha2, np.maximum(nl, 1e-9)) + _lambda(alpha2, nv)
    return np.where(nl > 0.0, density / (4.0 * nv * shadowing), 0.0) * (view[2] + GRAZING * s)


def _lambda(alpha2, cosine):
    return beckmann_lambda(alpha2 * np.maximum(1.0 / np.square(cosine) - 1.0, 0.0))


def columns(family: Family, view, light, m):
    """Values (N·L included) of all closures per coefficient, (N, family.columns); view (3,), lights (N, 3)."""
    ramps = [ramp(r, view, light, m) for r in family.ramps]
    return np.concatenate(ramps + [facet(f, view, light, m)[:, None] for f in family.facets], axis=1)


def view_of(family: Family, u, v):
    """(view (3,), exponent 1..HIGHEST) of the node at the coordinates `u` and `v`, both 0..1, see `Family`."""
    n = min(max(v, 1e-3) ** (-1.0 / family.power), HIGHEST)
    theta = np.linspace(0.0, STEEPEST, 10001)
    # u is inverted by interpolation. The values are even in theta, and besides even in w / (1 + w).
    w = np.linspace(0.0, 0.9999, 10001)
    theta = np.union1d(theta, np.minimum(np.arctan(w / (1.0 - w) * np.sqrt(family.phong_exponent(n))), STEEPEST))
    theta = np.interp(u, view_coordinate(family, theta, n), theta)
    return np.array([np.sin(theta), 0.0, np.cos(theta)]), n


def view_coordinate(family: Family, theta, n):
    """The coordinate u, 0..1, of a view at `theta` in radians, see `Family`."""
    w = np.tan(theta) / np.sqrt(family.phong_exponent(n))
    return VIEW_SLOPE_SHARE * w / (1.0 + w) + theta / np.pi


def feature_cosines(family: Family, theta, n):
    """The cosines M at which a shader reads the gain, shape (FEATURES,); the first is N·V."""
    return np.cos(np.maximum(theta - np.array(FEATURES) / np.sqrt(family.phong_exponent(n)), 0.0))
