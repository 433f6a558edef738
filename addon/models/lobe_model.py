"""Models of one symmetric lobe over a correction term, with a colour factor that depends on V·H."""
from dataclasses import dataclass, field, replace

import numpy as np

from . import fresnel, pumping
from .albedos import INTEGRATED, Albedos
from .geometry import dot, half
from .parameters import exponent_of_roughness
from .quadrature import meridians
from .registry import Model


@dataclass(frozen=True)
class LobeModel(Model):
    """f(V, L) = lobe(V, L; n) / D(V, L) times a colour factor.

    `correction` is "none", "pumped" (D from `albedos`, by `pumps` and `control`) or "limit" (max(N·L, N·V)).
    `roughness` is the other way to give `exponent`.
    """

    lobe: object
    correction: str
    albedos: Albedos = field(default=INTEGRATED, kw_only=True)

    def with_albedos(self, albedos):
        """See `Model`."""
        return replace(self, albedos=albedos)

    def resolve(self, given: dict) -> dict:
        """All parameters checked and completed with defaults; `exponent` follows `roughness` where that is used."""
        values = super().resolve(given)
        if "roughness" in given and "use_roughness" not in given:
            if "exponent" in given:
                raise ValueError(f"give exponent or roughness, not both: got {given['exponent']} and "
                                 f"{given['roughness']} (or say which with use_roughness = 0 or 1)")
            values["use_roughness"] = True
        if values["use_roughness"]:
            values["exponent"] = exponent_of_roughness(values["roughness"])
        return values

    def _value(self, view, light, p):
        value = self.lobe.value(view, light, p["exponent"]) / self._correction(view[:, 2], light[:, 2], p)
        return value if fresnel.is_white(p) else value[:, None] * self._factor(dot(view, half(view, light)), p)

    def _albedo(self, mu, p):
        edges = ()
        if self.correction == "pumped":
            edges = self.albedos.kinks(self.lobe, p.get("control", False), p["exponent"], p["pumps"])
        nodes = meridians(self.lobe, p["exponent"], mu, polar=32, azimuthal=48, edges=edges)
        energy = nodes.energy / self._correction(mu[:, None], nodes.light_cosine, p)[..., None]
        if fresnel.is_white(p):
            return energy.sum(axis=(1, 2))
        factor = self._factor(nodes.view_dot_half.ravel(), p).reshape(energy.shape + (3,))
        return np.einsum("vpa,vpac->vc", energy, factor)

    def _sample(self, view, u, p):
        return self.lobe.sample(view, u, p["exponent"])

    def _pdf(self, view, light, p):
        return self.lobe.pdf(view, light, p["exponent"])

    def _correction(self, mu_view, mu_light, p):
        if self.correction == "limit":
            return pumping.limit(mu_view, mu_light)
        if self.correction == "none":
            return np.ones(np.broadcast(mu_view, mu_light).shape)
        control = p.get("control", False)

        def albedos_at(mu, count):
            return self.albedos.stages(self.lobe, control, mu, p["exponent"], count)

        return pumping.correction_at(albedos_at, mu_view, mu_light, p["pumps"], control)

    def _factor(self, view_dot_half, p):
        return fresnel.factor(p["fresnel_type"], view_dot_half, p["base_color"], p["f90"], p["ior"], p["extinction"])
