"""Measures materials by rendering in Blender without a window: furnace, goniometer, lit sphere.

`compare` tests a measurement against a formula of `brdf`. A measurement loads bpy when it starts, so this package can
be imported anywhere.
"""
from .comparison import Comparison, compare
from .instruments import (
    LitDirections,
    Measurement,
    Sphere,
    across_lobe,
    furnace,
    goniometer,
    in_plane,
    l1_error,
    local_directions,
    sphere,
    sphere_reference,
    sphere_sun,
    total_ratio,
)
from .scene import MeasureError, MeasuringScene, quiet, require_blender

__all__ = [
    "Comparison", "LitDirections", "MeasureError", "Measurement", "MeasuringScene", "Sphere", "across_lobe", "compare",
    "furnace", "goniometer", "in_plane", "l1_error", "local_directions", "quiet", "require_blender", "sphere",
    "sphere_reference", "sphere_sun", "total_ratio",
]
