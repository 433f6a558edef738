"""Models of one symmetric lobe over a correction term, with a color factor that depends on V·H."""
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
    """f(V, L) = lobe(V, L; n) / D(V, L) times a color factor.

    `lobe` is one of `lobes`. `correction` is "none" (D = 1), "pumped" (D from `albedos`, by the parameters `pumps` and
    `control`) or "limit" (D = max(N·L, N·V)). The parameter `roughness` sets n in place of `exponent` if
    `use_roughness` is on.
    """

    lobe: object
    correction: str
    albedos: Albedos = field(default=INTEGRATED, kw_only=True)

    def with_albedos(self, albedos):
        """See `Model`."""
        return replace(self, albedos=albedos)

    def resolve(self, given: dict) -> dict:
        """See `Model`. `exponent` is computed from `roughness` if that is used.

        A `roughness` without `use_roughness` turns that on. Raises ValueError if `exponent` is given as well.
        """
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
        # Intervals of the integral end at the correction's kinks.
        edges = ()
        if self.correction == "pumped":
            edges = self.albedos.kinks(self.lobe, p.get("control", False), p["exponent"], p["pumps"])
        nodes = meridians(self.lobe, p["exponent"], mu, polar=32, azimuthal=48, edges=edges)
        energy = nodes.energy / self._correction(mu[:, None], nodes.light_cosine, p)[..., None]
        # The sum over all nodes, with the color at each node's V·H.
        if fresnel.is_white(p):
            return energy.sum(axis=(1, 2))
        factor = self._factor(nodes.view_dot_half.ravel(), p).reshape(energy.shape + (3,))
        return np.einsum("vpa,vpac->vc", energy, factor)

    def _sample(self, view, u, p):
        return self.lobe.sample(view, u, p["exponent"])

    def _pdf(self, view, light, p):
        return self.lobe.pdf(view, light, p["exponent"])

    def _correction(self, mu_view, mu_light, p):
        """D for cosines N·V and N·L, which broadcast."""
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
