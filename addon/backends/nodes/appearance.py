"""A model's appearance in three numbers, for closures that have no more."""
from typing import NamedTuple

import numpy as np

from ...models import fresnel
from ...models.disk_model import DiskModel
from ...models.lobe_model import LobeModel


class Appearance(NamedTuple):
    """`color` (3,), linear RGB; the `exponent` of a half-vector power of equal width; and `metallic`, 0..1."""

    color: np.ndarray
    exponent: float
    metallic: float


def appearance(model, p: dict) -> Appearance:
    """The appearance at normal incidence of a model with the resolved parameters `p`."""
    if isinstance(model, LobeModel):
        color = fresnel.factor(p["fresnel_type"], [1.0], p["base_color"], p["f90"], p["ior"], p["extinction"])[0]
        return Appearance(color, model.lobe.half_vector_exponent(p["exponent"]), 1.0)
    if isinstance(model, DiskModel):
        return _of_lumps(model, p)
    diffuse = np.asarray(p.get("diffuse_color", (0.0, 0.0, 0.0)))
    color = np.asarray(p.get("base_color", (1.0, 1.0, 1.0)))
    metallic = float(color.max() >= diffuse.max())
    return Appearance(color if metallic else diffuse, 2.0 / model.width(p) ** 2, metallic)


def _of_lumps(model, p):
    """A lump of n and radius R is as wide as a half-vector power of 2n/R² at normal incidence."""
    rule, color = model.lumps[0], np.asarray(p["base_color"])
    radius = min(max(p[name] for name in rule.radii), 1.0)
    exponent = 2.0 * p[rule.exponent] / radius**2
    if "diffuse_color" in p and color.max() < 0.2:
        return Appearance(np.asarray(p["diffuse_color"]), exponent, 0.0)
    return Appearance(color, exponent, 1.0)
