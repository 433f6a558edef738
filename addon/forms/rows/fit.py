"""The base of each row: the microfacets and the diffuse closure that are nearest to a formula from below.

There are many candidates, placed by the spread of the formula's half vectors. The first fit finds non-negative weights
of all candidates, for all views at once. The last fit takes the strongest few, and finds their weights in each channel.
"""
from dataclasses import dataclass

import numpy as np

from ..closures import NARROWEST_FACET
from .facets import is_useful, row_facet_value
from .lobe_rows import FACETS

OVER = 9.0  # weight of the excess of the base over the formula; that of the residual is 1
ROUNDS, COARSE_ROUNDS = 14, 6  # rounds of reweighting: in the last fit, and in fits that only choose candidates
SWEEPS = 40  # sweeps of coordinate descent in each round
UNSEEN = 0.3  # share of a direction's light from which on the residual there gets candidates of its own

# Widths of candidates, in units of the spread of the formula's half vectors.
WIDTHS = (0.35, 0.6, 0.85, 1.2, 1.7, 2.6)
# Positions of their middles in the same units, for round and for stretched formulas.
POSITIONS = ((0.0, 0.0), (-1.0, 0.0), (1.0, 0.0), (-2.0, 0.0), (2.0, 0.0), (0.0, 1.2), (-1.0, 1.2), (1.0, 1.2))
STRETCHED_POSITIONS = tuple((x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)) + (
    (-2.0, 0.0), (2.0, 0.0), (0.0, -2.0), (0.0, 2.0))
WIDEST_PAIR = 1.3  # largest width of a candidate off the plane of incidence, in the same units
WIDEST = 1.0  # largest width of a closure
# (slopes, widths) of further candidates, for light that is spread over the whole hemisphere.
BROAD = (((0.0, 0.0), (1.0, 1.0)), ((-0.5, 0.0), (1.0, 1.0)), ((0.5, 0.0), (1.0, 1.0)), ((0.0, 0.0), (0.5, 0.5)))


@dataclass(frozen=True)
class Base:
    """The base of one row: at most FACETS microfacets, and a diffuse closure.

    `closures` has (slopes, widths) of each closure, and None for the diffuse one. `densities` (closures, RINGS, turns)
    are like `ViewSlice.density`, and `colours` (closures, channels) are the weights.
    """

    closures: list
    densities: np.ndarray
    colours: np.ndarray


def fit_bases(slices: list) -> list:
    """The `Base` of each view slice, all of one layout."""
    # The first fit: all candidates, with the mean of the channels.
    gray = [view_slice.density.mean(axis=-1) for view_slice in slices]
    target = np.array([density.ravel() for density in gray], dtype=np.float32)
    area = np.array([view_slice.area.ravel() for view_slice in slices], dtype=np.float32)
    candidates = [_candidates(view_slice, density) + [broad for broad in BROAD if is_useful(view_slice.view, broad[0])]
                  for view_slice, density in zip(slices, gray, strict=True)]
    densities, basis = _densities(slices, candidates)
    weight = _fit_from_below(basis, target, area, COARSE_ROUNDS)
    # A lobe that the candidates do not reach at all, such as a retroreflective one, gets candidates of its own.
    residual = target - np.einsum("vj,vjn->vn", weight, basis)
    unseen = np.where(residual > UNSEEN * target, residual, 0.0)
    if (unseen * area).sum() > 0.01 * (target * area).sum():
        more = [_candidates(view_slice, density.reshape(view_slice.area.shape))
                for view_slice, density in zip(slices, unseen, strict=True)]
        candidates = [first + second for first, second in zip(candidates, more, strict=True)]
        densities, basis = _densities(slices, candidates)
        weight = _fit_from_below(basis, target, area, COARSE_ROUNDS)
    return _strongest(slices, candidates, densities, basis, weight)


def _strongest(slices, candidates, densities, basis, weight):
    """The `Base` of each slice: the candidates with most light, with a last fit in each channel."""
    channels = slices[0].density.shape[-1]
    area = np.array([view_slice.area.ravel() for view_slice in slices], dtype=np.float32)
    colour = np.array([view_slice.density.reshape(-1, channels) for view_slice in slices], dtype=np.float32)
    # The energy of each candidate; with colors it is the sum of its shares of all channels.
    carried = np.einsum("vjn,vn->vj", basis, area)
    energy = weight * carried
    if channels > 1:
        whole = np.maximum(np.einsum("vnc,vn->vc", colour, area), 1e-12)
        energy = sum(_fit_from_below(basis, colour[..., c], area, COARSE_ROUNDS) * carried / whole[:, c, None]
                     for c in range(channels))
    # The diffuse closure, the last one, is always in the base.
    energy[:, -1] = np.inf
    chosen = np.argsort(-energy, axis=1)[:, : FACETS + 1]
    few = np.take_along_axis(basis, chosen[..., None], axis=1)
    colours = np.stack([_fit_from_below(few, colour[..., c], area) for c in range(channels)], axis=-1)
    last = basis.shape[1] - 1

    def closure(i, j):
        # A slice with fewer candidates than others has padding before them, whose weight is 0.
        return None if j == last else candidates[i][max(j - last, -len(candidates[i]))]

    return [Base([closure(i, j) for j in chosen[i]], densities[i][chosen[i]], colours[i]) for i in range(len(slices))]


