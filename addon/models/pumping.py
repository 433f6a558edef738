"""Albedo pumping-up: the correction term D that divides a symmetric function f_0.

Source: Neumann, Neumann, Szirmay-Kalos, "Albedo pumping-up", section 3. Each stage divides the previous stage by a
legal correction term (inequality 17), so that D_{j+1} = D_j m_j with m_j = max(a_j(L), a_j(V)) (eq. 20). Control
(eq. 21) is cumulative here: D_{j+1} = max(D_j m_j, N·L, N·V). A fraction s of a stage uses m_j^s, which is legal since
m_j <= m_j^s <= 1. Where m_j > 1 (Blinn), inequality 17 has no solution, and m_j^s interpolates geometrically.

D depends on N·V and N·L only. A stage's albedo is therefore an integral over the light's polar angle of f_0's sums over
the azimuth. `stage_albedos` takes those sums once, and divides them by the D of each stage.
"""
import numpy as np

NEUMANN = "Neumann, Neumann, Szirmay-Kalos, Compact metallic reflectance models / Albedo pumping-up, 1999"
# The largest number of stages.
MAX_PUMPS = 4


def correction(albedos_view, albedos_light, mu_view, mu_light, pumps: float, control: bool):
    """D for `pumps` stages, shape (N,).

    `albedos_view` and `albedos_light` (N, stages) are a_0, a_1, ... at the view and at the light, of the controlled
    stages if `control`, else of the plain ones. Only the first ceil(pumps) are read. `mu_view` and `mu_light` (N,) are
    N·V and N·L.
    """
    d = np.ones(np.broadcast(mu_view, mu_light).shape)
    for stage in range(int(np.ceil(pumps))):
        # The last stage may be a fraction.
        share = min(pumps - stage, 1.0)
        d = d * np.maximum(albedos_view[..., stage], albedos_light[..., stage]) ** share
        if control:
            d = np.maximum(d, np.maximum(mu_view, mu_light))
    return d


def correction_at(albedos_at, mu_view, mu_light, pumps: float, control: bool):
    """D as `correction`. `albedos_at(mu, count)` returns the first `count` albedos (..., count) at cosines (...,).

    `mu_view` and `mu_light` broadcast. `albedos_at` is not called if `pumps` is 0.
    """
    if pumps == 0.0:
        return np.ones(np.broadcast(mu_view, mu_light).shape)
    at_view, at_light = (albedos_at(mu, int(np.ceil(pumps))) for mu in (mu_view, mu_light))
    return correction(at_view, at_light, mu_view, mu_light, pumps, control)


def stage_albedos(energy, mu_view, mu_light, stages: int, control: bool, at_lights):
    """Albedos a_0, a_1, ... of the first `stages` stages, (views, stages). a_j is the albedo of f_0 / D_j (eq. 16).

    - `energy` (views, lights): f_0 (N·L) times the solid angle, summed over the azimuth.
    - `mu_view` (views,), `mu_light` (views, lights): the cosines N·V and N·L.
    - `at_lights(albedo)`: interpolates an albedo (views,) at the views to one (views, lights) at the lights. Each stage
      needs its predecessors there.
    """
    albedos = np.empty((len(mu_view), stages))
    lights = np.empty((*np.shape(energy), max(stages - 1, 0)))
    for stage in range(stages):
        d = correction(albedos[:, None, :], lights, mu_view[:, None], mu_light, stage, control)
        albedos[:, stage] = (energy / d).sum(axis=-1)
        if stage + 1 < stages:
            lights[..., stage] = at_lights(albedos[:, stage])
    return albedos


def limit(mu_view, mu_light):
    """max(N·L, N·V): the limit of Phong's D under controlled pumping (eq. 22), shape (N,)."""
    return np.maximum(mu_view, mu_light)
