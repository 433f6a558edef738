"""The lobes that LobeModel pumps: a power of R·L (Phong), a power of N·H (Blinn), a reciprocal lump on the disk.

All have the same members:

- `value`: f_0 of views and lights. `pdf` and `sample`: a distribution that resembles it.
- `value_of_angles`, `azimuths`, `reach`, `ends`: what quadrature.py needs to place nodes and to evaluate f_0 at them.
- `ends_steeply`: whether f_0 falls to 0 like a square root at the end of its azimuths.
- `steepest`: the largest angle of a view, in radians.
- `kinks`: cosines of the view at which the albedo has a kink.
"""
import numpy as np

from . import disk
from .geometry import around, dot, half, mirror, reflect
from .samplers import AxisPower

TWO_PI = 2.0 * np.pi


class PhongLobe:
    """Reciprocal Phong: f_0 = (n+2)/(2 pi) max(R·L, 0)^n, Neumann et al. eq. 6 with Lewis' normalization."""

    id = "phong"
    ends_steeply = False
    steepest = 0.5 * np.pi
    kinks = ()

    @staticmethod
    def value(view, light, n):
        """f_0 in 1/sr, shape (N,)."""
        return (n + 2.0) / TWO_PI * np.maximum(dot(mirror(view), light), 0.0) ** n

    @staticmethod
    def pdf(view, light, n):
        """Density of `sample` in 1/sr over the whole sphere, shape (N,)."""
        return AxisPower(mirror, n).pdf(view, light)

    @staticmethod
    def sample(view, u, n):
        """Directions (N, 3) with the density `pdf` from uniform numbers `u` (N, 2); some lie below the horizon."""
        return AxisPower(mirror, n).sample(view, u)

    @staticmethod
    def value_of_angles(across2, mu_view, mu_light, n):
        """f_0 from the squared length of the in-plane part of V+L and the two cosines; they broadcast."""
        # The in-plane parts of R and V are opposite: |R-L|^2 = across2 + (N·V - N·L)^2 = 2 - 2 R·L.
        mirror_dot_light = 1.0 - 0.5 * (across2 + (mu_view - mu_light) ** 2)
        return (n + 2.0) / TWO_PI * np.maximum(mirror_dot_light, 0.0) ** n

    @staticmethod
    def azimuths(theta_view, theta_light, n):
        """Scale and end of the lobe over the azimuth from the mirror plane: (scale, end), both in radians."""
        a = np.cos(theta_view) * np.cos(theta_light)
        b = np.maximum(np.sin(theta_view) * np.sin(theta_light), 1e-12)
        scale = np.sqrt(2.0 * np.cos(theta_view - theta_light).clip(1e-12) / (b * n))
        return scale, np.arccos(np.clip(-a / b, -1.0, 1.0))

    @staticmethod
    def reach(n, floor, theta=0.0):
        """Angle from the mirror direction at which the lobe has fallen to `floor` of its peak, at most pi/2."""
        return np.arccos(floor ** (1.0 / n))

    @staticmethod
    def ends(theta):
        """Light angles, other than those of `reach`, at which the lobe ends for a view at `theta`: none."""
        return []

    @staticmethod
    def half_vector_exponent(n):
        """Exponent of the half-vector power of the same width."""
        return 4.0 * n


class HalfVectorLobe:
    """Reciprocal Blinn: f_0 = (n+8)/(8 pi) (N·H)^n, Neumann et al. eq. 6."""

    id = "blinn"
    ends_steeply = False
    steepest = 0.5 * np.pi
    kinks = ()

    @staticmethod
    def value(view, light, n):
        """f_0 in 1/sr, shape (N,)."""
        return (n + 8.0) / (8.0 * np.pi) * np.maximum(half(view, light)[:, 2], 0.0) ** n

    @staticmethod
    def pdf(view, light, n):
        """Density of `sample` in 1/sr over the whole sphere, shape (N,)."""
        h = half(view, light)
        # The sampled half vector is the one of h and -h that is above the horizon: see `sample`.
        return (n + 1.0) / TWO_PI * np.abs(h[:, 2]) ** n / (4.0 * np.maximum(dot(view, h), 1e-12))

    @staticmethod
    def sample(view, u, n):
        """Directions (N, 3) with the density `pdf` from uniform numbers `u` (N, 2); some lie below the horizon.

        A sampled half vector that faces away from the view reflects to a direction below the horizon. Its negative
        reflects to the same direction.
        """
        normal = np.broadcast_to([0.0, 0.0, 1.0], view.shape)
        return reflect(view, around(normal, u[:, 0] ** (1.0 / (n + 1.0)), TWO_PI * u[:, 1]))

    @staticmethod
    def value_of_angles(across2, mu_view, mu_light, n):
        """f_0 from the squared length of the in-plane part of V+L and the two cosines; they broadcast."""
        up2 = np.maximum((mu_view + mu_light) ** 2, 1e-300)
        return (n + 8.0) / (8.0 * np.pi) * (1.0 + across2 / up2) ** (-0.5 * n)

    @staticmethod
    def azimuths(theta_view, theta_light, n):
        """Scale and end of the lobe over the azimuth from the mirror plane: (scale, end), both in radians."""
        b = np.maximum(np.sin(theta_view) * np.sin(theta_light), 1e-12)
        nearest = 1.0 + np.cos(theta_view + theta_light)  # 1 + V·L in the mirror plane
        return np.sqrt(4.0 * np.maximum(nearest, 1e-12) / (b * n)), np.full(b.shape, np.pi)

    @staticmethod
    def reach(n, floor, theta=0.0):
        """Angle from the mirror direction at which the lobe has fallen to `floor` of its peak, at most pi."""
        return 2.0 * np.arccos(floor ** (1.0 / n))

    @staticmethod
    def ends(theta):
        """Light angles, other than those of `reach`, at which the lobe ends for a view at `theta`: none."""
        return []

    @staticmethod
    def half_vector_exponent(n):
        """Exponent of the half-vector power of the same width."""
        return n