def _candidates(view_slice, density):
    """[(slopes, widths)] of useful microfacets for a `density` (RINGS, turns) of a slice, by its spread."""
    energy = (density * view_slice.area).ravel()
    if not energy.any():
        return []

    def quantiles(slope, shares):
        order = np.argsort(slope.ravel())
        before = np.cumsum(energy[order])
        return np.interp(np.array(shares) * before[-1], before, slope.ravel()[order])

    # Middle and spread of the half vectors' slopes along x and y; a round formula's slice has the side y >= 0 only.
    up = np.maximum(view_slice.half[..., 2], 1e-3)
    low, middle, high = np.transpose([quantiles(view_slice.half[..., i] / up, (0.16, 0.5, 0.84)) for i in (0, 1)])
    if view_slice.layout.azimuths == 1:
        low[1], middle[1], high[1] = 0.0, 0.0, 2.0 * quantiles(view_slice.half[..., 1] / up, (0.68,))[0]
    spread = np.maximum(0.5 * (high - low), 1e-4)
    # Each width at each position.
    facets = []
    for width in WIDTHS:
        for x, y in POSITIONS if view_slice.layout.azimuths == 1 else STRETCHED_POSITIONS:
            if not y or width < WIDEST_PAIR:
                slopes = (middle[0] + x * spread[0], middle[1] + y * spread[1])
                facets.append((slopes, tuple(np.clip(np.sqrt(2.0) * width * spread, NARROWEST_FACET, WIDEST))))
    return [facet for facet in facets if is_useful(view_slice.view, facet[0])]


def _densities(slices, candidates):
    """Densities of the candidates of each slice, as a list and as an array.

    The list has (candidates + 1, RINGS, turns) for each slice, and the array is (views, candidates + 1, nodes). The
    diffuse closure is last. Slices with fewer candidates than others are padded with zeros at the front.
    """
    most = max(len(several) for several in candidates)
    padded = []
    for view_slice, several in zip(slices, candidates, strict=True):
        density = _slice_densities(view_slice, several)
        padded.append(np.concatenate([np.zeros((most + 1 - len(density), *density.shape[1:])), density]))
    return padded, np.array([density.reshape(len(density), -1) for density in padded], dtype=np.float32)


def _slice_densities(view_slice, candidates):
    """Densities (candidates + 1, RINGS, turns) of candidates, pairs counting as one, and last of a diffuse closure."""
    jacobian = view_slice.jacobian
    densities = [row_facet_value(view_slice.layout, view_slice.view, slopes, widths, view_slice.light) * jacobian
                 for slopes, widths in candidates]
    densities.append(np.where(view_slice.lit, view_slice.light[..., 2] / np.pi, 0.0) * jacobian)
    return np.array(densities)


def _fit_from_below(basis, target, area, rounds=ROUNDS):
    """Weights >= 0, (views, candidates), of the sum of `basis` (views, candidates, nodes) nearest below `target`.

    They minimize the integral of |target - sum|, times OVER where the sum is above, by reweighted least squares.
    """
    # In the first round each node counts by its relative error.
    views, count, _ = basis.shape
    weight = np.zeros((views, count))
    small = 5e-4 * target.max(axis=1, keepdims=True) + 0.01 * target + 1e-12
    importance = area / np.maximum(target, np.maximum(1e-3 * target.max(axis=1, keepdims=True), 1e-12))
    for _ in range(rounds):
        # Normal equations of the weighted least squares.
        gram = ((basis * importance[:, None]) @ basis.transpose(0, 2, 1)).astype(np.float64)
        right = (basis @ (importance * target)[..., None])[..., 0].astype(np.float64)
        diagonal = np.einsum("vjj->vj", gram)
        diagonal = np.where(diagonal > 0.0, diagonal, 1.0)
        # Coordinate descent with weights >= 0.
        for _ in range(SWEEPS):
            for j in range(count):
                step = (right[:, j] - np.einsum("vk,vk->v", gram[:, j], weight)) / diagonal[:, j]
                weight[:, j] = np.maximum(weight[:, j] + step, 0.0)
        # Weights of the next round, by this residual.
        residual = target - (weight.astype(np.float32)[:, None] @ basis)[:, 0]
        over = np.where(residual < 0.0, np.float32(OVER), np.float32(1.0))
        importance = area * over / np.maximum(np.abs(residual), small)
    return weight
