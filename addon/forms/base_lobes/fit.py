"""The fit of base lobes: colours and weights of closures that together are nearly the target.

The estimator (see `osl/include/estimator.h`) adds the residual of the base, of either sign, so the base decides noise,
blur and cost, and hardly the mean.

The colours are linear in the gain of a target at a few cosines M (`FEATURES`), with coefficients that depend on the
view angle and the exponent. Scaled by the lobe's width 1 / sqrt(m), m being the exponent of the equivalent Phong lobe,
they change slowly with both; the shader interpolates between nodes of u, which stands for the view (see `Family`), and
v, a power of n. At each node linear least squares find the coefficients whose residual gives the estimator least
variance, for all gains in `GAINS`. That no sample be negative, it counts besides how far the base is below zero, and
how far above the target beyond what holes, the negative kernels, take away, both squared: a convex problem, which a few
rounds solve, each with the weights that the last one calls for.
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

DRAWN = 0.6  # exponent of the lobe that kernels are sampled from, in parts of n: wider, as the residual is
FAINTEST = 1e-3  # of that lobe's peak, added to it: far out on the lobe nothing is ever sampled
NEGATIVE_RADIUS = 0.4  # radius of the widest holes, which are kernels that take away, in parts of the lobe's width
ABOVE, BELOW = 30.0, 1e4  # what more it counts to be above the target by more than holes take away, and below zero
ROUNDS = 8


def fit_node(family: Family, u, v):
    """(coefficients (FEATURES, columns), sizes of residuals (FEATURES,), see `_residual_sizes`) of one node.

    `u` and `v` are its coordinates, 0..1, see `Family`. Needs SciPy.
    """
    view, n = view_of(family, u, v)
    light, share = lights(family, view, n)
    features, goal, whole = targets(family, view, light, n)
    energy = whole @ share
    features, goal, whole = (x / energy[:, None] for x in (features, goal, whole))
    closures = columns(family, view, light, family.phong_exponent(n))
    drawn = family.lobe.pdf(np.broadcast_to(view, light.shape), light, DRAWN * n)
    # The kernels' variance is the integral of the squared residual over the density that they are sampled with.
    weight = share * (share @ drawn) / (drawn + FAINTEST * drawn.max())
    # What a hole takes away (see estimator.h) of a base as high as the target; a fifth of it, as its edge is blurred.
    radius = np.minimum(NEGATIVE_RADIUS * family.width(view[2], n), np.maximum(light[:, 2], 0.0) / NEGATIVE_EDGE)
    taken = 0.2 * np.pi * radius**2 * drawn * whole
    weights, goals = np.tile(weight, (len(GAINS), 1)), goal
    for _ in range(ROUNDS):
        coefficients = _solve(family, features, goals, closures, weights, share)
        residual = goal - features @ coefficients @ closures.T
        # Besides residual^2 there count ABOVE (-residual - taken)^2 and BELOW base^2, where the last round made them.
        above, below = -residual > taken, residual > whole
        goals = goal + np.where(above, ABOVE / (1.0 + ABOVE) * taken, 0.0)
        goals = np.where(below, goal - BELOW / (1.0 + BELOW) * whole, goals)
        weights = weight * (1.0 + np.where(below, BELOW, np.where(above, ABOVE, 0.0)))
    return coefficients, _residual_sizes(features, np.abs(residual) @ share, energy)


def _solve(family, features, goals, closures, weights, share):
    """Coefficients (FEATURES, columns) whose closures are nearest to `goals` (GAINS, N) with `weights` (GAINS, N)."""
    from scipy.optimize import lsq_linear

    used = share @ closures > 1e-12
    seen = closures[:, used]
    # Coefficient c of feature f counts features[g, f] seen[:, c] in the goal of gain g.
    square = sum(np.kron(np.outer(f, f), seen.T * w @ seen) for f, w in zip(features, weights, strict=True))
    right = sum(np.kron(f, (w * goal) @ seen) for f, w, goal in zip(features, weights, goals, strict=True))
    root = np.linalg.cholesky(square / len(GAINS) + family.ridge * np.eye(len(square)))
    positive = np.tile(np.flatnonzero(used) >= LEVELS * len(family.ramps), len(FEATURES))
    found = lsq_linear(root.T, np.linalg.solve(root, right / len(GAINS)),
                       (np.where(positive, 0.0, -np.inf), np.inf), "bvls")
    coefficients = np.zeros((len(FEATURES), family.columns))
    coefficients[:, used] = found.x.reshape(len(FEATURES), -1)
    return coefficients


def _residual_sizes(features, size, energy):
    """The size of each feature's residual (FEATURES,), so that a gain's sum is about its `size` (GAINS,).

    In parts of the energy that the limit, the first of the gains, would have with the gain of the mirror direction.
    """
    from scipy.optimize import nnls

    features = features * energy[:, None]
    # Features that no gain tells apart share the residual: none of them is to grow without bound.
    ridge = 1e-2 * features.max() * np.eye(len(FEATURES))
    return nnls(np.concatenate([features, ridge]), np.append(size * energy / energy[0], np.zeros(len(FEATURES))))[0]


def _fit_job(job):
    from threadpoolctl import threadpool_limits

    family_id, i, j = job
    family = FAMILIES[family_id]
    with threadpool_limits(1):  # there is a process on every core already
        return fit_node(family, i / (family.u_nodes - 1), j / (family.v_nodes - 1))


def fit(workers=None):
    """Fit every node of every family and write the file, a generator that yields (nodes done, nodes in all).

    Needs SciPy and threadpoolctl. Raises OSError where the file cannot be written.
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
        "about": "Cycles' closures near each target, by least squares, of plausible bake --base-lobes",
        "drawn": DRAWN, "hole": NEGATIVE_RADIUS, "grazing": GRAZING, "features": FEATURES,
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


def _packed(family, coefficients, residual):
    """A node's numbers as the shader reads them: per gain, each ramp's LEVELS and one more, then the facets' weights.

    The ninth number of the first ramp is the size of the residual, the others' are 0; vectors are filled with 0.
    """
    rows = np.zeros((len(FEATURES), 3 * stride(family)))
    ramps, facets = len(family.ramps), len(family.facets)
    levels = np.zeros((len(FEATURES), ramps, SLOTS))
    levels[:, :, :LEVELS] = coefficients[:, : LEVELS * ramps].reshape(len(FEATURES), ramps, LEVELS)
    levels[:, 0, LEVELS] = residual
    rows[:, : SLOTS * ramps] = levels.reshape(len(FEATURES), -1)
    rows[:, SLOTS * ramps : SLOTS * ramps + facets] = coefficients[:, LEVELS * ramps :]
    return rows.ravel()
