"""Albedos a_0 .. a_3 of a lobe's pump stages, integrated for one exponent: what models divide by and tables hold.

Each stage needs the one before at all lights, so albedos are integrated at the nodes of curves over the angle, and read
from them. The curves are much finer than a table.
"""
from dataclasses import dataclass

import numpy as np

from . import pumping
from .interpolation import POINTS, Reader
from .quadrature import polar_energy

STAGES = pumping.MAX_PUMPS
_FEWEST, _PER_FOLD = 120, 34  # nodes of a curve at least, and for each time that the angle grows e-fold
_IN_A_PIECE = 14  # nodes of a piece at least, unless it is shorter than the distance of nodes
# Nodes of the integrals that curves are made of, and of the passes that look for kinks.
_FINE = {"polar": 16, "azimuthal": 48}
_PASSES = {"polar": 6, "azimuthal": 20}, {"polar": 12, "azimuthal": 30}
_BETWEEN = 16  # places from a node to the next at which kinks are looked for
_APART = 1e-4  # distance of kinks, in the coordinate of the angle, below which they are one
_AGREEMENT = 1e-5  # relative difference of two sides of control that counts as none


class Angles:
    """Nodes over the angle of the view or the light, dense at grazing and at the normal, and reading between them.

    The coordinate x runs from 0 at grazing to 1 at the normal, evenly in the logarithm of the angle from either but for
    the last 1 / (3 sqrt(n)). At the cosines `kinks` a piece ends and another begins. Nodes crowd towards the ends of
    each piece: from a kink a curve may part like a root.
    """

    def __init__(self, exponent: float, kinks=()):
        self._k = 3.0 * np.sqrt(exponent)
        count = max(_FEWEST, int(_PER_FOLD * np.arcsinh(self._k)))
        self._ends = np.unique([0.0, *self.coordinate(np.array(kinks, dtype=np.float64)), 1.0])
        share = count * np.diff(self._ends)
        self._counts = np.maximum(np.ceil(share) + 1, np.minimum(POINTS + 32.0 * share, _IN_A_PIECE)).astype(int)
        self._first = np.concatenate([[0], np.cumsum(self._counts)[:-1]])
        pieces = zip(self._ends[:-1], self._ends[1:], self._counts, strict=True)
        self.cosines = self.cosine(np.concatenate([
            low + (high - low) * np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, nodes)) ** 2
            for low, high, nodes in pieces]))

    def coordinate(self, cos_theta, sin_theta=None):
        """x of a cosine, 0..1."""
        if sin_theta is None:
            sin_theta = np.sqrt(np.maximum(0.0, 1.0 - cos_theta * cos_theta))
        return 0.5 * (1.0 + (np.arcsinh(self._k * cos_theta) - np.arcsinh(self._k * sin_theta)) / np.arcsinh(self._k))

    def cosine(self, x):
        """Inverse of `coordinate`, by bisection: the coordinate is monotone in the angle from grazing."""
        low, high = np.zeros(len(x)), np.full(len(x), 0.5 * np.pi)
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self.coordinate(np.sin(middle), np.cos(middle)) < x
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(x <= 0.0, 0.0, np.where(x >= 1.0, 1.0, np.sin(0.5 * (low + high))))

    def between(self, count: int) -> np.ndarray:
        """Cosines, ascending, at `count` places from each node to the next."""
        nodes = np.arccos(np.unique(self.cosines))
        share = np.arange(count) / count
        return np.append(np.cos(nodes[:-1, None] + share * np.diff(nodes)[:, None]).ravel(), 1.0)

    def reader(self, cos_theta) -> Reader:
        """Reads what is known at the nodes at `cos_theta` (...,)."""
        x = np.clip(self.coordinate(cos_theta), 0.0, 1.0)
        piece = np.clip(np.searchsorted(self._ends, x, side="right") - 1, 0, len(self._counts) - 1)
        part = np.clip((x - self._ends[piece]) / np.diff(self._ends)[piece], 0.0, 1.0)
        count = self._counts[piece]
        return Reader(2.0 / np.pi * np.arcsin(np.sqrt(part)) * (count - 1), count, self._first[piece])


