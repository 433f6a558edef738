"""Presets: named materials in groups. Each is a model with parameters.

Two properties are measured. The colors of metals are the reflectances and refractive indices of `metals.METALS`. The
surfaces of plastics, glazes, paints and fibers reflect 4 %, by their refractive index of 1.5: ((1.5 - 1) / (1.5 + 1))².
Widths of lobes, colors beneath a surface and the strength of retroreflection are chosen by eye.
"""
from dataclasses import dataclass, field

from .metals import METALS

GROUPS = ("Metals", "Plastics", "Ceramics", "Paints", "Fabrics", "Retroreflectors")
# The reflectance at normal incidence for the refractive index 1.5.
DIELECTRIC = (0.04, 0.04, 0.04)
BLACK = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Preset:
    """A named material. `group` is one of GROUPS, `label` and `help` are shown to users.

    `parameters` {id: value} are those of the model with the id `model`. All others have their defaults.
    """

    group: str
    label: str
    model: str
    help: str
    parameters: dict = field(default_factory=dict)


def in_groups() -> dict:
    """{group: {key: preset}}, in the order of GROUPS."""
    return {group: {key: preset for key, preset in PRESETS.items() if preset.group == group} for group in GROUPS}


# Metals. Each finish can be applied to any metal.

def _metal(metal, finish, model, text, **parameters):
    """A metal with its exact reflectance. `base_color` is for the other choices of the Fresnel factor."""
    label = METALS[metal].label
    return Preset("Metals", f"{label}, {finish}", model, f"{label}: {text} Color from measured n and k, width by eye",
                  {"fresnel_type": "conductor", "base_color": METALS[metal].f0, "ior": METALS[metal].ior,
                   "extinction": METALS[metal].extinction, **parameters})


def _polished(metal):
    return _metal(metal, "Polished", "pumped_phong", "a mirror that is not quite one, as bright at grazing.",
                  exponent=3000.0, pumps=2.0)


def _satin(metal):
    return _metal(metal, "Satin", "pumped_phong", "blasted with fine glass beads, or etched.", exponent=40.0, pumps=2.0)


def _rough(metal):
    return _metal(metal, "Rough", "pumped_phong", "sand-blasted, no image left in the reflection.", exponent=6.0,
                  pumps=2.0)


_METALS = {
    **{f"{metal}_polished": _polished(metal) for metal in METALS},
    **{f"{metal}_satin": _satin(metal) for metal in ("silver", "gold", "copper", "aluminium", "nickel")},
    **{f"{metal}_rough": _rough(metal) for metal in ("aluminium", "titanium")},
    "iron_cast": _metal(
        "iron", "Cast", "pumped_blinn", "the grain of a casting.", exponent=8.0, pumps=2.0, control=False),
    "brushed_metal": Preset(
        "Metals", "Aluminium, Brushed", "edwards_empirical", "Aluminium brushed around the object's axis: highlights "
        "run across the strokes. Color measured, at normal incidence; widths by eye",
        {"diffuse_color": BLACK, "base_color": METALS["aluminium"].f0, "exponent": 30.0, "radius_u": 0.12,
         "radius_v": 1.0}),
}


# Bodies: a diffuse color below a surface with one lump. The surface transmits to the body the light that it does not
# reflect.

def _body(group, label, text, diffuse_color, exponent, base_color=DIELECTRIC, **parameters):
    return Preset(group, label, "edwards_empirical", text,
                  {"diffuse_color": diffuse_color, "base_color": base_color, "exponent": exponent, **parameters})


