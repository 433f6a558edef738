"""Models of lumps on the halfway vector disk, with Schlick's factor at the view's angle and perhaps a diffuse part."""
from dataclasses import dataclass, field, replace

import numpy as np

from . import disk, fresnel
from .albedos import INTEGRATED, Albedos
from .registry import Model
from .samplers import Cosine

COSINE = Cosine()


@dataclass(frozen=True)
class LumpRule:
    """One lump of a model; fields name parameters, by id.

    `radii`: one id for a round lump, or two. `at_grazing` is the exponent at 90 degrees where the model's
    `vary_exponents` is on. `retro` centres the lump on the disk's centre, where it reflects towards the viewer, else it
    lies about the origin, the normal. `held` shrinks it until it stays on the disk. `share` is the id of its share of
    the volume, 1 without; `rest` takes what is left of that.
    """

    exponent: str
    radii: tuple
    at_grazing: str = ""
    retro: bool = False
    held: bool = True
    share: str = ""
    rest: bool = False


def exponent_between(normal, grazing, mu_view):
    """Exponent (N,) at N·V = `mu_view` between that at the normal and that at grazing: n+1 changes geometrically."""
    return (normal + 1.0) ** mu_view * (grazing + 1.0) ** (1.0 - mu_view) - 1.0


@dataclass(frozen=True)
class DiskModel(Model):
    """f = F / (N·L) times a density of lights, made of lumps on the disk; plus (1 - F) C_d / pi with a diffuse colour.

    F is Schlick's factor from `base_color` to `f90` at the view's angle (Edwards et al. eq. 30, 34). Where the model is
    renormalized, a lump is divided by its volume on the disk, which `albedos` gives.
    """

    projection: object
    lumps: tuple
    albedos: Albedos = field(default=INTEGRATED, kw_only=True)

    def with_albedos(self, albedos):
        """See `Model`."""
        return replace(self, albedos=albedos)

    def lumps_of(self, view, p):
        """[(share (N,), Lump)] for views (N, 3)."""
        found = []
        for rule in self.lumps:
            share = p[rule.share] if rule.share else 1.0
            share = np.full(len(view), 1.0 - share if rule.rest else share)
            exponent = np.full(len(view), float(p[rule.exponent]))
            if rule.at_grazing and p["vary_exponents"]:
                exponent = exponent_between(p[rule.exponent], p[rule.at_grazing], view[:, 2])
            radii = np.array([p[name] for name in (rule.radii * 2)[:2]])
            allowed = np.ones(len(view)) if rule.retro else disk.room(view[:, 2])
            radii = disk.held_radii(radii, allowed) if rule.held else np.tile(radii, (len(view), 1))
            centre = view[:, :2] if rule.retro else np.zeros((len(view), 2))
            lump = disk.Lump(centre, radii, exponent, 2.0 * np.pi * p.get("rotation", 0.0))
            if p.get("renormalize"):
                share = share / self.albedos.volumes(view[:, 2], exponent, radii[:, 0])
            found.append((share, lump))
        return found

    def is_held(self, p) -> bool:
        """Whether a lump is shrunk already at normal incidence, or becomes so when seen from 60 degrees."""
        return any(max(p[name] for name in rule.radii) > (1.0 if rule.retro else disk.room(0.5))
                   for rule in self.lumps if rule.held)

    def _value(self, view, light, p):
        point = self.projection.point(view, light)
        density = sum(share * lump.density(point) for share, lump in self.lumps_of(view, p))
        return self._coloured(view[:, 2], disk.value(self.projection, density, view, light), 1.0 / np.pi, p)

    def _albedo(self, mu, p):
        view = np.stack([np.sqrt(1.0 - mu * mu), np.zeros_like(mu), mu], axis=-1)
        # At grazing itself a held lump has shrunk to nothing, and its volume stays what it is just before.
        view[:, 2] = np.maximum(view[:, 2], 1e-9)
        volume = sum(share * lump.volume(view[:, :2]) for share, lump in self.lumps_of(view, p))
        return self._coloured(mu, volume, 1.0, p)

    def _coloured(self, mu, specular, diffuse, p):
        """F times `specular` (N,) and (1 - F) C_d times `diffuse`: (N,) where the model is white, else (N, 3)."""
        if self._is_white(p):
            return specular
        factor = fresnel.schlick(mu, p["base_color"], p.get("f90", (1.0, 1.0, 1.0)))
        return factor * specular[:, None] + (1.0 - factor) * np.asarray(p.get("diffuse_color", 0.0)) * diffuse

    @staticmethod
    def _is_white(p):
        return p["base_color"] == p.get("f90", (1.0, 1.0, 1.0)) == (1.0, 1.0, 1.0)

    def _parts(self, view, p):
        """[(chance (N,), Lump or None for the diffuse part)] that samples are drawn from."""
        lumps = self.lumps_of(view, p)
        weights = [share * np.ones(len(view)) for share, _ in lumps]
        if "diffuse_color" in p:
            factor = np.mean(fresnel.schlick(view[:, 2], p["base_color"], p.get("f90", (1.0, 1.0, 1.0))), axis=1)
            diffuse = (1.0 - factor) * np.mean(p["diffuse_color"])
            weights = [w * factor for w in weights] + [diffuse]
            lumps = [*lumps, (diffuse, None)]
        total = np.maximum(sum(weights), 1e-300)
        return [(w / total, lump) for w, (_, lump) in zip(weights, lumps, strict=True)]

    def _sample(self, view, u, p):
        view = _above(view)
        parts = self._parts(view, p)
        light, low = np.empty(view.shape), np.zeros(len(view))
        for i, (chance, lump) in enumerate(parts):
            last = i == len(parts) - 1
            chosen = (u[:, 0] >= low) & (last | (u[:, 0] < low + chance))
            again = np.stack([np.clip((u[:, 0] - low) / np.maximum(chance, 1e-300), 1e-300, 1.0), u[:, 1]], axis=-1)
            drawn = COSINE.sample(view, again) if lump is None else self.projection.light(view, lump.sample(again))
            light[chosen] = drawn[chosen]
            low = low + chance
        return light

    def _pdf(self, view, light, p):
        view = _above(view)
        point, density = self.projection.reached(view, light)
        total = 0.0
        for chance, lump in self._parts(view, p):
            if lump is None:
                total = total + chance * COSINE.pdf(view, light)
            else:
                total = total + chance * lump.density(point) * density
        return total



def _above(view):
    """Views lifted off the horizon, where disks have no inside."""
    return np.concatenate([view[:, :2], np.maximum(view[:, 2:], 1e-9)], axis=1)
