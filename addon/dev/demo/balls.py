"""Three balls of one model side by side, for its page: a small sun, and a sky that is brightest at the horizon.

Lengths in meters, z up; the camera looks along +y.
"""
import math
from pathlib import Path

import bpy
from mathutils import Vector

from ..pages.figure_values import shown
from . import parts, picture

RADIUS, SPACING = 0.47, 1.0
SUN_DIRECTION = (-0.45, -0.7, 0.55)  # towards it; made a unit vector where used
SUN_ENERGY, SUN_ANGLE = 0.3, 6.0  # irradiance in W/m² where it stands above, and degrees across
SKY = {  # sine of the elevation: radiance; below the horizon, as at 0, it is dark ground
    0.0: (0.12,) * 3, 0.06: (0.6,) * 3, 0.4: (0.34,) * 3, 1.0: (0.18,) * 3,
}
SAMPLES = 18


def build(model, side: int):
    """Empty the file, build the scene, a ball `side` pixels wide for each of the model's `shown` values; return it."""
    from ... import create_material

    settings = shown(model).settings()
    scene = parts.empty_scene("Balls", (side * len(settings), side))
    parts.gradient_sky(scene, SKY)
    mesh = None
    for column, parameters in enumerate(settings):
        body = parts.ball(scene, f"Ball {column + 1}", RADIUS, mesh)
        mesh = body.data
        body.location.x = (column - 0.5 * (len(settings) - 1)) * SPACING
        body.material_slots[0].link = "OBJECT"  # the mesh is shared
        body.material_slots[0].material = create_material(model.id, name=f"{model.label} {column + 1}", **parameters)
        body.visible_diffuse = body.visible_glossy = body.visible_shadow = False  # each sees sun and sky alone
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = SUN_ENERGY, math.radians(SUN_ANGLE)
    lamp = parts.place(scene, "Sun", sun)
    lamp.rotation_euler = Vector(SUN_DIRECTION).to_track_quat("Z", "Y").to_euler()
    camera = parts.camera(scene, (0.0, -10.0, 0.0), pitch=0.0, lens=50.0).data
    camera.type, camera.ortho_scale = "ORTHO", len(settings) * SPACING
    return scene


def render(model, folder: Path, side: int) -> Path:
    """Build and render; returns the path of the PNG, <id>.png, beside its EXR."""
    scene = build(model, side)
    picture.prepare(scene, SAMPLES, exposure=0.0, indirect_clamp=0.0, bounces=1)
    scene.cycles.use_adaptive_sampling = False
    return picture.write(scene, folder, model.id)
