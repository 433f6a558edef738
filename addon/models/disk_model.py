"""Models of lumps on the halfway vector disk, with Schlick's factor at the view's angle, and perhaps a diffuse part."""
from dataclasses import dataclass, field, replace

import numpy as np

from . import disk, fresnel
from .albedos import INTEGRATED, Albedos
from .registry import Model
from .samplers import Cosine

COSINE = Cosine()


@dataclass(frozen=True)
class LumpRule:
    """One lump of a model. Text fields are ids of parameters.

    - `exponent`: the lump's exponent.
    - `radii`: one id for a round lump, or two.
    - `at_grazing`: the exponent at 90 degrees, used if the model's `vary_exponents` is on.
    - `retro`: the lump's center is the disk's center, so that it reflects toward the viewer. Else the center is the
      origin, which is the normal.
    - `held`: the lump shrinks until it lies inside the disk.
    - `share`: the lump's share of the volume, 1 if there is no id. With `rest` the lump has 1 minus that share.
    """

    exponent: str
    radii: tuple
    at_grazing: str = ""
    retro: bool = False
    held: bool = True
    share: str = ""
    rest: bool = False


def exponent_between(normal, grazing, mu_view):
    """Exponent n (N,) at N·V = `mu_view`, between the one at the normal and the one at grazing.

    n+1 changes geometrically.
    """
    return (normal + 1.0) ** mu_view * (grazing + 1.0) ** (1.0 - mu_view) - 1.0


@dataclass(frozen=True)
class DiskModel(Model):
    """f = F / (N·L) times a density of lights from lumps on the disk, plus (1 - F) C_d / pi with a diffuse color C_d.

    F is Schlick's factor from `base_color` to `f90` at the view's angle (Edwards et al. eq. 30, 34). If the parameter
    `renormalize` is on, each lump is divided by its volume inside the disk, which `albedos` returns.
    """

    projection: object
    lumps: tuple
    albedos: Albedos = field(default=INTEGRATED, kw_only=True)

    def with_albedos(self, albedos):
        """See `Model`."""
        return replace(self, albedos=albedos)

    def lumps_of(self, view, p):
        """[(share (N,), Lump)] for views (N, 3), with resolved parameters `p`."""
        lumps = []
        for rule in self.lumps:
            # Share and exponent.
            share = p[rule.share] if rule.share else 1.0
            share = np.full(len(view), 1.0 - share if rule.rest else share)
            exponent = np.full(len(view), float(p[rule.exponent]))
            if rule.at_grazing and p["vary_exponents"]:
                exponent = exponent_between(p[rule.exponent], p[rule.at_grazing], view[:, 2])
            # Radii, shrunk if necessary, and the center.
            radii = np.array([p[name] for name in (rule.radii * 2)[:2]])
            allowed = np.ones(len(view)) if rule.retro else disk.room(view[:, 2])
            radii = disk.held_radii(radii, allowed) if rule.held else np.tile(radii, (len(view), 1))
            center = view[:, :2] if rule.retro else np.zeros((len(view), 2))
            lump = disk.Lump(center, radii, exponent, 2.0 * np.pi * p.get("rotation", 0.0))
            if p.get("renormalize"):
                share = share / self.albedos.volumes(view[:, 2], exponent, radii[:, 0])
            lumps.append((share, lump))
        return lumps

    def is_held(self, p) -> bool:
        """Whether a lump is shrunk at normal incidence (a retroreflective one) or at 60 degrees (the others)."""
        return any(max(p[name] for name in rule.radii) > (1.0 if rule.retro else disk.room(0.5))
                   for rule in self.lumps if rule.held)

    def _value(self, view, light, p):
        point = self.projection.point(view, light)
        density = sum(share * lump.density(point) for share, lump in self.lumps_of(view, p))
        return self._coloured(view[:, 2], disk.value(self.projection, density, view, light), 1.0 / np.pi, p)

    def _albedo(self, mu, p):
        view = np.stack([np.sqrt(1.0 - mu * mu), np.zeros_like(mu), mu], axis=-1)
        # At grazing itself a held lump has the radius 0. Its volume there is the limit, read just above the horizon.
        view[:, 2] = np.maximum(view[:, 2], 1e-9)
        volume = sum(share * lump.volume(view[:, :2]) for share, lump in self.lumps_of(view, p))
        return self._coloured(mu, volume, 1.0, p)

    def _coloured(self, mu, specular, diffuse, p):
        """F times `specular` (N,) plus (1 - F) C_d times `diffuse`: (N,) if the model is white, else (N, 3)."""
        if self._is_white(p):
            return specular
        factor = fresnel.schlick(mu, p["base_color"], p.get("f90", (1.0, 1.0, 1.0)))
        return factor * specular[:, None] + (1.0 - factor) * np.asarray(p.get("diffuse_color", 0.0)) * diffuse

    @staticmethod
    def _is_white(p):
        return p["base_color"] == p.get("f90", (1.0, 1.0, 1.0)) == (1.0, 1.0, 1.0)

    def _mixture(self, view, p):
        """The distributions that samples are drawn from: [(probability (N,), Lump, or None for the diffuse part)]."""
        lumps = self.lumps_of(view, p)
        weights = [share * np.ones(len(view)) for share, _ in lumps]
        if "diffuse_color" in p:
            factor = np.mean(fresnel.schlick(view[:, 2], p["base_color"], p.get("f90", (1.0, 1.0, 1.0))), axis=1)
            diffuse = (1.0 - factor) * np.mean(p["diffuse_color"])
            weights = [weight * factor for weight in weights] + [diffuse]
            lumps = [*lumps, (diffuse, None)]
        total = np.maximum(sum(weights), 1e-300)
        return [(weight / total, lump) for weight, (_, lump) in zip(weights, lumps, strict=True)]

    def _sample(self, view, u, p):
        view = _above(view)
        mixture = self._mixture(view, p)
        light, low = np.empty(view.shape), np.zeros(len(view))
        for i, (chance, lump) in enumerate(mixture):
            # The first uniform number chooses the distribution, and its position in the interval is used again.
            last = i == len(mixture) - 1
            chosen = (u[:, 0] >= low) & (last | (u[:, 0] < low + chance))
            reused = np.stack([np.clip((u[:, 0] - low) / np.maximum(chance, 1e-300), 1e-300, 1.0), u[:, 1]], axis=-1)
            lights = COSINE.sample(view, reused) if lump is None else self.projection.light(view, lump.sample(reused))
            light[chosen] = lights[chosen]
            low = low + chance
        return light

    def _pdf(self, view, light, p):
        view = _above(view)
        point, density = self.projection.reached(view, light)
        total = 0.0
        for chance, lump in self._mixture(view, p):
            if lump is None:
                total = total + chance * COSINE.pdf(view, light)
            else:
                total = total + chance * lump.density(point) * density
        return total


def _above(view):
    """Views with N·V of at least 1e-9: a lump at the horizon would have the radius 0."""
    return np.concatenate([view[:, :2], np.maximum(view[:, 2:], 1e-9)], axis=1)
