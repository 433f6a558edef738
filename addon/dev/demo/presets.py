"""A sphere of each preset under an HDRI, side by side. Lengths in meters, z up; the camera looks along +y.

All spheres are in one picture, whose tiles are cut out: they are lit by the sky and the lamp and not by each other. The
lamp stands beside the camera, as a flash does, since what retroreflectors return is seen only there.
"""
import math
from pathlib import Path

import bpy
import numpy as np

from ...library.presets import PRESETS
from . import parts, picture
from .spheres import sky

COLUMNS = 9
RADIUS, SPACING = 0.46, 1.0
HDRI, HDRI_TURN = "interior.exr", 0.0
LAMP_ASIDE, LAMP_ENERGY, LAMP_ANGLE = (0.03, 0.04), 0.02, 2.0  # slopes to the right and up, W/m², degrees across
EXPOSURE = -0.1  # stops
GROUND = (0.82, 0.82, 0.83)  # sRGB, behind the spheres


def captions() -> list:
    """Captions of the tiles, the names of the presets."""
    return [preset.label for preset in PRESETS.values()]


def build(resolution):
    """Empty the file, build the scene with tiles of `resolution` (width, height) and return it."""
    rows = -(-len(PRESETS) // COLUMNS)
    scene = parts.empty_scene("Presets", (COLUMNS * resolution[0], rows * resolution[1]))
    mesh = None
    for i, (name, preset) in enumerate(PRESETS.items()):
        row, column = divmod(i, COLUMNS)
        body = parts.ball(scene, preset.label, RADIUS, mesh)
        mesh = body.data
        body.location = ((column - 0.5 * (COLUMNS - 1)) * SPACING, 0.0,
                         (0.5 * (rows - 1) - row) * SPACING * resolution[1] / resolution[0])
        body.material_slots[0].link = "OBJECT"  # the mesh is shared
        body.material_slots[0].material = _material(name, preset)
        body.visible_diffuse = body.visible_glossy = body.visible_shadow = False  # none sees another
    sky(scene, HDRI, HDRI_TURN)
    _lamp(scene)
    camera = parts.camera(scene, (0.0, -10.0, 0.0), pitch=0.0, lens=50.0).data
    camera.type, camera.ortho_scale = "ORTHO", max(COLUMNS * SPACING, rows * SPACING * resolution[1] / resolution[0])
    return scene


def prepare(scene, samples: int):
    """Set the renderer to `samples` per pixel at most, and to leave the sky out of the picture."""
    picture.prepare(scene, samples, EXPOSURE, indirect_clamp=0.0, bounces=1)
    scene.render.film_transparent = True


def render_all(folder: Path, resolution, samples: int, report=None) -> list:
    """Build the scene, render it, cut it up; returns the tiles' PNG paths. `report(line)` gets the progress."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = build(resolution)
    prepare(scene, samples)
    whole, = picture.write_all([("presets", lambda: picture.write(scene, folder, "all_presets", alpha=True))], report)
    return list(_tiles(whole, folder, resolution))


def save_blend(path: Path, resolution, samples: int):
    """Write the scene to the .blend `path`, with the HDRI packed."""
    scene = build(resolution)
    prepare(scene, samples)
    parts.save(scene, path)


def _material(name, preset):
    from ... import create_material

    return create_material(preset.model, name=preset.label, **preset.parameters)


def _lamp(scene):
    from mathutils import Vector

    sun = bpy.data.lights.new("Lamp", "SUN")
    sun.energy, sun.angle = LAMP_ENERGY, math.radians(LAMP_ANGLE)
    lamp = parts.place(scene, "Lamp", sun)
    lamp.rotation_euler = Vector((LAMP_ASIDE[0], -1.0, LAMP_ASIDE[1])).to_track_quat("Z", "Y").to_euler()


def _tiles(path, folder, resolution):
    """Cut the picture `path` up; yields the path of each tile, before GROUND, in the order of the presets."""
    from matplotlib import image

    width, height = resolution
    pixels = image.imread(path)
    pixels = pixels[..., :3] * pixels[..., 3:] + np.asarray(GROUND) * (1.0 - pixels[..., 3:])
    for i, name in enumerate(PRESETS):
        row, column = divmod(i, COLUMNS)
        tile = folder / f"preset_{name}.png"
        image.imsave(tile, pixels[row * height:(row + 1) * height, column * width:(column + 1) * width])
        yield tile