@dataclass(frozen=True)
class Curves:
    """a_0 .. a_3 over the angle: `nodes` (4, N) at those of `angles`."""

    angles: Angles
    nodes: np.ndarray

    def at(self, cos_theta, count: int = STAGES) -> np.ndarray:
        """The first `count` of a_0 .. a_3 at cosines (...,), shape (..., count)."""
        reader = self.angles.reader(np.asarray(cos_theta, dtype=np.float64))
        return np.stack([reader.read(row) for row in self.nodes[:count]], axis=-1)


def curves(lobe, exponent: float, control: bool) -> Curves:
    """The albedos of one exponent as curves; reading between their nodes errs by less than 5e-6 of an albedo."""
    angles, kinks = _angles(lobe, exponent, control)
    return _curves(lobe, exponent, angles, control, kinks, _FINE)


def albedos(lobe, exponent: float, cos_theta, control: bool, polar: int = 16, azimuthal: int = 36):
    """Albedos a_0 .. a_3 for views at `cos_theta` (N,), each of them integrated: (N, 4), float64.

    Stage j is the integral of f_0 (N·L) / D_j; see `pumping.correction`. `polar` and `azimuthal` are those of
    quadrature.meridians.
    """
    angles, kinks = _angles(lobe, exponent, control)
    views = np.concatenate([angles.cosines, np.atleast_1d(cos_theta)])
    return _integrated(lobe, exponent, angles, views, control, kinks, polar, azimuthal)[len(angles.cosines):]


def _angles(lobe, exponent, control):
    """The angles of an exponent's curves, and the cosines of their kinks.

    Control puts kinks into D whose place only the albedos tell. A first pass finds them roughly, as its curves run
    across the kinks of the stage before; a second, with pieces that end there, finds them to about 1e-5.
    """
    angles = Angles(exponent, lobe.kinks)
    if not control:
        return angles, lobe.kinks
    kinks = lobe.kinks
    for counts in _PASSES:
        found = kinks_of_control(_curves(lobe, exponent, angles, control, kinks, counts), STAGES - 1)
        kinks = (*lobe.kinks, *found)
        angles = Angles(exponent, kinks)
    return angles, kinks


def _curves(lobe, exponent, angles, control, kinks, counts):
    nodes = _integrated(lobe, exponent, angles, angles.cosines, control, kinks, **counts)
    return Curves(angles, np.ascontiguousarray(nodes.T))


def _integrated(lobe, exponent, angles, views, control, kinks, polar, azimuthal):
    """Albedos of all stages at the cosines `views`, which begin with those of `angles`; intervals end at `kinks`."""
    mu_light, energy = polar_energy(lobe, exponent, views, polar, azimuthal, kinks)
    lights = angles.reader(mu_light)
    return pumping.stage_albedos(energy, views, mu_light, STAGES, control,
                                 lambda albedo: lights.read(albedo[: len(angles.cosines)]))


def kinks_of_control(curves: Curves, pumps: float) -> np.ndarray:
    """Cosines M at which control sets in or lets go in D of as many `pumps`: D_j(M, M) m_j(M) = M, ascending.

    Over a range where both sides are equal (Phong at large n) it does neither; the range's ends count.
    """
    m = curves.angles.between(_BETWEEN)
    albedo = curves.at(m)
    d, kinks = np.ones_like(m), []
    for stage in range(int(np.ceil(pumps))):
        pumped = d * albedo[:, stage] ** min(pumps - stage, 1.0)
        excess, equal = pumped - m, _AGREEMENT * m
        side = np.where(np.abs(excess) > equal, np.sign(excess), 0.0)
        # From one side to the other the excess passes 0; to or from a range of equal sides, the agreement's limit.
        i = np.nonzero(np.diff(side))[0]
        before, after = (excess[j] - equal[j] * (side[i] + side[i + 1]) for j in (i, i + 1))
        kinks.extend(m[i] + before / (before - after) * (m[i + 1] - m[i]))
        d = np.maximum(pumped, m)
    kinks = np.sort(kinks)
    # Of several at one place, where rounding decides about agreement, one is enough.
    return kinks[np.diff(curves.angles.coordinate(kinks), prepend=-1.0) > _APART]
