"""The two lobes that are pumped: a power of R·L (Phong) and a power of N·H (Blinn)."""
import numpy as np

from .geometry import around, dot, half, mirror, reflect

TWO_PI = 2.0 * np.pi


class PhongLobe:
    """Reciprocal Phong: f_0 = (n+2)/(2 pi) max(R·L, 0)^n, Neumann et al. eq. 6 with Lewis' normalisation."""

    id = "phong"

    @staticmethod
    def value(view, light, n):
        """f_0 in 1/sr, shape (N,)."""
        return (n + 2.0) / TWO_PI * np.maximum(dot(mirror(view), light), 0.0) ** n

    @staticmethod
    def pdf(view, light, n):
        """Density of `sample` in 1/sr over the whole sphere, shape (N,)."""
        return (n + 1.0) / TWO_PI * np.maximum(dot(mirror(view), light), 0.0) ** n

    @staticmethod
    def sample(view, u, n):
        """Directions (N, 3) with the density `pdf` from uniform numbers `u` (N, 2); some lie below the horizon."""
        return around(mirror(view), u[:, 0] ** (1.0 / (n + 1.0)), TWO_PI * u[:, 1])

    @staticmethod
    def value_of_angles(view_dot_light, mu_view, mu_light, n):
        """f_0 from V·L and the two cosines; they broadcast."""
        # With V = 2 (N·V) N - R: R·L = 2 (N·V)(N·L) - V·L.
        return (n + 2.0) / TWO_PI * np.maximum(2.0 * mu_view * mu_light - view_dot_light, 0.0) ** n

    @staticmethod
    def azimuths(theta_view, theta_light, n):
        """Scale and end of the lobe over the azimuth from the mirror plane: (scale, end), both in radians."""
        a = np.cos(theta_view) * np.cos(theta_light)
        b = np.maximum(np.sin(theta_view) * np.sin(theta_light), 1e-12)
        scale = np.sqrt(2.0 * np.cos(theta_view - theta_light).clip(1e-12) / (b * n))
        return scale, np.arccos(np.clip(-a / b, -1.0, 1.0))

    @staticmethod
    def reach(n, floor):
        """Angle from the mirror direction at which the lobe has fallen to `floor` of its peak, at most pi/2."""
        return np.arccos(floor ** (1.0 / n))


class HalfVectorLobe:
    """Reciprocal Blinn: f_0 = (n+8)/(8 pi) (N·H)^n, Neumann et al. eq. 6."""

    id = "blinn"

    @staticmethod
    def value(view, light, n):
        """f_0 in 1/sr, shape (N,)."""
        return (n + 8.0) / (8.0 * np.pi) * np.maximum(half(view, light)[:, 2], 0.0) ** n

    @staticmethod
    def pdf(view, light, n):
        """Density of `sample` in 1/sr over the whole sphere, shape (N,)."""
        h = half(view, light)
        # Below the horizon the half vector drawn is the one of h and -h that lies above it: see `sample`.
        return (n + 1.0) / TWO_PI * np.abs(h[:, 2]) ** n / (4.0 * np.maximum(dot(view, h), 1e-12))

    @staticmethod
    def sample(view, u, n):
        """Directions (N, 3) with the density `pdf` from uniform numbers `u` (N, 2); some lie below the horizon.

        Where the half vector drawn faces away from the view, its negative reflects to the same direction, which then
        lies below the horizon.
        """
        normal = np.broadcast_to([0.0, 0.0, 1.0], view.shape)
        return reflect(view, around(normal, u[:, 0] ** (1.0 / (n + 1.0)), TWO_PI * u[:, 1]))

    @staticmethod
    def value_of_angles(view_dot_light, mu_view, mu_light, n):
        """f_0 from V·L and the two cosines; they broadcast."""
        # |V+L|^2 = 2 + 2 V·L and N·(V+L) is the sum of the cosines.
        cos_h = (mu_view + mu_light) / np.sqrt(np.maximum(2.0 + 2.0 * view_dot_light, 1e-24))
        return (n + 8.0) / (8.0 * np.pi) * np.minimum(cos_h, 1.0) ** n

    @staticmethod
    def azimuths(theta_view, theta_light, n):
        """Scale and end of the lobe over the azimuth from the mirror plane: (scale, end), both in radians."""
        b = np.maximum(np.sin(theta_view) * np.sin(theta_light), 1e-12)
        nearest = 1.0 + np.cos(theta_view + theta_light)  # 1 + V·L in the mirror plane
        return np.sqrt(4.0 * np.maximum(nearest, 1e-12) / (b * n)), np.full(b.shape, np.pi)

    @staticmethod
    def reach(n, floor):
        """Angle from the mirror direction at which the lobe has fallen to `floor` of its peak, at most pi."""
        return 2.0 * np.arccos(floor ** (1.0 / n))


PHONG, BLINN = PhongLobe(), HalfVectorLobe()
