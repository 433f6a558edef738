"""Reference albedos for the tests: the formulas written again, and integrated in another way than in the package.

The package integrates over the light's angle. Here an integral runs over the lobe itself: over the angle `delta` from
the lobe's axis (of the light for Phong, of the half vector for Blinn) and around the axis. This module imports nothing
from the package.
"""
import numpy as np
from scipy import integrate, interpolate

LOBES = ("phong", "blinn")


def view_at(mu):
    """Unit view (3,) in the x-z plane at N·V = mu."""
    return np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])


def f0(lobe, view, light, n):
    """The unpumped lobes, DESIGN section 2, for broadcasting (..., 3) directions."""
    if lobe == "phong":
        along_mirror = view[..., 2] * light[..., 2] - view[..., 0] * light[..., 0] - view[..., 1] * light[..., 1]
        return (n + 2.0) / (2.0 * np.pi) * np.clip(along_mirror, 0.0, None) ** n
    between = view + light
    cos_h = np.clip(between[..., 2] / np.sqrt((between**2).sum(-1)), 0.0, None)
    return (n + 8.0) / (8.0 * np.pi) * cos_h**n


def exact_a0(lobe, mu, n):
    """Albedo of an unpumped lobe to about 1e-9: the integral around the axis in closed form, the other by SciPy.

    With A + B cos(psi) the cosine between the direction at (delta, psi) and the normal (Phong) or the view (Blinn), the
    light lies above the horizon up to psi = end.
    """
    theta = np.arccos(mu)

    def ring(delta):
        a, b = np.cos(delta) * np.cos(theta), np.sin(delta) * np.sin(theta)
        edge = 0.0 if lobe == "phong" else np.cos(theta) / (2.0 * max(np.cos(delta), 1e-300))
        end = np.arccos(np.clip((edge - a) / max(b, 1e-300), -1.0, 1.0))
        first = a * end + b * np.sin(end)
        if lobe == "phong":
            return (n + 2.0) / np.pi * np.cos(delta) ** n * np.sin(delta) * first
        # dL = 4 (V·H) dH and N·L = 2 (V·H)(N·H) - N·V.
        second = a * a * end + 2.0 * a * b * np.sin(end) + b * b * (0.5 * end + 0.25 * np.sin(2.0 * end))
        power = (n + 8.0) / (4.0 * np.pi) * np.cos(delta) ** n * np.sin(delta)
        return power * 4.0 * (2.0 * np.cos(delta) * second - np.cos(theta) * first)

    width = np.arccos(1e-16 ** (1.0 / n))
    horizon = 0.5 * np.pi - theta if lobe == "phong" else 0.5 * abs(0.5 * np.pi - theta)
    cuts = sorted({0.0, width, *(x for x in (width / 8.0, horizon, theta) if 0.0 < x < width)})
    return sum(integrate.quad(ring, low, high, epsrel=1e-10, limit=200)[0]
               for low, high in zip(cuts, cuts[1:], strict=False))


def lobe_nodes(lobe, mu, n, rings=240, turns=120, whole=True):
    """Lights (N, 3) and solid angles (N,) that cover a lobe down to 1e-7 of its peak, by the midpoint rule.

    Where not `whole`, they lie on one side of the plane of incidence and count twice. Some lights are below the horizon
    and have their true solid angle: the integrand must be 0 there, or the integral is over the whole sphere.
    """
    view = view_at(mu)
    width = np.arccos(1e-7 ** (1.0 / n)) if lobe == "blinn" or n > 12.0 else 0.5 * np.pi
    delta = (np.arange(rings) + 0.5) * width / rings
    psi = (np.arange(turns) + 0.5) * (2.0 if whole else 1.0) * np.pi / turns
    delta, psi = (x.ravel() for x in np.meshgrid(delta, psi, indexing="ij"))
    area = np.sin(delta) * (width / rings) * (2.0 * np.pi / turns)
    local = np.stack([np.sin(delta) * np.cos(psi), np.sin(delta) * np.sin(psi), np.cos(delta)], -1)
    if lobe == "blinn":
        facing = local @ view
        return 2.0 * facing[:, None] * local - view, 4.0 * np.abs(facing) * area
    # The mirror direction's frame, one axis a row.
    frame = np.array([[view[2], 0.0, view[0]], [0.0, 1.0, 0.0], [-view[0], 0.0, view[2]]])
    return local @ frame, area


