"""Albedo pumping-up: the correction term D that divides a symmetric function f_0.

Source: Neumann, Neumann, Szirmay-Kalos, "Albedo pumping-up", section 3. Each stage divides the stage before by a legal
correction term (inequality 17), so that D_{j+1} = D_j m_j with m_j = max(a_j(L), a_j(V)) (eq. 20). Control (eq. 21) is
read cumulatively, D_{j+1} = max(D_j m_j, N·L, N·V). A fraction s of a stage uses m_j^s, legal since m_j <= m_j^s <= 1;
where m_j > 1 (Blinn) inequality 17 has no solution and m_j^s interpolates geometrically.
"""
import numpy as np

NEUMANN = "Neumann, Neumann, Szirmay-Kalos, Compact metallic reflectance models / Albedo pumping-up, 1999"
MAX_PUMPS = 4


def correction(albedos_view, albedos_light, mu_view, mu_light, pumps: float, control: bool):
    """D for `pumps` stages, shape (N,).

    `albedos_view` and `albedos_light` (N, stages) hold a_0, a_1, ... of the plain or of the controlled chain, as
    `control` says; only the first ceil(pumps) are read. `mu_view`, `mu_light` (N,) are N·V and N·L.
    """
    d = np.ones(np.broadcast(mu_view, mu_light).shape)
    for stage in range(int(np.ceil(pumps))):
        share = min(pumps - stage, 1.0)
        d = d * np.maximum(albedos_view[..., stage], albedos_light[..., stage]) ** share
        if control:
            d = np.maximum(d, np.maximum(mu_view, mu_light))
    return d


def limit(mu_view, mu_light):
    """max(N·L, N·V): where controlled pumping of Phong ends (eq. 22), shape (N,)."""
    return np.maximum(mu_view, mu_light)