class ReciprocalDiskLobe:
    """A lump on the halfway vector disk made reciprocal: f_0 = sqrt(f(V, L) f(L, V)).

    f is the BRDF, by the scaling projection (Edwards et al. eq. 20), of the largest round lump about the origin that
    lies inside the disk. |h| = (N·V) tan(theta_h) relative to the radius 1 - sin(theta_v) is tan(theta_h) /
    tan(45° - theta_v/2). The lobe therefore ends where the half vector is 45° - theta/2 from the normal, with theta the
    larger of the angles of view and light.
    """

    id = "disk"
    ends_steeply = True  # for small exponents
    steepest = 0.5 * np.pi - 1e-4  # at grazing the lobe shrinks to a point; its shape does not change
    kinks = (np.cos(np.pi / 6.0),)  # all angles of `ends` are equal there

    @staticmethod
    def value(view, light, n):
        """f_0 in 1/sr, shape (N,), for views and lights above the horizon."""
        across = (view + light)[:, :2]
        return ReciprocalDiskLobe.value_of_angles(dot(across, across), view[:, 2], light[:, 2], n)

    @staticmethod
    def _lump(mu_view, n):
        """The largest round lumps about the origin that lie inside the disk at N·V = `mu_view` (N,)."""
        return disk.Lump(np.zeros(2), disk.room(mu_view)[:, None] * np.ones(2), n)

    @staticmethod
    def pdf(view, light, n):
        """Density of `sample` in 1/sr over the whole sphere, shape (N,)."""
        point, density = disk.SCALING.reached(view, light)
        return ReciprocalDiskLobe._lump(view[:, 2], n).density(point) * density

    @staticmethod
    def sample(view, u, n):
        """Directions (N, 3) with the density `pdf` from uniform numbers `u` (N, 2): samples of f's lump."""
        return disk.SCALING.light(view, ReciprocalDiskLobe._lump(view[:, 2], n).sample(u))

    @staticmethod
    def value_of_angles(across2, mu_view, mu_light, n):
        """f_0 from the squared length of the in-plane part of V+L and the two cosines; they broadcast."""
        up2 = np.maximum((mu_view + mu_light) ** 2, 1e-300)
        # The product of both lumps' densities, each times the squared cosine.
        tan2 = across2 / up2
        product = 1.0
        for mu in (mu_view, mu_light):
            slope2 = np.maximum((disk.room(mu) / np.maximum(mu, 1e-150)) ** 2, 1e-300)
            product = product * (n + 1.0) / np.pi / slope2 * np.maximum(1.0 - tan2 / slope2, 0.0) ** n
        # The common denominator, with L·H = |V+L| / 2 and N·H = (N·V + N·L) / |V+L|.
        squared = across2 + up2
        shared = 2.0 * np.sqrt(np.maximum(mu_view * mu_light, 1e-300)) * up2**1.5 / squared
        return np.sqrt(product) / shared

    @staticmethod
    def azimuths(theta_view, theta_light, n):
        """Scale and end of the lobe over the azimuth from the mirror plane: (scale, end), both in radians."""
        b = np.maximum(np.sin(theta_view) * np.sin(theta_light), 1e-12)
        slope2 = np.tan(0.25 * np.pi - 0.5 * np.maximum(theta_view, theta_light)) ** 2
        # The end: tan^2 of the half vector's angle is slope^2. Solved for sin^2 of half the azimuth, without
        # cancellation.
        mean2 = np.cos(0.5 * (theta_view + theta_light)) ** 2
        apart2 = np.sin(0.5 * (theta_view - theta_light)) ** 2
        sin2 = mean2 * np.maximum(slope2 - (1.0 + slope2) * apart2, 0.0) / b
        end = 2.0 * np.arcsin(np.sqrt(np.minimum(sin2, 1.0)))
        return 2.0 * np.sqrt(slope2 * mean2 / (b * (n + 1.0))) + 1e-30, end

    @staticmethod
    def reach(n, floor, theta=0.0):
        """Angle from the mirror direction at which the lobe has fallen to `floor` of its peak, view at `theta`."""
        widest = np.tan(0.25 * np.pi - 0.5 * np.asarray(theta)) * np.sqrt(1.0 - floor ** (1.0 / n))
        return 2.0 * np.arctan(widest)

    @staticmethod
    def ends(theta):
        """Light angles, other than those of `reach`, at which the lobe ends for a view at `theta`.

        On the mirror direction's side of the plane of incidence, the lobe ends with the lump of the light, which is the
        smaller one there. On the view's side it ends with either lump. At smaller light angles the lobe covers all
        azimuths.
        """
        quarter = 0.25 * np.pi
        return [quarter + 0.5 * theta, 2.0 * (quarter - theta), quarter - 0.5 * theta]

    @staticmethod
    def half_vector_exponent(n):
        """Exponent of the half-vector power of the same width at normal incidence."""
        return 2.0 * n


PHONG, BLINN, DISK = PhongLobe(), HalfVectorLobe(), ReciprocalDiskLobe()
