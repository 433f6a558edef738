"""The chain of albedos a_0 .. a_3 that pumping needs, for one exponent at a time."""
import numpy as np

from ..brdf import pumping
from ..brdf.quadrature import polar_energy

STAGES = pumping.MAX_PUMPS
_INNER_COLUMNS = 200


class _Curve:
    """Albedos over the angle between the stages: cubic through nodes dense at grazing and at the normal.

    It is much finer than a table and never written; only integrals see it.
    """

    def __init__(self, exponent, count=_INNER_COLUMNS):
        self._k = 3.0 * np.sqrt(exponent)
        self.x = np.linspace(0.0, 1.0, count)
        self.cosine = self.cosine_at(self.x)

    def cosine_at(self, x):
        """Inverse of `coordinate`, by bisection: the coordinate is monotone in the angle from grazing."""
        low, high = np.zeros(len(x)), np.full(len(x), 0.5 * np.pi)
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self.coordinate(np.sin(middle), np.cos(middle)) < x
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(x <= 0.0, 0.0, np.where(x >= 1.0, 1.0, np.sin(0.5 * (low + high))))

    def coordinate(self, cos_theta, sin_theta=None):
        """Where a cosine lies along the nodes, 0..1."""
        if sin_theta is None:
            sin_theta = np.sqrt(np.maximum(0.0, 1.0 - cos_theta * cos_theta))
        return 0.5 * (1.0 + (np.arcsinh(self._k * cos_theta) - np.arcsinh(self._k * sin_theta)) / np.arcsinh(self._k))

    def at(self, nodes, x):
        """Four-point Lagrange interpolation of `nodes` (count, channels) at coordinates `x`."""
        position = np.clip(x, 0.0, 1.0) * (len(nodes) - 1)
        i = np.clip(position.astype(int), 1, len(nodes) - 3)
        t = (position - i)[..., None]
        return (
            nodes[i - 1] * (-t * (t - 1.0) * (t - 2.0) / 6.0)
            + nodes[i] * ((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0)
            + nodes[i + 1] * (-(t + 1.0) * t * (t - 2.0) / 2.0)
            + nodes[i + 2] * ((t + 1.0) * t * (t - 1.0) / 6.0)
        )


def albedo_chain(lobe, exponent: float, cos_theta, control: bool, polar: int = 16, azimuthal: int = 36):
    """Albedos a_0 .. a_3 for views at `cos_theta` (N,) and one exponent, shape (N, 4), float64.

    Stage j+1 is the integral of f_0 (N·L) / D_{j+1}; see `pumping.correction`. Control puts edges into D whose place
    only the chain itself tells: a first pass finds them, a second ends its intervals there.
    """
    curve = _Curve(exponent)
    every = np.concatenate([curve.cosine, np.atleast_1d(cos_theta)])
    if not control:
        return _stages(lobe, exponent, curve, every, control, polar, azimuthal, ())[len(curve.x):]
    coarse = _stages(lobe, exponent, curve, curve.cosine, control, polar=12, azimuthal=24, edges=())
    edges = _control_edges(curve, coarse)
    return _stages(lobe, exponent, curve, every, control, polar, azimuthal, edges)[len(curve.x):]


def _stages(lobe, exponent, curve, mu, control, polar, azimuthal, edges):
    """Albedos of all stages at the views `mu`, which begin with the curve's own."""
    mu_light, energy = polar_energy(lobe, exponent, mu, polar, azimuthal, edges)
    light_x = curve.coordinate(mu_light)
    chain, at_light = np.empty((len(mu), STAGES)), np.empty(light_x.shape + (STAGES,))
    chain[:, 0] = energy.sum(axis=-1)
    for stage in range(1, STAGES):
        at_light[..., stage - 1] = curve.at(chain[: len(curve.x), stage - 1, None], light_x)[..., 0]
        d = pumping.correction(chain[:, None, :], at_light, mu[:, None], mu_light, stage, control)
        chain[:, stage] = (energy / d).sum(axis=-1)
    return chain


def _control_edges(curve, chain, agreement=1e-5):
    """Cosines M at which control sets in or lets go: D_j(M, M) m_j(M) = M, for each stage that is integrated.

    Over a range where both sides are equal within `agreement` (Phong at large n) it does neither; its ends count.
    """
    x = np.linspace(0.0, 1.0, 8 * len(chain))
    albedo, m = curve.at(chain, x), curve.cosine_at(x)
    d, edges = np.ones_like(m), []
    for stage in range(STAGES - 1):
        excess = d * albedo[:, stage] - m
        side = np.where(np.abs(excess) > agreement * m, np.sign(excess), 0.0)
        edges.extend(m[np.nonzero(np.diff(side))[0]])
        d = np.maximum(d * albedo[:, stage], m)
    return sorted(set(edges))
