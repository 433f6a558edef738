"""Base lobes: what a shader hands to Cycles as closures of its own, which together are nearly the target.

The estimator (see `osl/include/estimator.h`) adds what the base leaves over, of either sign, so the base decides noise,
blur and cost, and hardly the mean. Most of it is `phong_ramp`: its eight colours make it any function of the distance
from its axis, and Cycles lets them be negative, so a few of them about the mirror direction follow nearly any lobe.

A target is f_0 gain(M) min(1, N·L / N·V) with M = max(N·L, N·V) and gain(M) = M / D(M). The colours are linear in the
gain at a few cosines M (`FEATURES`), with coefficients that depend on the view angle and the exponent. Scaled by the
lobe's width 1 / sqrt(m), m being the exponent of the equivalent Phong lobe, they change slowly with both; the shader
interpolates between nodes of u, which stands for the view (see `Family`), and v, a power of n. At each node linear
least squares find the coefficients whose remainder gives the estimator least variance, for all gains in `GAINS`. That
no sample be negative, it counts besides how far the base is below zero, and how far above the target beyond what holes
take away, both squared: a convex problem, which a few rounds solve, each with the weights that the last one calls for.
"""
import json
from dataclasses import asdict, dataclass

import numpy as np

from ..brdf import MODELS, tables
from ..brdf.lobes import BLINN, PHONG
from ..brdf.tabulated import TABULATED
from .files import replace_text
from .workers import mapped

FILE = "base_lobes.json"

DRAWN = 0.6  # exponent of the lobe that splats are drawn from, in parts of n: wider, as what is left over is
FAINTEST = 1e-3  # of that lobe's peak, added to it: far out on the lobe nothing is ever drawn
GRAZING = 0.3  # of the lobe's scale: how far the mean of N·L over a lobe at grazing lies above N·V
HOLE = 0.4  # radius of the widest holes, which are splats that take away, in parts of the lobe's width
HOLE_EDGE = 1.3  # where a hole ends, in parts of its radius: above the horizon
ABOVE, BELOW = 30.0, 1e4  # what more it counts to be above the target by more than holes take away, and below zero
ROUNDS = 8
HORIZON = 48  # lights on the horizon
FEATURES = (0.0, 0.8, 2.5)  # widths from the mirror direction towards the normal where the gain is read
HIGHEST = 1e5  # exponent at v = 0
LEVELS = 8  # colours of a phong_ramp
STEEPEST = np.radians(89.9)  # view
LEANEST = 0.02  # lean of a facet times the lobe's width: before Blender 5, Cycles lights them from below the horizon
SHARPEST = 5e5  # exponent of a crease's phong_ramp: single precision knows no more

# (pumps, control): whose gains the coefficients are made for; None is the limit, whose gain is 1.
GAINS = (None, (0.0, False), (0.5, True), (2.0, False), (4.0, False))


@dataclass(frozen=True)
class Ramp:
    """phong_ramp about the mirror direction turned by `lean` s towards the normal, and by `side` s out of the plane.

    s = 1 / sqrt(m) is the lobe's width in radians, m * `sharp` the closure's exponent. With `side`, there are two,
    one on each side, of the same colours. Colours count in units of 1 / mean N·L: the closure carries a cosine.

    Between two colours the closure is smooth, and at a colour it may have a kink, on a circle about its axis. A target
    has its own kink, a crease, on the circle N·L = N·V about the normal. With `crease` the axis leans no further than
    to the normal, and the exponent is the one that lays that colour's circle through the mirror direction: up to `lean`
    widths from the normal, along the whole crease.
    """

    lean: float
    sharp: float = 1.0
    side: float = 0.0
    crease: int = 0

    @property
    def sides(self):
        return (-self.side, self.side) if self.side else (0.0,)


@dataclass(frozen=True)
class Facet:
    """Beckmann microfacets about the normal turned by `lean` s towards the view, alpha^2 = 2 / (4 m sharp), at most 1.

    They are as oblong as a half-vector lobe, which round lobes follow badly at grazing. Weights, which cannot be
    negative, count in units of the mean N·L.
    """

    lean: float
    sharp: float