_PLASTICS = {
    "glossy_plastic": _body(
        "Plastics", "Glossy Plastic", "Injection-molded in a polished mold: refractive index 1.5, color by eye",
        (0.55, 0.02, 0.015), 250.0),
    "matte_plastic": _body(
        "Plastics", "Matte Plastic", "From a textured mold, as housings are: refractive index 1.5, color by eye",
        (0.11, 0.11, 0.12), 12.0),
    "coated_plastic": _body(
        "Plastics", "Coated Plastic", "A diffuse body under a clear coat of refractive index 1.5, color by eye",
        (0.04, 0.13, 0.45), 400.0),
    "rubber": _body(
        "Plastics", "Rubber", "Black rubber with a dull sheen: refractive index 1.5, color and width by eye",
        (0.02, 0.02, 0.02), 8.0),
}
_CERAMICS = {
    "porcelain": _body(
        "Ceramics", "Porcelain", "White under a thin glaze of refractive index 1.5, color by eye",
        (0.80, 0.79, 0.75), 900.0),
    "celadon_glaze": _body(
        "Ceramics", "Celadon Glaze", "Stoneware under a thick green glaze of refractive index 1.5, color by eye",
        (0.22, 0.36, 0.25), 3000.0),
    "satin_glaze": _body(
        "Ceramics", "Satin Glaze", "A glaze matted by fine crystals: refractive index 1.5, color and width by eye",
        (0.04, 0.09, 0.20), 25.0),
    "terracotta": _body(
        "Ceramics", "Terracotta", "Unglazed clay: nearly diffuse, the reflection hardly shows; color by eye",
        (0.42, 0.14, 0.06), 6.0),
}
_PAINTS = {
    "car_paint": Preset(
        "Paints", "Car Paint", "edwards_fit", "Metallic red: a broad lobe of flakes under the narrow one of the coat. "
        "One color tints both, white at grazing; all by eye",
        {"diffuse_color": (0.10, 0.004, 0.004), "base_color": (0.30, 0.025, 0.02), "exponent": 1500.0, "radius": 1.0,
         "blend": 0.75, "second_exponent": 9.0, "second_radius": 1.0}),
    "car_paint_silver": Preset(
        "Paints", "Car Paint, Silver", "edwards_fit", "Metallic silver: aluminium flakes at every tilt under a coat. "
        "One color tints both lobes; all by eye",
        {"diffuse_color": (0.10, 0.10, 0.105), "base_color": (0.42, 0.43, 0.44), "exponent": 1500.0, "radius": 1.0,
         "blend": 0.85, "second_exponent": 9.0, "second_radius": 1.0}),
    "lacquer": _body(
        "Paints", "Black Lacquer", "Piano black: hardly anything but the surface of refractive index 1.5",
        (0.004, 0.004, 0.004), 6000.0),
    "enamel_paint": _body(
        "Paints", "Enamel Paint", "Gloss paint with the waves of a brush: refractive index 1.5, color by eye",
        (0.02, 0.22, 0.09), 90.0),
    "wall_paint": _body(
        "Paints", "Wall Paint", "Emulsion paint: diffuse, with a sheen at grazing; refractive index 1.5, white by eye",
        (0.82, 0.80, 0.75), 6.0),
}
_FABRICS = {
    "satin": _body(
        "Fabrics", "Satin", "A soft sheen that sharpens towards grazing, stretched across the weave; all by eye",
        (0.35, 0.02, 0.05), 6.0, (0.12, 0.05, 0.06), radius_u=1.0, radius_v=0.4, vary_exponents=True,
        grazing_exponent=40.0),
    "silk": _body(
        "Fabrics", "Silk", "Taffeta: threads one way shine, in another color than the rest; all by eye",
        (0.05, 0.12, 0.30), 8.0, (0.10, 0.09, 0.06), radius_u=0.3, radius_v=1.0),
    "cotton": _body(
        "Fabrics", "Cotton", "Plain weave, nearly diffuse: fibers of refractive index 1.5, color and width by eye",
        (0.55, 0.48, 0.36), 6.0),
}
_RETROREFLECTORS = {
    "road_paint": _body(
        "Retroreflectors", "Road Paint", "White paint with glass beads: diffuse by day, and some of a headlight comes "
        "back; all by eye",
        (0.7, 0.7, 0.68), 2.0, (0.25, 0.25, 0.25), retro=0.8, retro_exponent=30.0),
    "retro_sheeting": _body(
        "Retroreflectors", "Retroreflective Sheeting", "Gray sheeting that sends most of a light back to where it came "
        "from; all by eye",
        (0.15, 0.15, 0.15), 20.0, (0.7, 0.7, 0.7), retro=0.9, retro_exponent=400.0),
    "traffic_sign": _body(
        "Retroreflectors", "Traffic Sign", "A yellow sign: colored by day, bright in a headlight at night; all by eye",
        (0.75, 0.42, 0.01), 50.0, (0.6, 0.34, 0.02), retro=0.85, retro_exponent=250.0),
    "cats_eye": _body(
        "Retroreflectors", "Cat's Eye", "A reflector with lenses: nearly all light goes back, in a narrow beam; all by "
        "eye",
        (0.02, 0.02, 0.02), 200.0, (0.85, 0.85, 0.85), retro=0.97, retro_exponent=3000.0),
    "bicycle_reflector": _body(
        "Retroreflectors", "Bicycle Reflector", "Red prisms behind a smooth front, which mirrors a part; all by eye",
        (0.10, 0.004, 0.002), 800.0, (0.55, 0.03, 0.02), retro=0.92, retro_exponent=1500.0),
    "safety_vest": _body(
        "Retroreflectors", "Safety Vest", "Lime cloth with fine glass beads: bright by day, and its own color at "
        "night; all by eye",
        (0.50, 0.72, 0.02), 8.0, (0.35, 0.50, 0.05), retro=0.9, retro_exponent=60.0),
}

PRESETS = {**_METALS, **_PLASTICS, **_CERAMICS, **_PAINTS, **_FABRICS, **_RETROREFLECTORS}
