"""The registry of models: sockets, panel, bake jobs, command line and tests are made of what is declared here, once."""
from dataclasses import dataclass

import numpy as np

from . import fresnel, pumping, tables
from .geometry import directions, dot, half, paired
from .parameters import Parameter, exponent_of_roughness
from .quadrature import meridians

MODELS = {}


@dataclass(frozen=True)
class Model:
    """A reflectance model: f(V, L) = lobe(V, L; n) / D(V, L) times a colour factor.

    `correction` is "none", "pumped" (D from the albedo tables, by `pumps` and `control`) or "limit" (max(N·L, N·V)).
    `tables` names the albedo tables that the model reads. All methods take the model's parameters by id, with
    `roughness` as the other way to give `exponent`, and raise ValueError that names what is wrong.
    """

    id: str
    label: str
    description: str
    lobe: object
    correction: str
    parameters: tuple
    tables: tuple
    formula: str
    references: tuple

    def parameter(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.id == name:
                return parameter
        allowed = ", ".join(p.id for p in self.parameters)
        raise ValueError(f"{self.id} has no parameter {name!r}; allowed are {allowed}")

    def resolve(self, given: dict) -> dict:
        """All parameters checked and completed with defaults; `exponent` follows `roughness` where that is used."""
        values = {p.id: p.default for p in self.parameters}
        for name, value in given.items():
            values[name] = self.parameter(name).check(value)
        if "roughness" in given and "use_roughness" not in given:
            if "exponent" in given:
                raise ValueError(f"give exponent or roughness, not both: got {given['exponent']} and "
                                 f"{given['roughness']} (or say which with use_roughness = 0 or 1)")
            values["use_roughness"] = True
        if values["use_roughness"]:
            values["exponent"] = exponent_of_roughness(values["roughness"])
        return values

    def evaluate(self, view, light, **parameters) -> np.ndarray:
        """f(V, L) in 1/sr: (N,) where the colour factor is white, else (N, 3). 0 below the horizon.

        `view`, `light`: unit vectors (N, 3), or one for all.
        """
        p = self.resolve(parameters)
        view, light = paired("view", directions("view", view), "light", directions("light", light))
        mu_view, mu_light = view[:, 2], light[:, 2]
        above = (mu_view > 0.0) & (mu_light > 0.0)
        value = np.where(above, self.lobe.value(view, light, p["exponent"]), 0.0)
        value = value / self._correction(np.where(above, mu_view, 1.0), np.where(above, mu_light, 1.0), p)
        return self._coloured(value, lambda: dot(view, half(view, light)), p)

    def albedo(self, cos_theta, **parameters) -> np.ndarray:
        """Albedo at N·V = `cos_theta` (N,), by quadrature: (N,) or (N, 3) as `evaluate`."""
        p = self.resolve(parameters)
        mu = np.atleast_1d(np.asarray(cos_theta, dtype=np.float64))
        if mu.ndim != 1 or not mu.size:
            raise ValueError(f"cos_theta: expected numbers of shape (N,), got shape {mu.shape}")
        if not np.all((mu >= 0.0) & (mu <= 1.0)):
            raise ValueError(f"cos_theta: {mu[~((mu >= 0.0) & (mu <= 1.0))][0]:g} is outside 0 .. 1")
        nodes = meridians(self.lobe, p["exponent"], mu, polar=32, azimuthal=48)
        energy = nodes.energy / self._correction(mu[:, None], nodes.light_cosine, p)[..., None]
        if self._is_white(p):
            return energy.sum(axis=(1, 2))
        factor = self._factor(nodes.view_dot_half.ravel(), p).reshape(energy.shape + (3,))
        return np.einsum("vpa,vpac->vc", energy, factor)

    def sample(self, view, u, **parameters) -> np.ndarray:
        """Light directions (N, 3) with the density `pdf`, from uniform numbers `u` (N, 2) in 0..1.

        They follow the lobe, and some lie below the horizon, where the BRDF is 0.
        """
        p = self.resolve(parameters)
        u = np.atleast_2d(np.asarray(u, dtype=np.float64))
        if u.ndim != 2 or u.shape[1] != 2:
            raise ValueError(f"u: expected uniform numbers of shape (N, 2), got shape {u.shape}")
        if not np.all((u >= 0.0) & (u <= 1.0)):
            raise ValueError(f"u: {u[~((u >= 0.0) & (u <= 1.0))][0]:g} is outside 0 .. 1")
        view, u = paired("view", directions("view", view), "u", u)
        return self.lobe.sample(view, np.maximum(u, 1e-300), p["exponent"])

    def pdf(self, view, light, **parameters) -> np.ndarray:
        """Density of `sample` at `light`, 1/sr over the whole sphere, shape (N,)."""
        p = self.resolve(parameters)
        view, light = paired("view", directions("view", view), "light", directions("light", light))
        return self.lobe.pdf(view, light, p["exponent"])

    def _correction(self, mu_view, mu_light, p):
        if self.correction == "limit":
            return pumping.limit(mu_view, mu_light)
        if self.correction == "none" or p["pumps"] == 0.0:
            return np.ones(np.broadcast(mu_view, mu_light).shape)
        at_view, at_light = (
            tables.albedos(self.lobe.id, p["control"], mu, p["exponent"]) for mu in (mu_view, mu_light)
        )
        return pumping.correction(at_view, at_light, mu_view, mu_light, p["pumps"], p["control"])

    def _factor(self, view_dot_half, p):
        return fresnel.factor(p["fresnel_type"], view_dot_half, p["base_color"], p["f90"], p["ior"], p["extinction"])

    @staticmethod
    def _is_white(p):
        return p["fresnel_type"] != fresnel.CONDUCTOR and p["base_color"] == (1.0, 1.0, 1.0) and (
            p["fresnel_type"] == fresnel.CONSTANT or p["f90"] == (1.0, 1.0, 1.0))

    def _coloured(self, value, view_dot_half, p):
        return value if self._is_white(p) else value[:, None] * self._factor(view_dot_half(), p)


def register(model: Model) -> Model:
    """Add a model. Raises ValueError when its id is taken."""
    if model.id in MODELS:
        raise ValueError(f"model {model.id!r} is registered twice")
    MODELS[model.id] = model
    return model
