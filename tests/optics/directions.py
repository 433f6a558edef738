"""Unit vectors and their histograms; z is the normal, x the tangent."""
import numpy as np


def toward(angle_deg, azimuth_deg=0.0):
    """Unit vectors (N, 3), or (3,), at `angle_deg` from the normal and `azimuth_deg` from the tangent."""
    theta, phi = np.radians(np.broadcast_arrays(angle_deg, azimuth_deg))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def directions(count, seed, least=0.02):
    """Random unit vectors (count, 3) with z above `least`; a fifth of them lie near the horizon."""
    rng = np.random.default_rng(seed)
    mu = rng.uniform(least, 1.0, count)
    mu[::5] = rng.uniform(least, 0.1, len(mu[::5]))
    phi = rng.uniform(0.0, 2.0 * np.pi, count)
    s = np.sqrt(1.0 - mu * mu)
    return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)


def cosines(angles_deg):
    """Cosines of angles in degrees."""
    return np.cos(np.radians(angles_deg))


def rgb(values):
    """Values (N,) or (N, 3) as (N, 3)."""
    values = np.asarray(values, dtype=np.float64)
    return values if values.ndim == 2 else np.repeat(values[:, None], 3, axis=1)


def binned(light, weights=None):
    """Histogram (120,) of lights over 10 heights and 12 turns."""
    turn = np.arctan2(light[:, 1], light[:, 0])
    return np.histogram2d(light[:, 2], turn, (10, 12), ((-1.0, 1.0), (-np.pi, np.pi)), weights=weights)[0].ravel()
