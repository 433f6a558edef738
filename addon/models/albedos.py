"""The albedos and volumes that models divide by. Two kinds: integrated, the truth, and read from tables, which is fast.

A model has one kind as its field `albedos`; `Model.with_albedos` exchanges it. The other kind is `tabulated.TABULATED`.
"""
from functools import lru_cache
from typing import Protocol

import numpy as np

from . import disk, pump_stages
from .interpolation import Reader

_VOLUME_NODES = 160
_KEPT = 128  # exponents whose curves are remembered


class Albedos(Protocol):
    """What a model asks for."""

    def stages(self, lobe, control: bool, cos_theta, exponent: float, count: int) -> np.ndarray:
        """The first `count` of a_0 .. a_3 of a lobe's pump stages, at cosines (...,) and one exponent: (..., count).

        See pumping.py.
        """

    def kinks(self, lobe, control: bool, exponent: float, pumps: float) -> tuple:
        """Cosines of light or view at which D of as many `pumps` bends: where integrals had better be parted."""

    def volumes(self, mu_view, exponent, radius) -> np.ndarray:
        """Volume (N,) of round lumps about the origin inside the disk at N·V = `mu_view`; all arguments (N,)."""


class IntegratedAlbedos:
    """Integrated where they are first asked for, and remembered as curves over the angle. No file is read.

    Stages err by less than 1e-5 of an albedo, volumes by less than 1e-6.
    """

    def stages(self, lobe, control, cos_theta, exponent, count):
        """See `Albedos`."""
        return _stage_curves(lobe, bool(control), float(exponent)).at(cos_theta, count)

    def kinks(self, lobe, control, exponent, pumps):
        """See `Albedos`."""
        return _kinks(lobe, bool(control), float(exponent), float(pumps))

    def volumes(self, mu_view, exponent, radius):
        """See `Albedos`."""
        distance, found = disk.room(np.asarray(mu_view)), np.empty(len(mu_view))
        # Exponent and radius are mostly the same for all views.
        for n, r in np.unique(np.stack([exponent, radius], axis=-1), axis=0):
            chosen = (exponent == n) & (radius == r)
            found[chosen] = _VolumeCurve.of(float(n), float(r)).at(distance[chosen] / r)
        return found


INTEGRATED = IntegratedAlbedos()


@lru_cache(maxsize=_KEPT)
def _stage_curves(lobe, control, exponent):
    return pump_stages.curves(lobe, exponent, control)


@lru_cache(maxsize=_KEPT)
def _kinks(lobe, control, exponent, pumps):
    if not control or not pumps:
        return lobe.kinks
    return (*lobe.kinks, *pump_stages.kinks_of_control(_stage_curves(lobe, control, exponent), pumps))


class _VolumeCurve:
    """Volume of one round lump over the distance of the disk's edge from its centre, in radii, 0 to 1 where it ends.

    The coordinate is even for narrow lumps' logarithms of the distance. Where the edge leaves a lump of exponent n the
    volume ends with the power n + 3/2 of the distance, so nodes crowd there as squares.
    """

    def __init__(self, exponent, radius):
        self._k = 3.0 * np.sqrt(exponent + 1.0)
        u = np.linspace(0.0, 1.0, _VOLUME_NODES)
        distance = np.sinh((1.0 - (1.0 - u) ** 2) * np.arcsinh(self._k)) / self._k
        self._nodes = disk.volume_at(exponent, radius, distance)

    @classmethod
    @lru_cache(maxsize=_KEPT)
    def of(cls, exponent, radius):
        """The curve of a lump, remembered."""
        return cls(exponent, radius)

    def at(self, distance):
        """Volume (N,) at distances (N,); beyond 1 the lump is inside."""
        part = np.arcsinh(self._k * np.clip(distance, 0.0, 1.0)) / np.arcsinh(self._k)
        u = 1.0 - np.sqrt(np.maximum(1.0 - part, 0.0))
        return Reader(u * (_VOLUME_NODES - 1), _VOLUME_NODES).read(self._nodes)
