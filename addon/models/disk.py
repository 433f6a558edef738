"""The halfway vector disk: half vectors as points of a unit disk, and lumps as densities on it.

For a view V, the hemisphere of lights L is moved so that the center of its base is the tip of V. Every V+L then ends on
this hemisphere. It is projected to the base, the unit disk about the in-plane part of V. A density p on the disk yields
the BRDF f = p(h) (dh/dH) / (4 (N·L)(L·H)) (eq. 11). Its albedo is p's volume inside the disk. It is not reciprocal.

Source: Edwards, Boulos, Johnson, Shirley, Ashikhmin, Stark, Wyman, "The halfway vector disk for BRDF modeling", 2006.
Equation numbers are those of this paper. Points are (u, v), the in-plane components along x and y of the local frame.
"""
from dataclasses import dataclass

import numpy as np

from .geometry import dot, half, normalize, reflect

TWO_PI = 2.0 * np.pi


class Scaling:
    """The projection that scales V+L until it ends in the base: h = (N·V) / (N·H) H (eq. 15)."""

    id = "scaling"

    @staticmethod
    def point(view, light):
        """h (N, 2) for views and lights (N, 3) above the horizon."""
        total = view + light
        return view[:, 2:] / total[:, 2:] * total[:, :2]

    @staticmethod
    def measure(view, light):
        """dh / dH (N,): (N·V)^2 / (N·H)^3 (eq. 19)."""
        return view[:, 2] ** 2 / half(view, light)[:, 2] ** 3

    @staticmethod
    def light(view, point):
        """The light (N, 3) whose h is `point` (eq. 21, 13). For points outside the disk it is below the horizon."""
        h = normalize(np.concatenate([point, view[:, 2:]], axis=1))
        return reflect(view, h)

    @staticmethod
    def reached(view, light):
        """(h (N, 2), density of lights per density of h (N,)), for lights anywhere that `light` sends points to."""
        # h of lights in either hemisphere.
        total = view + light
        up = np.where(np.abs(total[:, 2]) > 1e-300, total[:, 2], 1e-300)
        h = view[:, 2:] / up[:, None] * total[:, :2]
        axis = normalize(np.concatenate([h, view[:, 2:]], axis=1))
        # Two half vectors reflect the view to a light. `light` uses the one above the base, whose V·H may be negative.
        return h, view[:, 2] ** 2 / axis[:, 2] ** 3 / (4.0 * np.maximum(np.abs(dot(view, axis)), 1e-300))


class Orthogonal:
    """The projection of V+L along the normal: h is the sum of the in-plane parts of V and L (eq. 22)."""

    id = "orthogonal"

    @staticmethod
    def point(view, light):
        """h (N, 2) for views and lights (N, 3)."""
        return view[:, :2] + light[:, :2]

    @staticmethod
    def measure(view, light):
        """dh / dH (N,): |V+L|^2 (N·L) / (L·H) (eq. 23)."""
        total = view + light
        return dot(total, total) * light[:, 2] / np.maximum(dot(light, half(view, light)), 1e-300)

    @staticmethod
    def light(view, point):
        """The light (N, 3) whose h is `point` (eq. 25).

        A point outside the disk has no light. It is inverted in the disk's rim, and the light is the mirror image,
        below the horizon, of the inverted point's light.
        """
        plane = point - view[:, :2]
        squared = dot(plane, plane)
        inside = squared <= 1.0
        plane = np.where(inside[:, None], plane, plane / np.maximum(squared, 1.0)[:, None])
        height = np.sqrt(np.maximum(1.0 - dot(plane, plane), 0.0))
        return np.concatenate([plane, np.where(inside, height, -height)[:, None]], axis=1)

    @staticmethod
    def reached(view, light):
        """(h (N, 2), density of lights per density of h (N,)), for lights anywhere that `light` sends points to."""
        squared = np.maximum(dot(light[:, :2], light[:, :2]), 1e-300)
        below = light[:, 2] < 0.0
        plane = np.where(below[:, None], light[:, :2] / squared[:, None], light[:, :2])
        return view[:, :2] + plane, np.abs(light[:, 2]) / np.where(below, squared**2, 1.0)


SCALING, ORTHOGONAL = Scaling(), Orthogonal()