def albedo(evaluate, lobe, mu, n, rings=400, turns=80):
    """Integral of evaluate(view (1, 3), lights (N, 3)) N·L over the hemisphere: a number, or one for each channel."""
    light, area = lobe_nodes(lobe, mu, n, rings, turns, whole=False)
    value = evaluate(view_at(mu)[None], light)
    return np.einsum("n,n...->...", area * np.clip(light[:, 2], 0.0, None), value)


class Chain:
    """a_0 .. a_3 of a lobe as curves over the view's angle, from eq. 16, 20 and eq. 21, read as cumulative."""

    def __init__(self, lobe, n, control, stages=4, views=90):
        self.lobe, self.n, self.control = lobe, n, control
        theta = 0.5 * np.pi * np.linspace(0.0, 1.0, views) ** 0.7  # denser towards grazing
        mu = np.cos(theta)
        mu[-1] = 0.0
        self._theta, self.curves = theta, []
        for stage in range(stages):
            a = [self.albedo(m, stage, rings=200, turns=60) for m in mu]
            self.curves.append(interpolate.PchipInterpolator(theta, a))

    def albedo(self, mu, pumps, rings=400, turns=80):
        """Albedo after `pumps`, integrated at one cosine."""
        return albedo(lambda v, light: f0(self.lobe, v, light, self.n) / self.d(v, light, pumps), self.lobe, mu, self.n,
                      rings, turns)

    def at(self, mu, stage):
        """a_stage from its interpolated curve: fast, with errors up to 1e-3 where control bends the curve."""
        return self.curves[stage](np.arccos(np.clip(mu, 0.0, 1.0)))

    def d(self, view, light, pumps):
        """Correction term for `pumps`, a number from 0 to 4."""
        mu_v, mu_l = view[..., 2], light[..., 2]
        result = np.ones(np.broadcast_shapes(mu_v.shape, mu_l.shape))
        stage = 0
        while pumps > stage:
            m = np.where(self.at(mu_v, stage) > self.at(mu_l, stage), self.at(mu_v, stage), self.at(mu_l, stage))
            result = result * m ** min(1.0, pumps - stage)
            if self.control:
                result = np.stack(np.broadcast_arrays(result, mu_v, mu_l)).max(0)
            stage += 1
        return result


class Grid:
    """a_0 .. a_3 on one grid of view and light angles, for wide lobes: at n = 20 to about 1e-6 up to 80 degrees.

    The rule over the azimuth is trapezoidal. The rule over the light's angle is Simpson's, in two parts that meet at
    the view's angle, where D has an edge. `curves` (stages, angles) are the albedos at `cosines`.
    """

    def __init__(self, lobe, n, control, stages=4, count=513, turns=96):
        theta = np.linspace(0.0, 0.5 * np.pi, count)
        self.cosines = mu = np.cos(theta)
        phi = np.pi * np.arange(turns + 1) / turns
        share = np.where((phi == 0.0) | (phi == np.pi), 1.0, 2.0) * np.pi / turns
        sine = np.sin(theta)
        light = np.stack(np.broadcast_arrays(sine[:, None] * np.cos(phi), sine[:, None] * np.sin(phi), mu[:, None]), -1)
        energy = np.array([f0(lobe, view_at(m), light, n) @ share for m in mu]) * mu * sine
        self.curves, d = [], np.ones((count, count))
        for _ in range(stages):
            a = np.array([_from_both_sides(row, i, theta[1]) for i, row in enumerate(energy / d)])
            self.curves.append(a)
            d = d * np.maximum(a[:, None], a)
            if control:
                d = np.maximum(d, np.maximum(mu[:, None], mu))
        self.curves = np.array(self.curves)


def _from_both_sides(row, i, step):
    """Integral of values (N,) at evenly spaced nodes, with an edge at node `i`."""
    return sum(integrate.simpson(part, dx=step) for part in (row[: i + 1], row[i:]) if len(part) > 1)
