"""Values that have one channel, (N,), or three, (N, 3), linear Rec. 709, brought to either."""
import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def rgb(value) -> np.ndarray:
    """The value as (N, 3), float64."""
    value = np.asarray(value, dtype=np.float64)
    return np.repeat(value[:, None], 3, axis=1) if value.ndim == 1 else value


def mean(value) -> np.ndarray:
    """The mean of the channels, (N,)."""
    value = np.asarray(value)
    return value if value.ndim == 1 else value.mean(axis=1)


def luminance(value) -> np.ndarray:
    """The luminance, (N,)."""
    value = np.asarray(value)
    return value if value.ndim == 1 else value @ LUMINANCE
