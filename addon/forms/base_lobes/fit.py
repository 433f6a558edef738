"""The fit of base lobes: colors and weights of closures that together are nearly the target.

The estimator (see `osl/include/estimator.h`) adds the residual, target minus base, of either sign. So the base decides
noise, blur and cost, and hardly the mean.

The colors are linear in the target's gain at a few cosines M (`FEATURES`). The coefficients depend on the view angle
and the exponent. Scaled by the lobe's width 1 / sqrt(m), m being the exponent of the equivalent Phong lobe, they change
slowly with both. The shader interpolates between nodes of u, a coordinate of the view (see `Family`), and v, a power of
n.

At each node linear least squares find the coefficients for which the estimator's variance is least, over all gains in
`GAINS`. Besides, no sample may be negative. So there are two penalties, both squared: the depth of the base below zero,
and its height above the target where negative kernels cannot take it away. The problem is convex. A few rounds of
reweighted least squares solve it.
"""
import json
from dataclasses import asdict

import numpy as np

from ..albedo import tables
from ..closures import LEVELS, NEGATIVE_EDGE, SLOTS
from ..files import replace_text
from ..workers import mapped
from .closures import FAMILIES, FEATURES, GRAZING, Family, columns, view_of
from .targets import GAINS, lights, targets

FILE = "base_lobes.json"

DRAWN = 0.6  # exponent of the lobe that kernels are sampled from, in parts of n: it is wider, as the residual is
FAINTEST = 1e-3  # part of that lobe's peak that is added to it: kernels are hardly ever sampled far out
NEGATIVE_RADIUS = 0.4  # radius of the widest negative kernels, in parts of the lobe's width
# Penalties, the residual counting 1: above the target by more than negative kernels take away, and below zero.
ABOVE, BELOW = 30.0, 1e4
ROUNDS = 8  # rounds of reweighting


def fit_node(family: Family, u, v):
    """(coefficients (FEATURES, columns), sizes of residuals (FEATURES,), see `_residual_sizes`) of one node.

    `u` and `v` are its coordinates, 0..1, see `Family`. Needs SciPy.
    """
    # Targets and closures at the same lights, in parts of each target's energy.
    view, n = view_of(family, u, v)
    light, share = lights(family, view, n)
    features, goal, whole = targets(family, view, light, n)
    energy = whole @ share
    features, goal, whole = (x / energy[:, None] for x in (features, goal, whole))
    closures = columns(family, view, light, family.phong_exponent(n))
    drawn = family.lobe.pdf(np.broadcast_to(view, light.shape), light, DRAWN * n)
    # The kernels' variance is the integral of the squared residual over the density that they are sampled with.
    weight = share * (share @ drawn) / (drawn + FAINTEST * drawn.max())
    # The value that a negative kernel (see estimator.h) can take away from a base as high as the target. A fifth of it
    # counts, as the kernel's edge is blurred.
    radius = np.minimum(NEGATIVE_RADIUS * family.width(view[2], n), np.maximum(light[:, 2], 0.0) / NEGATIVE_EDGE)
    taken = 0.2 * np.pi * radius**2 * drawn * whole
    # Rounds of reweighted least squares.
    weights, goals = np.tile(weight, (len(GAINS), 1)), goal
    for _ in range(ROUNDS):
        coefficients = _solve(family, features, goals, closures, weights, share)
        residual = goal - features @ coefficients @ closures.T
        # The cost is residual^2, plus ABOVE (-residual - taken)^2 and BELOW base^2 where the last round violates these.
        above, below = -residual > taken, residual > whole
        goals = goal + np.where(above, ABOVE / (1.0 + ABOVE) * taken, 0.0)
        goals = np.where(below, goal - BELOW / (1.0 + BELOW) * whole, goals)
        weights = weight * (1.0 + np.where(below, BELOW, np.where(above, ABOVE, 0.0)))
    return coefficients, _residual_sizes(features, np.abs(residual) @ share, energy)


