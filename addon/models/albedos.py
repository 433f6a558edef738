"""The albedos and volumes that models divide by.

There are two sources: INTEGRATED, the exact one, and `tabulated.TABULATED`, which reads tables and is fast. A model's
field `albedos` is its source. `Model.with_albedos` replaces it.
"""
from functools import lru_cache
from typing import Protocol

import numpy as np

from . import disk, pump_stages
from .interpolation import Reader

# Nodes of a volume's curve.
_VOLUME_NODES = 160
# The number of curves in each cache.
_CACHED = 128


class Albedos(Protocol):
    """A source of albedos and volumes."""

    def stages(self, lobe, control: bool, cos_theta, exponent: float, count: int) -> np.ndarray:
        """The first `count` albedos a_0 .. a_3 of a lobe's pump stages at cosines (...,) for one exponent.

        Shape (..., count). See pumping.py.
        """

    def kinks(self, lobe, control: bool, exponent: float, pumps: float) -> tuple:
        """Cosines of light or view at which D of `pumps` stages has a kink. Integrals over D should be split there."""

    def volumes(self, mu_view, exponent, radius) -> np.ndarray:
        """Volumes (N,), inside the disk at N·V = `mu_view`, of round lumps about the origin. All arguments are (N,)."""


class IntegratedAlbedos:
    """Albedos and volumes by quadrature, cached as curves over the angle. No file is read.

    Albedos err by less than 1e-5 of themselves, volumes by less than 1e-6.
    """

    def stages(self, lobe, control, cos_theta, exponent, count):
        """See `Albedos`."""
        return _stage_curves(lobe, bool(control), float(exponent)).at(cos_theta, count)

    def kinks(self, lobe, control, exponent, pumps):
        """See `Albedos`."""
        return _kinks(lobe, bool(control), float(exponent), float(pumps))

    def volumes(self, mu_view, exponent, radius):
        """See `Albedos`."""
        distance, volumes = disk.room(np.asarray(mu_view)), np.empty(len(mu_view))
        # One curve for each pair of exponent and radius. They are mostly the same for all views.
        for n, r in np.unique(np.stack([exponent, radius], axis=-1), axis=0):
            chosen = (exponent == n) & (radius == r)
            volumes[chosen] = _VolumeCurve.of(float(n), float(r)).at(distance[chosen] / r)
        return volumes


INTEGRATED = IntegratedAlbedos()


@lru_cache(maxsize=_CACHED)
def _stage_curves(lobe, control, exponent):
    return pump_stages.curves(lobe, exponent, control)


@lru_cache(maxsize=_CACHED)
def _kinks(lobe, control, exponent, pumps):
    if not control or not pumps:
        return lobe.kinks
    return (*lobe.kinks, *pump_stages.kinks_of_control(_stage_curves(lobe, control, exponent), pumps))


class _VolumeCurve:
    """One round lump's volume inside the disk, over the distance from its center to the disk's rim: 0 .. 1 radii.

    For narrow lumps the nodes are even in the logarithm of the distance. At distance 1 the rim leaves the lump, and the
    volume of a lump with exponent n reaches 1 as the power n + 3/2 of the remaining distance. Nodes crowd there
    quadratically.
    """

    def __init__(self, exponent, radius):
        self._k = 3.0 * np.sqrt(exponent + 1.0)
        u = np.linspace(0.0, 1.0, _VOLUME_NODES)
        distance = np.sinh((1.0 - (1.0 - u) ** 2) * np.arcsinh(self._k)) / self._k
        self._nodes = disk.volume_at(exponent, radius, distance)

    @classmethod
    @lru_cache(maxsize=_CACHED)
    def of(cls, exponent, radius):
        """The curve of a lump, cached."""
        return cls(exponent, radius)

    def at(self, distance):
        """Volume (N,) at distances (N,). Distances above 1 count as 1: the lump is wholly inside the disk."""
        coordinate = np.arcsinh(self._k * np.clip(distance, 0.0, 1.0)) / np.arcsinh(self._k)
        u = 1.0 - np.sqrt(np.maximum(1.0 - coordinate, 0.0))
        return Reader(u * (_VOLUME_NODES - 1), _VOLUME_NODES).read(self._nodes)