@dataclass(frozen=True)
class Lump:
    """p(h) = (n+1) / (pi R_u R_v) [1 - x^2 - y^2]^n inside the unit circle of x and y.

    Here x = (h_u - c_u) / R_u and y = (h_v - c_v) / R_v. The axes of x and y are turned by `turn` radians from u to v.
    The volume of p is 1. Fields are the same for all rows or have one entry per row: `centre` c (2,) or (N, 2), `radii`
    R (2,) or (N, 2), `exponent` n, a number or (N,). Source: eq. 26 and 27.
    """

    centre: object
    radii: object
    exponent: object
    turn: float = 0.0

    def _axes(self):
        """The matrix (2, 2) that turns a vector in the disk into the lump's own axes."""
        cos, sin = np.cos(self.turn), np.sin(self.turn)
        return np.array([[cos, sin], [-sin, cos]])

    def density(self, point) -> np.ndarray:
        """p(h), (N,) at `point` (N, 2)."""
        radii = np.asarray(self.radii, dtype=np.float64)
        at = (point - self.centre) @ self._axes().T / radii
        inside = 1.0 - dot(at, at)
        n = np.asarray(self.exponent, dtype=np.float64)
        power = np.where(inside > 0.0, np.maximum(inside, 0.0) ** n, 0.0)  # 0 at the rim, also for n = 0
        return (n + 1.0) / (np.pi * radii[..., 0] * radii[..., 1]) * power

    def sample(self, u) -> np.ndarray:
        """Points (N, 2) with this density, from uniform numbers `u` (N, 2) (eq. 28, 29, scaled by both radii)."""
        n = np.asarray(self.exponent, dtype=np.float64)
        # 1 - u^(1/(n+1)) without cancellation.
        r = np.sqrt(-np.expm1(np.log(np.maximum(u[:, 0], 1e-300)) / (n + 1.0)))
        around = np.stack([r * np.cos(TWO_PI * u[:, 1]), r * np.sin(TWO_PI * u[:, 1])], axis=-1)
        return self.centre + (around * self.radii) @ self._axes()

    def volume(self, disk_centre, order: int = 8) -> np.ndarray:
        """Volume (N,) inside the unit disk about `disk_centre` (N, 2), which must contain the lump's center.

        Along each direction from the lump's center the density has an integral in closed form. Its mean over the
        directions is by Gauss-Legendre panels of `order` nodes, which are narrow where the disk's rim crosses the lump.
        """
        # One row for each disk. `away` is the lump's center relative to the disk's, in the lump's axes.
        disk_centre = np.atleast_2d(disk_centre)
        rows = len(disk_centre)
        radii = np.broadcast_to(self.radii, (rows, 2))
        n = np.broadcast_to(np.asarray(self.exponent, dtype=np.float64), (rows,))
        away = (np.broadcast_to(self.centre, (rows, 2)) - disk_centre) @ self._axes().T
        # The direction of the nearest point of the disk's rim. With the radii as units, the directions at a right angle
        # to it are parallel to the rim there.
        nearest = np.arctan2(away[:, 1] * radii[:, 1], away[:, 0] * radii[:, 0])
        nodes, weights = _directions(_crossing(np.sqrt(dot(away, away)), radii), order)
        phi = nearest[:, None] + nodes
        # The distance to the disk's rim along each direction, with the radii as units: the positive root of
        # a r^2 + 2 b r + c, without cancellation.
        step = np.stack([np.cos(phi), np.sin(phi)], axis=-1) * radii[:, None, :]
        a, b = dot(step, step), np.einsum("rdi,ri->rd", step, away)
        c = np.minimum(dot(away, away) - 1.0, 0.0)[:, None]
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        reach = np.where(b > 0.0, -c / np.maximum(b + root, 1e-300), (root - b) / a)
        # The volume beyond the rim, as a fraction of each direction's volume.
        outside = np.maximum(1.0 - np.minimum(reach, 1.0) ** 2, 0.0) ** (n[:, None] + 1.0)
        return 1.0 - dot(outside, weights)


def volume_at(exponent: float, radius: float, distance, order: int = 8) -> np.ndarray:
    """Volume (N,) of a round lump inside the disk. Its center is `distance` (N,), in its radii, from the rim."""
    disk_centre = np.stack([1.0 - distance * radius, np.zeros_like(distance)], axis=-1)
    return Lump(np.zeros(2), np.array([radius, radius]), exponent).volume(disk_centre, order)


def _crossing(distance, radii):
    """Angle (N,) from the nearest direction at which a round lump's rim crosses the disk's, else a right angle."""
    cosine = (1.0 - distance**2 - radii[:, 0] ** 2) / np.maximum(2.0 * distance * radii[:, 0], 1e-300)
    round_and_cut = (radii[:, 0] == radii[:, 1]) & (np.abs(cosine) < 1.0)
    return np.where(round_and_cut, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.5 * np.pi)


def _directions(crossing, order, panels=40):
    """Angles from -pi to pi and weights of a mean over them, both (N, nodes).

    The Gauss-Legendre panels narrow toward 0 and toward both right angles. One more panel ends at `crossing` (N,).
    """
    # The ends of the panels from 0 to pi.
    x, w = np.polynomial.legendre.leggauss(order)
    narrow = np.geomspace(1e-5, 1.0, panels // 2)
    quarter = 0.5 * np.pi
    near = quarter * np.concatenate([[0.0], 0.5 * narrow, 1.0 - 0.5 * narrow[::-1][1:], [1.0]])
    edges = np.concatenate([near, 2.0 * quarter - near[::-1][1:]])
    edges = np.sort(np.concatenate([np.tile(edges, (len(crossing), 1)), crossing[:, None]], axis=1), axis=1)
    width = np.diff(edges, axis=1)[..., None]
    s = 0.5 * (x + 1.0)
    # x = s² (3 - 2 s) flattens the integrand at both ends of a panel, where it may behave like a square root.
    angles = (edges[:, :-1, None] + width * (s * s * (3.0 - 2.0 * s))).reshape(len(crossing), -1)
    weights = (width * (3.0 * w * s * (1.0 - s))).reshape(len(crossing), -1) / TWO_PI
    return np.concatenate([-angles, angles], axis=1), np.concatenate([weights, weights], axis=1)


def value(projection, density, view, light):
    """f (N,) in 1/sr for `density` (N,) = p(h), and views and lights (N, 3) above the horizon (eq. 11)."""
    return (density * projection.measure(view, light)
            / (4.0 * light[:, 2] * np.maximum(dot(light, half(view, light)), 1e-300)))


def room(mu_view):
    """Largest radius of a lump about the origin that lies inside the disk at N·V = `mu_view`: 1 - sin theta (eq. 32).

    Computed as cos^2 / (1 + sin), without cancellation.
    """
    return mu_view**2 / (1.0 + np.sqrt(np.maximum(1.0 - mu_view**2, 0.0)))


def held_radii(radii, allowed):
    """`radii` (2,), both multiplied by one factor so that the larger is at most `allowed` (N,): (N, 2)."""
    radii = np.asarray(radii, dtype=np.float64)
    return radii * np.minimum(1.0, allowed / radii.max())[:, None]