@dataclass(frozen=True)
class Family:
    """The closures that serve all models of one lobe.

    With `plain`, phong_ramp itself is f_0 (N·L), and only the rest is fitted. Nodes are even in v = n^-power and in
    u = (w / (1 + w) + theta / (pi/2)) / 2, w = tan(theta) / sqrt(m): the slope at the crease, in parts of the lobe's
    width, goes with w, and the shape of what is around it with theta. `ridge` counts on the squares of coefficients:
    those of neighbouring nodes then go together, and may be blended.
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
        """Exponent m of the Phong lobe that is as wide."""
        return n if self.lobe is PHONG else 0.25 * n

    def width(self, mu_view, n):
        """Width of the lobe where it is narrowest, in radians: a half-vector lobe's shrinks with N·V, across."""
        s = 1.0 / np.sqrt(self.phong_exponent(n))
        return s if self.lobe is PHONG else s * min(mu_view + 0.15 * s, 1.0)

    @property
    def columns(self):
        """Coefficients of one gain: the ramps' colours, then the facets' weights."""
        return LEVELS * len(self.ramps) + len(self.facets)


FAMILIES = {
    "phong": Family(PHONG, (Ramp(0.0), Ramp(0.0, 2.0, 1.0), Ramp(0.45), Ramp(0.7, crease=5)), (),
                    plain=True, u_nodes=25, v_nodes=17, power=0.5, ridge=1e-7),
    "blinn": Family(BLINN, (Ramp(0.0, 1.5), Ramp(0.5), Ramp(-0.25, 4.0), Ramp(0.25, 2.0), Ramp(1.2),
                            Ramp(1.0, crease=3)), (Facet(0.0, 1.0), Facet(0.1, 1.25)),
                    plain=False, u_nodes=28, v_nodes=33, power=0.25, ridge=1.5e-5),
}


def axis_of(ramp: Ramp, theta, m):
    """(angle by which the axis leans in radians, exponent) for a view at `theta`.

    Leaning is held back near the horizons: Cycles bends closures that mirror into the surface.
    """
    s, height = 1.0 / np.sqrt(m), 0.5 * np.pi - theta
    if not ramp.crease:
        return np.clip(ramp.lean * s, -0.6 * max(height - 0.03, 0.0), np.pi - height - 0.3), m * ramp.sharp
    lean = max(min(ramp.lean * s, theta), 0.1 * s)
    return lean, min(np.log(ramp.crease / (LEVELS - 1)) / np.log(max(np.cos(lean), 0.03)), SHARPEST)


def ramp(ramp: Ramp, view, light, m):
    """Value (N, LEVELS) of a phong_ramp (N·L included) per colour, in units of 1 / mean N·L; view (3,), lights (N, 3).

    (e+2)/(2 pi) (R·L)^e (N'·L) times the colour at (R·L)^e, which Cycles interpolates between LEVELS equidistant ones.
    """
    s, theta = 1.0 / np.sqrt(m), np.arctan2(view[0], view[2])
    lean, e = axis_of(ramp, theta, m)
    # With `crease` the exponent is large where the circle is small: the colours are scaled to be of the same effect.
    height = (m if ramp.crease else e) + 2.0
    total = 0.0
    for side in ramp.sides:
        turn = np.cos(side * s)
        axis = np.array([turn * np.sin(lean - theta), np.sin(side * s), turn * np.cos(lean - theta)])
        facet = (axis + view) / np.linalg.norm(axis + view)
        power = np.maximum(light @ axis, 0.0) ** e
        hats = np.maximum(1.0 - np.abs((LEVELS - 1) * power[:, None] - np.arange(LEVELS)), 0.0)
        total = total + (height / (2.0 * np.pi) * power * np.maximum(light @ facet, 0.0))[:, None] * hats
    return total / (view[2] + GRAZING * s)


