"""Albedos a_0 .. a_3 of a lobe's pump stages, integrated for one exponent. Models divide by them, tables store them.

Each stage needs its predecessors' albedos at all lights. The albedos are therefore integrated at the nodes of curves
over the angle, and interpolated between the nodes. The curves are much finer than a table.
"""
from dataclasses import dataclass

import numpy as np

from . import pumping
from .interpolation import POINTS, Reader
from .quadrature import polar_energy

STAGES = pumping.MAX_PUMPS
# The least number of a curve's nodes, and the number for each e-fold of the angle.
_FEWEST, _PER_FOLD = 120, 34
# The least number of a piece's nodes. Pieces shorter than the distance of nodes have fewer.
_IN_A_PIECE = 14
# Nodes of the integrals at a curve's nodes, and in the passes that find kinks.
_FINE = {"polar": 16, "azimuthal": 48}
_PASSES = {"polar": 6, "azimuthal": 20}, {"polar": 12, "azimuthal": 30}
# The search for kinks divides the interval between two nodes into this many.
_BETWEEN = 16
# Kinks at a smaller distance than this, in the coordinate of `Angles`, count as one.
_APART = 1e-4
# Two sides of control count as equal if their relative difference is at most this.
_AGREEMENT = 1e-5


class Angles:
    """Nodes over the angle of the view or the light, dense at grazing and at the normal, with interpolation.

    The coordinate x runs from 0 at grazing to 1 at the normal. It is linear in the logarithm of the angle from either
    end, except within 1 / (3 sqrt(n)) of the end. The cosines `kinks` divide the curve into pieces. Nodes crowd toward
    the ends of each piece, since next to a kink a curve may behave like a square root.
    """

    def __init__(self, exponent: float, kinks=()):
        # The ends of the pieces, and the number of nodes in each.
        self._k = 3.0 * np.sqrt(exponent)
        count = max(_FEWEST, int(_PER_FOLD * np.arcsinh(self._k)))
        self._ends = np.unique([0.0, *self.coordinate(np.array(kinks, dtype=np.float64)), 1.0])
        share = count * np.diff(self._ends)
        self._counts = np.maximum(np.ceil(share) + 1, np.minimum(POINTS + 32.0 * share, _IN_A_PIECE)).astype(int)
        # Each piece's first node among all nodes, and the nodes' cosines.
        self._first = np.concatenate([[0], np.cumsum(self._counts)[:-1]])
        pieces = zip(self._ends[:-1], self._ends[1:], self._counts, strict=True)
        self.cosines = self.cosine(np.concatenate([
            low + (high - low) * np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, nodes)) ** 2
            for low, high, nodes in pieces]))

    def coordinate(self, cos_theta, sin_theta=None):
        """x, 0..1, of a cosine. `sin_theta`, if known, keeps x exact near the normal."""
        if sin_theta is None:
            sin_theta = np.sqrt(np.maximum(0.0, 1.0 - cos_theta * cos_theta))
        return 0.5 * (1.0 + (np.arcsinh(self._k * cos_theta) - np.arcsinh(self._k * sin_theta)) / np.arcsinh(self._k))

    def cosine(self, x):
        """The inverse of `coordinate`, by bisection. The coordinate is monotone in the angle from grazing."""
        low, high = np.zeros(len(x)), np.full(len(x), 0.5 * np.pi)
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self.coordinate(np.sin(middle), np.cos(middle)) < x
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(x <= 0.0, 0.0, np.where(x >= 1.0, 1.0, np.sin(0.5 * (low + high))))

    def between(self, count: int) -> np.ndarray:
        """Cosines, ascending, that divide the interval from each node to the next into `count`."""
        nodes = np.arccos(np.unique(self.cosines))
        share = np.arange(count) / count
        return np.append(np.cos(nodes[:-1, None] + share * np.diff(nodes)[:, None]).ravel(), 1.0)

    def reader(self, cos_theta) -> Reader:
        """The interpolation of values at the nodes to `cos_theta` (...,)."""
        # The piece that a cosine lies in, and the fraction of the piece before it.
        x = np.clip(self.coordinate(cos_theta), 0.0, 1.0)
        piece = np.clip(np.searchsorted(self._ends, x, side="right") - 1, 0, len(self._counts) - 1)
        fraction = np.clip((x - self._ends[piece]) / np.diff(self._ends)[piece], 0.0, 1.0)
        # The nodes are at sin²: see __init__.
        count = self._counts[piece]
        return Reader(2.0 / np.pi * np.arcsin(np.sqrt(fraction)) * (count - 1), count, self._first[piece])


