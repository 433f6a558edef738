"""Presets: materials by name, each a model with parameters. What they are is chosen by eye, but for the metals."""
from dataclasses import dataclass, field

from .metals import METALS


@dataclass(frozen=True)
class Preset:
    """`parameters` are those of `model`, by id; all others have their defaults."""

    label: str
    model: str
    help: str
    parameters: dict = field(default_factory=dict)


def _empirical(label, text, **parameters):
    return Preset(label, "edwards_empirical", text, parameters)


PRESETS = {
    "brushed_metal": _empirical(
        "Brushed Metal", "Aluminium brushed around the object's axis: highlights run across the strokes",
        diffuse_color=(0.0, 0.0, 0.0), base_color=METALS["aluminium"].f0, exponent=30.0, radius_u=0.12, radius_v=1.0),
    "satin": _empirical(
        "Satin", "A soft sheen that sharpens towards grazing, stretched across the weave",
        diffuse_color=(0.35, 0.02, 0.05), base_color=(0.12, 0.05, 0.06), exponent=6.0, radius_u=1.0, radius_v=0.4,
        vary_exponents=True, grazing_exponent=40.0),
    "coated_plastic": _empirical(
        "Coated Plastic", "A diffuse body under a clear coat of refractive index 1.5",
        diffuse_color=(0.04, 0.13, 0.45), base_color=(0.04, 0.04, 0.04), exponent=400.0),
    "road_paint": _empirical(
        "Road Paint", "White paint with glass beads: diffuse by day, and some of a headlight comes back",
        diffuse_color=(0.7, 0.7, 0.68), base_color=(0.25, 0.25, 0.25), exponent=2.0, retro=0.8, retro_exponent=30.0),
    "retro_sheeting": _empirical(
        "Retroreflective Sheeting", "Grey sheeting that sends most of a light back to where it came from",
        diffuse_color=(0.15, 0.15, 0.15), base_color=(0.7, 0.7, 0.7), exponent=20.0, retro=0.9, retro_exponent=400.0),
    "traffic_sign": _empirical(
        "Traffic Sign", "A yellow sign: coloured by day, bright in a headlight at night",
        diffuse_color=(0.75, 0.42, 0.01), base_color=(0.6, 0.34, 0.02), exponent=50.0, retro=0.85,
        retro_exponent=250.0),
    "cats_eye": _empirical(
        "Cat's Eye", "A reflector with lenses: nearly all light goes back, in a narrow beam",
        diffuse_color=(0.02, 0.02, 0.02), base_color=(0.85, 0.85, 0.85), exponent=200.0, retro=0.97,
        retro_exponent=3000.0),
}
