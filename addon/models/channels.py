"""Conversions between values with one channel, (N,), and with three, (N, 3), linear Rec. 709."""
import numpy as np

# Weights of R, G, B in the luminance (Rec. 709).
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def rgb(value) -> np.ndarray:
    """`value` (N,) or (N, 3) as (N, 3), float64."""
    value = np.asarray(value, dtype=np.float64)
    return np.repeat(value[:, None], 3, axis=1) if value.ndim == 1 else value


def mean(value) -> np.ndarray:
    """The mean of the channels of `value` (N,) or (N, 3), shape (N,)."""
    value = np.asarray(value)
    return value if value.ndim == 1 else value.mean(axis=1)


def luminance(value) -> np.ndarray:
    """The luminance of `value` (N,) or (N, 3), shape (N,)."""
    value = np.asarray(value)
    return value if value.ndim == 1 else value @ LUMINANCE