@dataclass(frozen=True)
class Curves:
    """a_0 .. a_3 over the angle: `nodes` (4, N) are their values at the N nodes of `angles`."""

    angles: Angles
    nodes: np.ndarray

    def at(self, cos_theta, count: int = STAGES) -> np.ndarray:
        """The first `count` of a_0 .. a_3 at cosines (...,), shape (..., count)."""
        reader = self.angles.reader(np.asarray(cos_theta, dtype=np.float64))
        return np.stack([reader.read(row) for row in self.nodes[:count]], axis=-1)


def curves(lobe, exponent: float, control: bool) -> Curves:
    """The albedos of one exponent as curves. Interpolation between their nodes errs by less than 5e-6 of an albedo."""
    angles, kinks = _angles(lobe, exponent, control)
    return _curves(lobe, exponent, angles, control, kinks, _FINE)


def albedos(lobe, exponent: float, cos_theta, control: bool, polar: int = 16, azimuthal: int = 36):
    """Albedos a_0 .. a_3 for views at `cos_theta` (N,), each integrated and not interpolated: (N, 4), float64.

    a_j is the integral of f_0 (N·L) / D_j, see `pumping.correction`. `polar` and `azimuthal` are the numbers of nodes
    of `quadrature.meridians`.
    """
    angles, kinks = _angles(lobe, exponent, control)
    views = np.concatenate([angles.cosines, np.atleast_1d(cos_theta)])
    return _integrated(lobe, exponent, angles, views, control, kinks, polar, azimuthal)[len(angles.cosines):]


def _angles(lobe, exponent, control):
    """The angles of an exponent's curves, and the cosines of their kinks.

    The kinks that control adds to D depend on the albedos themselves. A first pass finds them roughly, since its
    curves run across the previous stage's kinks. In the second pass pieces end there, and it finds them to about 1e-5.
    """
    angles = Angles(exponent, lobe.kinks)
    if not control:
        return angles, lobe.kinks
    kinks = lobe.kinks
    for counts in _PASSES:
        control_kinks = kinks_of_control(_curves(lobe, exponent, angles, control, kinks, counts), STAGES - 1)
        kinks = (*lobe.kinks, *control_kinks)
        angles = Angles(exponent, kinks)
    return angles, kinks


def _curves(lobe, exponent, angles, control, kinks, counts):
    """`Curves` at the nodes of `angles`. `counts` are the numbers of nodes of the integrals, by name."""
    nodes = _integrated(lobe, exponent, angles, angles.cosines, control, kinks, **counts)
    return Curves(angles, np.ascontiguousarray(nodes.T))


def _integrated(lobe, exponent, angles, views, control, kinks, polar, azimuthal):
    """Albedos (views, 4) at the cosines `views`, of which the first are those of `angles`.

    The integrals' intervals end at the cosines `kinks`.
    """
    mu_light, energy = polar_energy(lobe, exponent, views, polar, azimuthal, kinks)
    lights = angles.reader(mu_light)
    return pumping.stage_albedos(energy, views, mu_light, STAGES, control,
                                 lambda albedo: lights.read(albedo[: len(angles.cosines)]))


def kinks_of_control(curves: Curves, pumps: float) -> np.ndarray:
    """Cosines M, ascending, at which control of `pumps` stages begins or ends to act: D_j(M, M) m_j(M) = M.

    Over a range of M where both sides are equal (Phong at large n), the range's ends are the kinks.
    """
    m = curves.angles.between(_BETWEEN)
    albedo = curves.at(m)
    d, kinks = np.ones_like(m), []
    for stage in range(int(np.ceil(pumps))):
        # The side of control at each m: 1 if D_j m_j is larger than m, -1 if it is smaller, 0 if they are equal.
        pumped = d * albedo[:, stage] ** min(pumps - stage, 1.0)
        excess, equal = pumped - m, _AGREEMENT * m
        side = np.where(np.abs(excess) > equal, np.sign(excess), 0.0)
        # Between two sides the excess is 0. At the end of a range of equal sides it is the limit of agreement.
        i = np.nonzero(np.diff(side))[0]
        before, after = (excess[j] - equal[j] * (side[i] + side[i + 1]) for j in (i, i + 1))
        kinks.extend(m[i] + before / (before - after) * (m[i + 1] - m[i]))
        d = np.maximum(pumped, m)
    kinks = np.sort(kinks)
    # Rounding can turn one kink into several next to each other: one of them is enough.
    return kinks[np.diff(curves.angles.coordinate(kinks), prepend=-1.0) > _APART]