def _solve(family, features, goals, closures, weights, share):
    """Coefficients (FEATURES, columns) whose closures are nearest to `goals` (GAINS, N), with `weights` (GAINS, N)."""
    from scipy.optimize import lsq_linear

    # Closures without any energy at these lights have no coefficient.
    used = share @ closures > 1e-12
    seen = closures[:, used]
    # Normal equations. Coefficient c of feature f adds features[g, f] seen[:, c] to the sum of gain g.
    square = sum(np.kron(np.outer(f, f), seen.T * w @ seen) for f, w in zip(features, weights, strict=True))
    right = sum(np.kron(f, (w * goal) @ seen) for f, w, goal in zip(features, weights, goals, strict=True))
    # Their Cholesky factor gives an equal problem of few rows. Facets' weights are not negative.
    root = np.linalg.cholesky(square / len(GAINS) + family.ridge * np.eye(len(square)))
    positive = np.tile(np.flatnonzero(used) >= LEVELS * len(family.ramps), len(FEATURES))
    solution = lsq_linear(root.T, np.linalg.solve(root, right / len(GAINS)),
                          (np.where(positive, 0.0, -np.inf), np.inf), "bvls")
    coefficients = np.zeros((len(FEATURES), family.columns))
    coefficients[:, used] = solution.x.reshape(len(FEATURES), -1)
    return coefficients


def _residual_sizes(features, size, energy):
    """Sizes of the residual (FEATURES,): coefficients of features whose sum for each gain is about `size` (GAINS,).

    They are in parts of the energy that the limit, the first of the gains, has with the mirror direction's gain.
    """
    from scipy.optimize import nnls

    features = features * energy[:, None]
    # The ridge bounds the coefficients of features that are equal for all gains: they share the residual.
    ridge = 1e-2 * features.max() * np.eye(len(FEATURES))
    return nnls(np.concatenate([features, ridge]), np.append(size * energy / energy[0], np.zeros(len(FEATURES))))[0]


def _fit_job(job):
    """`fit_node` of a job, (family's id, index of u, index of v)."""
    from threadpoolctl import threadpool_limits

    family_id, i, j = job
    family = FAMILIES[family_id]
    with threadpool_limits(1):  # there is a process on every core already
        return fit_node(family, i / (family.u_nodes - 1), j / (family.v_nodes - 1))


def fit(workers=None):
    """Fit every node of every family and write the file, a generator that yields (nodes done, all nodes).

    Needs SciPy and threadpoolctl. Raises OSError where the file cannot be written.
    """
    # At normal incidence N.L is never the larger cosine, and all gains are 1: with `plain` there is nothing to fit.
    first = {name: 1 if family.plain else 0 for name, family in FAMILIES.items()}
    jobs = [(name, i, j) for name, family in FAMILIES.items() for i in range(first[name], family.u_nodes)
            for j in range(family.v_nodes)]
    results = {family: {} for family in FAMILIES}
    for done, (job, result) in enumerate(zip(jobs, mapped(_fit_job, jobs, workers), strict=True), 1):
        results[job[0]][job[1:]] = result
        yield done, len(jobs)
    # There a node gets the numbers of the next view.
    for name, nodes in results.items():
        nodes.update({(0, j): nodes[first[name], j] for j in range(FAMILIES[name].v_nodes)})
    replace_text(tables.folder() / FILE, json.dumps(_document(results), indent=None, separators=(",", ":")) + "\n")


def _document(results):
    """The file's contents from {family: {(index of u, index of v): result of `fit_node`}}."""
    return {
        "about": "Cycles' closures near each target, by least squares, of plausible bake --base-lobes",
        "drawn": DRAWN, "hole": NEGATIVE_RADIUS, "grazing": GRAZING, "features": FEATURES,
        "families": {
            name: {
                "ramps": [asdict(r) for r in family.ramps], "facets": [asdict(f) for f in family.facets],
                "plain": family.plain, "u_nodes": family.u_nodes, "v_nodes": family.v_nodes,
                "power": family.power, "stride": stride(family),
                "table": [float(f"{x:.4g}") for node in sorted(results[name])
                          for x in _packed(family, *results[name][node])],
            }
            for name, family in FAMILIES.items()
        },
    }


def stride(family: Family):
    """Number of vectors, of three numbers each, of one gain of one node in the table."""
    return 3 * len(family.ramps) + -(-len(family.facets) // 3)


def _packed(family, coefficients, residual):
    """A node's numbers in the shader's order: per feature, each ramp's LEVELS and one more, then the facets' weights.

    The ninth number of the first ramp is the size of the residual; that of the others is 0. The last vector is padded
    with 0.
    """
    rows = np.zeros((len(FEATURES), 3 * stride(family)))
    ramps, facets = len(family.ramps), len(family.facets)
    levels = np.zeros((len(FEATURES), ramps, SLOTS))
    levels[:, :, :LEVELS] = coefficients[:, : LEVELS * ramps].reshape(len(FEATURES), ramps, LEVELS)
    levels[:, 0, LEVELS] = residual
    rows[:, : SLOTS * ramps] = levels.reshape(len(FEATURES), -1)
    rows[:, SLOTS * ramps : SLOTS * ramps + facets] = coefficients[:, LEVELS * ramps :]
    return rows.ravel()
