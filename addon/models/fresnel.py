"""The color factor of a reflectance: constant, Schlick's approximation, or the exact reflectance of a conductor."""
import numpy as np

# The choices of a Fresnel factor: indices of the parameter `fresnel_type`.
CONSTANT, SCHLICK, CONDUCTOR = 0, 1, 2
# The least n of a conductor: n = k = 0 would be 0/0 at normal incidence.
LEAST_IOR = 1e-3


def schlick(cos_theta, f0, f90) -> np.ndarray:
    """Schlick's approximation F0 + (F90 - F0)(1 - cos)^5 (Schlick 1994, eq. 15), shape (N, 3).

    `cos_theta` (N,) is V·H in 0..1, `f0` and `f90` (3,) are RGB reflectances.
    """
    mu = np.clip(np.atleast_1d(cos_theta), 0.0, 1.0)[:, None]
    f0, f90 = np.asarray(f0, dtype=np.float64), np.asarray(f90, dtype=np.float64)
    return f0 + (f90 - f0) * (1.0 - mu) ** 5


def conductor(cos_theta, ior, extinction) -> np.ndarray:
    """Exact reflectance of a conductor in air for unpolarized light, shape (N, C).

    `cos_theta` (N,) is V·H in 0..1; `ior` n and `extinction` k, shape (C,), form the complex index n + ik.
    Source: Born & Wolf, Principles of Optics, 7th ed., section 14.2, written as in Lagarde, "Memo on Fresnel
    equations" (2013).
    """
    mu = np.clip(np.atleast_1d(cos_theta), 0.0, 1.0)[:, None]
    n, k = np.maximum(np.asarray(ior, dtype=np.float64), LEAST_IOR), np.asarray(extinction, dtype=np.float64)
    sin2 = 1.0 - mu * mu
    # Perpendicular polarization.
    t0 = n * n - k * k - sin2
    a2b2 = np.sqrt(t0 * t0 + 4.0 * n * n * k * k)
    a = np.sqrt(np.maximum(0.0, 0.5 * (a2b2 + t0)))
    perpendicular = (a2b2 + mu * mu - 2.0 * a * mu) / (a2b2 + mu * mu + 2.0 * a * mu)
    # Parallel polarization.
    t3 = mu * mu * a2b2 + sin2 * sin2
    t4 = 2.0 * a * mu * sin2
    parallel = perpendicular * (t3 - t4) / (t3 + t4)
    return 0.5 * (perpendicular + parallel)


def factor(choice: int, view_dot_half, color, f90, ior, extinction) -> np.ndarray:
    """Color factor (N, 3) for the Fresnel `choice` at V·H (N,).

    CONSTANT: `color`. SCHLICK: from `color` to `f90`. CONDUCTOR: by n = `ior` and k = `extinction`.
    """
    if choice == SCHLICK:
        return schlick(view_dot_half, color, f90)
    if choice == CONDUCTOR:
        return conductor(view_dot_half, ior, extinction)
    return np.broadcast_to(np.asarray(color, dtype=np.float64), (np.size(view_dot_half), 3))


def is_white(p) -> bool:
    """Whether the factor of the resolved parameters `p` is 1 in all channels at all angles."""
    white = (1.0, 1.0, 1.0)
    return p["fresnel_type"] != CONDUCTOR and p["base_color"] == white and (
        p["fresnel_type"] == CONSTANT or p["f90"] == white)