def facet(facet: Facet, view, light, m):
    """Value (N,) of a Beckmann closure (N·L included) times the mean N·L; view (3,), lights (N, 3).

    D G2 / (4 N'·V), Walter et al. 2007, eq. 20 and 25, with the fit of Lambda below its eq. 27 in Heitz 2014's form.
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
    tan2 = alpha2 * np.maximum(1.0 / np.square(cosine) - 1.0, 0.0)
    a = 1.0 / np.sqrt(np.maximum(tan2, 0.39))
    return np.where(tan2 < 0.39, 0.0, ((0.396 * a - 1.259) * a + 1.0) / ((2.181 * a + 3.535) * a))


def view_of(family: Family, u, v):
    """(view (3,), exponent) of a node."""
    n = min(max(v, 1e-3) ** (-1.0 / family.power), HIGHEST)
    theta = np.linspace(0.0, STEEPEST, 10001)
    # Inverted by interpolation between values that are even in theta and values that are even in w / (1 + w).
    w = np.linspace(0.0, 0.9999, 10001)
    theta = np.union1d(theta, np.minimum(np.arctan(w / (1.0 - w) * np.sqrt(family.phong_exponent(n))), STEEPEST))
    theta = np.interp(u, view_coordinate(family, theta, n), theta)
    return np.array([np.sin(theta), 0.0, np.cos(theta)]), n


def view_coordinate(family: Family, theta, n):
    """The coordinate u of `theta`, see `Family`."""
    w = np.tan(theta) / np.sqrt(family.phong_exponent(n))
    return 0.5 * w / (1.0 + w) + theta / np.pi


def feature_cosines(family: Family, theta, n):
    """The cosines M where a shader reads the gain, shape (FEATURES,); the first is N·V."""
    return np.cos(np.maximum(theta - np.array(FEATURES) / np.sqrt(family.phong_exponent(n)), 0.0))


def gains(family: Family, cosines, n):
    """Gains M / D(M) at `cosines` (N,), one row for each of GAINS, shape (GAINS, N)."""
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

    A half-vector lobe at grazing is oblong and leaves out much that round closures reach: half of the lights are spread
    over it, half as over the Phong lobe that is as wide. A few lie on the horizon, where closures that lean may end
    below zero.
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
    theta = np.arccos(view[2])
    reach = min(1.4 * lobe.reach(n, 1e-5), np.pi - 1e-3)
    delta = reach * (np.arange(rings) + 0.5) / rings
    # Both lobes: N·L = cos(delta) cos(theta) + sin(delta) sin(theta) cos(phi), see the azimuth of the horizon.
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


def columns(family: Family, view, light, m):
    """Values of all closures per coefficient, shape (N, family.columns)."""
    ramps = [ramp(r, view, light, m) for r in family.ramps]
    return np.concatenate(ramps + [facet(f, view, light, m)[:, None] for f in family.facets], axis=1)


def fit_node(family: Family, u, v):
    """Coefficients (FEATURES, columns) of one node, and what each feature leaves over (FEATURES,), see `_left`."""
    view, n = view_of(family, u, v)
    light, share = lights(family, view, n)
    features, targets, whole = _targets(family, view, light, n)
    energy = whole @ share
    features, targets, whole = (x / energy[:, None] for x in (features, targets, whole))
    closures = columns(family, view, light, family.phong_exponent(n))
    drawn = family.lobe.pdf(np.broadcast_to(view, light.shape), light, DRAWN * n)
    # The splats' variance is the integral of the squared remainder over what it is drawn with.
    weight = share * (share @ drawn) / (drawn + FAINTEST * drawn.max())
    # What a hole takes away (see estimator.h) of a base as high as the target; a fifth of it, as its edge is blurred.
    hole = np.minimum(HOLE * family.width(view[2], n), np.maximum(light[:, 2], 0.0) / HOLE_EDGE)
    taken = 0.2 * np.pi * hole**2 * drawn * whole
    weights, goals = np.tile(weight, (len(GAINS), 1)), targets
    for _ in range(ROUNDS):
        coefficients = _solve(family, features, goals, closures, weights, share)
        remainder = targets - features @ coefficients @ closures.T
        # Besides remainder^2 there count ABOVE (-remainder - taken)^2 and BELOW base^2, where the last round made them.
        above, below = -remainder > taken, remainder > whole
        goals = targets + np.where(above, ABOVE / (1.0 + ABOVE) * taken, 0.0)
        goals = np.where(below, targets - BELOW / (1.0 + BELOW) * whole, goals)
        weights = weight * (1.0 + np.where(below, BELOW, np.where(above, ABOVE, 0.0)))
    return coefficients, _left(features, np.abs(remainder) @ share, energy)


def _solve(family, features, goals, closures, weights, share):
    """Coefficients (FEATURES, columns) whose closures are nearest to `goals` (GAINS, N) with `weights` (GAINS, N)."""
    from scipy.optimize import lsq_linear

    used = share @ closures > 1e-12
    seen = closures[:, used]
    # Coefficient c of feature f counts features[g, f] seen[:, c] in the goal of gain g.
    square = sum(np.kron(np.outer(f, f), seen.T * w @ seen) for f, w in zip(features, weights, strict=True))
    wanted = sum(np.kron(f, (w * goal) @ seen) for f, w, goal in zip(features, weights, goals, strict=True))
    root = np.linalg.cholesky(square / len(GAINS) + family.ridge * np.eye(len(square)))
    positive = np.tile(np.flatnonzero(used) >= LEVELS * len(family.ramps), len(FEATURES))
    found = lsq_linear(root.T, np.linalg.solve(root, wanted / len(GAINS)),
                       (np.where(positive, 0.0, -np.inf), np.inf), "bvls")
    coefficients = np.zeros((len(FEATURES), family.columns))
    coefficients[:, used] = found.x.reshape(len(FEATURES), -1)
    return coefficients


def _targets(family, view, light, n):
    """Features (GAINS, FEATURES) and f (N·L) (GAINS, N) less what the shader gives to phong_ramp; all of f (N·L)."""
    theta, mu = np.arccos(view[2]), np.maximum(light[:, 2], 0.0)
    lobe = family.lobe.value(np.broadcast_to(view, light.shape), light, n)
    fine = np.cos(np.linspace(theta, 0.0, 400))
    gain = np.array([np.interp(np.maximum(mu, view[2]), fine, row) for row in gains(family, fine, n)])
    at = feature_cosines(family, theta, n)
    features, whole = gains(family, at, n), lobe * np.minimum(1.0, mu / view[2]) * gain
    slope = (features / at).min(axis=1, keepdims=True) if family.plain else 0.0
    return features - slope * at, whole - slope * lobe * mu, whole


def _left(features, size, energy):
    """What each feature leaves over (FEATURES,), so that a gain's sum is about its `size` (GAINS,).

    In parts of the energy that the limit, the first of the gains, would have with the gain of the mirror direction.
    """
    from scipy.optimize import nnls

    features = features * energy[:, None]
    # Features that no gain tells apart share what is left: none of them is to grow without bound.
    held = 1e-2 * features.max() * np.eye(len(FEATURES))
    return nnls(np.concatenate([features, held]), np.append(size * energy / energy[0], np.zeros(len(FEATURES))))[0]


def _fit_job(job):
    from threadpoolctl import threadpool_limits

    family_id, i, j = job
    family = FAMILIES[family_id]
    with threadpool_limits(1):  # there is a process on every core already
        return fit_node(family, i / (family.u_nodes - 1), j / (family.v_nodes - 1))


def fit(workers=None):
    """Fit every node of every family and write the file, a generator that yields (nodes done, nodes in all).

    Needs SciPy and threadpoolctl.
    """
    # At normal incidence N.L is never the larger cosine and all gains are one: with `plain` nothing is left to fit.
    first = {name: 1 if family.plain else 0 for name, family in FAMILIES.items()}
    jobs = [(name, i, j) for name, family in FAMILIES.items() for i in range(first[name], family.u_nodes)
            for j in range(family.v_nodes)]
    found = {family: {} for family in FAMILIES}
    for done, (job, result) in enumerate(zip(jobs, mapped(_fit_job, jobs, workers), strict=True), 1):
        found[job[0]][job[1:]] = result
        yield done, len(jobs)
    for name, nodes in found.items():
        nodes.update({(0, j): nodes[first[name], j] for j in range(FAMILIES[name].v_nodes)})
    replace_text(tables.folder() / FILE, json.dumps(_document(found), indent=None, separators=(",", ":")) + "\n")


def _document(found):
    return {
        "about": "Cycles' closures near each target, by least squares; see addon/baking/base.py",
        "drawn": DRAWN, "hole": HOLE, "grazing": GRAZING, "features": FEATURES,
        "families": {
            name: {
                "ramps": [asdict(r) for r in family.ramps], "facets": [asdict(f) for f in family.facets],
                "plain": family.plain, "u_nodes": family.u_nodes, "v_nodes": family.v_nodes,
                "power": family.power, "stride": stride(family),
                "table": [float(f"{x:.4g}") for at in sorted(found[name]) for x in _packed(family, *found[name][at])],
            }
            for name, family in FAMILIES.items()
        },
    }


def stride(family: Family):
    """Vectors of three numbers that one gain of one node takes in the table."""
    return 3 * len(family.ramps) + -(-len(family.facets) // 3)


def _packed(family, coefficients, left):
    """A node's numbers as the shader reads them: per gain, each ramp's LEVELS and one more, then the facets' weights.

    The ninth number of the first ramp is what the gain leaves over, the others' are 0; vectors are filled with 0.
    """
    rows = np.zeros((len(FEATURES), 3 * stride(family)))
    ramps, facets = len(family.ramps), len(family.facets)
    levels = np.zeros((len(FEATURES), ramps, LEVELS + 1))
    levels[:, :, :LEVELS] = coefficients[:, : LEVELS * ramps].reshape(len(FEATURES), ramps, LEVELS)
    levels[:, 0, LEVELS] = left
    rows[:, : 9 * ramps] = levels.reshape(len(FEATURES), -1)
    rows[:, 9 * ramps : 9 * ramps + facets] = coefficients[:, LEVELS * ramps :]
    return rows.ravel()
