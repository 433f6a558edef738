"""Directions in the local frame: +z is the shading normal, `view` and `light` are unit vectors of shape (N, 3)."""
import numpy as np

from .errors import ArgumentError


def directions(name: str, value) -> np.ndarray:
    """Returns `value` as unit vectors (N, 3), float64. `name` is the argument's name in messages.

    Raises ArgumentError if the shape is wrong, a component is not finite, or a length differs from 1 by more than 1e-4.
    """
    # Type and shape.
    try:
        array = np.atleast_2d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError):
        raise ArgumentError(name, "type", f"expected unit vectors of shape (N, 3), got {value!r}") from None
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError(name, "shape", f"expected unit vectors of shape (N, 3), got shape {np.shape(value)}")
    # Components and lengths.
    if not np.isfinite(array).all():
        bad = array[~np.isfinite(array).all(axis=1)][0]
        raise ArgumentError(name, "finite", f"every component must be finite, got {bad.tolist()}")
    length = np.linalg.norm(array, axis=1)
    if np.any(np.abs(length - 1.0) > 1e-4):
        raise ArgumentError(name, "length", "expected unit vectors, got lengths "
                            f"{length.min():.6g} to {length.max():.6g}")
    return array / length[:, None]


def paired(first: str, a: np.ndarray, second: str, b: np.ndarray):
    """`a` and `b` broadcast to the same number of rows. One row stands for all.

    Raises ArgumentError with the names `first` and `second` if the numbers of rows differ and neither is 1.
    """
    if len(a) != len(b) and 1 not in (len(a), len(b)):
        raise ArgumentError(f"{first}, {second}", "rows",
                            f"expected equally many rows, or one for all, got {len(a)} and {len(b)}")
    rows = len(b) if len(a) == 1 else len(a)
    return np.broadcast_to(a, (rows, a.shape[1])), np.broadcast_to(b, (rows, b.shape[1]))


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar products of the rows of `a` and `b`, shape (N,)."""
    return np.einsum("...i,...i->...", a, b)


def normalize(a: np.ndarray) -> np.ndarray:
    """Rows of `a` scaled to length 1. A zero vector becomes the normal."""
    length = np.linalg.norm(a, axis=-1, keepdims=True)
    return np.where(length > 0.0, a / np.where(length > 0.0, length, 1.0), [0.0, 0.0, 1.0])


def half(view: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Half vector (V+L)/|V+L|, shape (N, 3)."""
    return normalize(view + light)


def mirror(view: np.ndarray) -> np.ndarray:
    """Mirror direction R of `view` about the normal, shape (N, 3)."""
    return view * [-1.0, -1.0, 1.0]


def reflect(view: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """`view` reflected about the unit vectors `axis`, shape (N, 3)."""
    return 2.0 * dot(view, axis)[..., None] * axis - view


def view_at(cos_theta) -> np.ndarray:
    """View directions in the x-z plane with the cosines `cos_theta`, shape (N, 3)."""
    mu = np.atleast_1d(np.asarray(cos_theta, dtype=np.float64))
    return np.stack([np.sqrt(np.maximum(0.0, 1.0 - mu * mu)), np.zeros_like(mu), mu], axis=-1)


def in_plane(angle) -> np.ndarray:
    """Directions (N, 3) in the x-z plane, at `angle` (N,) in degrees from the normal toward +x."""
    angle = np.radians(np.atleast_1d(np.asarray(angle, dtype=np.float64)))
    return np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)


def around(axis: np.ndarray, cos_delta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Directions at the angle acos(cos_delta) from the unit vectors `axis` and at the azimuth `phi`, shape (N, 3).

    The frame about the axis is continuous except at the axis -z (Duff et al. 2017, "Building an Orthonormal Basis,
    Revisited").
    """
    # An orthonormal basis about the axis.
    x, y, z = axis[..., 0], axis[..., 1], axis[..., 2]
    sign = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + z)
    b = x * y * a
    tangent = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    bitangent = np.stack([b, sign + y * y * a, -y], axis=-1)
    # The direction's components in this basis.
    sin_delta = np.sqrt(np.maximum(0.0, 1.0 - cos_delta * cos_delta))
    return (
        (sin_delta * np.cos(phi))[..., None] * tangent
        + (sin_delta * np.sin(phi))[..., None] * bitangent
        + cos_delta[..., None] * axis
    )
