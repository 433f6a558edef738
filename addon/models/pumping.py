"""Albedo pumping-up: the correction term D that divides a symmetric function f_0.

Source: Neumann, Neumann, Szirmay-Kalos, "Albedo pumping-up", section 3. Each stage divides the stage before by a legal
correction term (inequality 17), so that D_{j+1} = D_j m_j with m_j = max(a_j(L), a_j(V)) (eq. 20). Control (eq. 21) is
read cumulatively, D_{j+1} = max(D_j m_j, N·L, N·V). A fraction s of a stage uses m_j^s, legal since m_j <= m_j^s <= 1;
where m_j > 1 (Blinn) inequality 17 has no solution and m_j^s interpolates geometrically.

D looks at N·V and N·L alone. An albedo after pumping is therefore an integral over the light's polar angle, of what f_0
sums to over the azimuth: `stage_albedos` asks for those sums once, and weighs them anew for each stage.
"""
import numpy as np

NEUMANN = "Neumann, Neumann, Szirmay-Kalos, Compact metallic reflectance models / Albedo pumping-up, 1999"
MAX_PUMPS = 4


def correction(albedos_view, albedos_light, mu_view, mu_light, pumps: float, control: bool):
    """D for `pumps` stages, shape (N,).

    `albedos_view` and `albedos_light` (N, stages) hold a_0, a_1, ... of the plain or of the controlled stages, as
    `control` says; only the first ceil(pumps) are read. `mu_view`, `mu_light` (N,) are N·V and N·L.
    """
    d = np.ones(np.broadcast(mu_view, mu_light).shape)
    for stage in range(int(np.ceil(pumps))):
        share = min(pumps - stage, 1.0)
        d = d * np.maximum(albedos_view[..., stage], albedos_light[..., stage]) ** share
        if control:
            d = np.maximum(d, np.maximum(mu_view, mu_light))
    return d


def correction_at(albedos_at, mu_view, mu_light, pumps: float, control: bool):
    """D as `correction` gives it; `albedos_at(mu, count)` gives the first `count` albedos at cosines (...,).

    `mu_view` and `mu_light` broadcast. Without pumps no albedo is asked for.
    """
    if pumps == 0.0:
        return np.ones(np.broadcast(mu_view, mu_light).shape)
    at_view, at_light = (albedos_at(mu, int(np.ceil(pumps))) for mu in (mu_view, mu_light))
    return correction(at_view, at_light, mu_view, mu_light, pumps, control)


def stage_albedos(energy, mu_view, mu_light, stages: int, control: bool, at_lights):
    """Albedos a_0, a_1, ... of as many `stages`, shape (views, stages); a_j is that of f_0 / D_j (eq. 16).

    `energy` (views, lights) is f_0 (N·L) times the solid angle, summed over the azimuth, `mu_view` (views,) and
    `mu_light` (views, lights) the cosines. Each stage needs the ones before at the lights: `at_lights(albedo)` makes
    (views, lights) of what is known at the views, (views,).
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
    """max(N·L, N·V): where controlled pumping of Phong ends (eq. 22), shape (N,)."""
    return np.maximum(mu_view, mu_light)
