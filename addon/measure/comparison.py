"""Compares a measurement with a reference and gives the verdict."""
from dataclasses import dataclass

import numpy as np

from ..models.channels import rgb
from ..models.errors import ArgumentError, BrdfError

OK, FAILED, NOISY = "ok", "FAILED", "noisy"
SIGMAS = 5.0  # allowed error in standard errors: one correct row in two million lies beyond


@dataclass(frozen=True)
class Comparison:
    """Rows of RGB: `measured`, its standard error `noise`, and `reference`, all (N, 3).

    `tolerance` is the systematic error allowed on top of SIGMAS times the noise, in the unit of the values.
    """

    measured: np.ndarray
    reference: np.ndarray
    noise: np.ndarray
    tolerance: float

    @property
    def error(self) -> np.ndarray:
        """Measured minus reference, (N, 3)."""
        return self.measured - self.reference

    @property
    def largest(self) -> float:
        """The largest absolute error."""
        return float(np.abs(self.error).max())

    def verdicts(self) -> list:
        """The verdict of each row, N words.

        FAILED where a channel's error exceeds `tolerance` + SIGMAS `noise` or is NaN, NOISY where the noise could hide
        an error of twice the tolerance, else OK.
        """
        allowed = self.tolerance + SIGMAS * self.noise
        good = (np.abs(self.error) <= allowed).all(axis=1)  # False for NaN
        sharp = (allowed <= 3.0 * self.tolerance).all(axis=1)
        return [(OK if s else NOISY) if g else FAILED for g, s in zip(good, sharp, strict=True)]

    @property
    def verdict(self) -> str:
        """The worst verdict of all rows."""
        words = self.verdicts()
        return next(word for word in (FAILED, NOISY, OK) if word in words)


def compare(measured, reference, noise, tolerance: float) -> Comparison:
    """Compares `measured` (N, 3), with its standard error `noise` (N, 3), with `reference` (N,) or (N, 3).

    Raises ValueError where the shapes differ or `tolerance` is not a positive number.
    """
    measured = np.atleast_2d(np.asarray(measured, dtype=np.float64))
    reference = rgb(reference)
    noise = np.atleast_2d(np.asarray(noise, dtype=np.float64))
    if not measured.shape == reference.shape == noise.shape or not len(measured):
        raise BrdfError(f"shapes differ: measured {measured.shape}, reference {reference.shape}, noise {noise.shape}",
                        "shape")
    if not tolerance > 0.0 or not np.isfinite(tolerance):
        raise ArgumentError("tolerance", "range", f"{tolerance} is not a positive number")
    return Comparison(measured, reference, noise, float(tolerance))
