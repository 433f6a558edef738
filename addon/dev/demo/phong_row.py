"""Red plastic spheres with original and with normalized Phong highlights: after figure 7.38 of Real-Time Rendering.

Lengths in meters, z up; the camera looks along +y.
"""
import math
from pathlib import Path

import bpy

from . import parts, picture

EXPONENTS = (25.0, 50.0, 75.0, 100.0)  # m, from the left
SPECULAR = 0.05  # c_spec of the normalized row
DIFFUSE = (0.95, 0.0, 0.0)  # c_diff
RADIUS, SPACING = 0.46, 1.0
SUN_DIRECTION = (-0.42, -0.72, 0.55)  # towards it; made a unit vector where used
SUN_ENERGY, SUN_ANGLE = 1.15, 2.0  # irradiance in W/m² where it stands above, and degrees across


def scale(exponent: float, normalized: bool) -> float:
    """k_s of k_s (R·L)^m: (m+2)/(2 pi) c_spec where normalized, else what makes the two leftmost spheres match."""
    return ((exponent if normalized else EXPONENTS[0]) + 2.0) / (2.0 * math.pi) * SPECULAR


def build(resolution):
    """Empty the file, build the scene with `resolution` (width, height), twice as wide as high; return it.

    The row of original highlights is above.
    """
    scene = parts.empty_scene("Phong row", resolution)
    scene.world = bpy.data.worlds.new("Darkness")
    parts.nodes_of(scene.world)
    mesh = None
    for row, normalized in enumerate((False, True)):
        for column, exponent in enumerate(EXPONENTS):
            body = parts.ball(scene, f"Sphere {exponent:g}{' normalized' if normalized else ''}", RADIUS, mesh)
            mesh = body.data
            body.location = ((column - 0.5 * (len(EXPONENTS) - 1)) * SPACING, 0.0, (0.5 - row) * SPACING)
            body.material_slots[0].link = "OBJECT"  # the mesh is shared
            body.material_slots[0].material = _plastic(exponent, normalized)
            body.visible_diffuse = body.visible_glossy = body.visible_shadow = False  # each is lit by the sun alone
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = SUN_ENERGY, math.radians(SUN_ANGLE)
    lamp = parts.place(scene, "Sun", sun)
    lamp.rotation_euler = _towards(SUN_DIRECTION)
    camera = parts.camera(scene, (0.0, -10.0, 0.0), pitch=0.0, lens=50.0).data
    camera.type, camera.ortho_scale = "ORTHO", len(EXPONENTS) * SPACING
    return scene


def render(folder: Path, resolution, samples: int) -> Path:
    """Build and render; returns the path of the PNG, beside its EXR."""
    scene = build(resolution)
    picture.prepare(scene, samples, exposure=0.0, indirect_clamp=0.0, bounces=1)
    scene.cycles.use_adaptive_sampling = False
    return picture.write(scene, folder, "phong_row")


def _towards(direction):
    """Rotation of a lamp that shines along its -z, so that its light comes from `direction`."""
    from mathutils import Vector

    return Vector(direction).to_track_quat("Z", "Y").to_euler()


def _plastic(exponent, normalized):
    """Phong's highlight over Cycles' own diffuse closure, which is c_diff/pi.

    Both are (m+2)/(2 pi) c (R·L)^m, with the c that gives their k_s.
    """
    from ... import create_material

    color = scale(exponent, normalized) * 2.0 * math.pi / (exponent + 2.0)
    material = create_material("phong", name=f"Plastic m = {exponent:g}{' normalized' if normalized else ''}",
                               exponent=exponent, base_color=color)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = material.node_tree.get_output_node("CYCLES").inputs["Surface"]
    highlight = surface.links[0].from_socket
    diffuse, both = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeAddShader")
    diffuse.inputs["Color"].default_value = (*DIFFUSE, 1.0)
    links.new(highlight, both.inputs[0])
    links.new(diffuse.outputs[0], both.inputs[1])
    links.new(both.outputs[0], surface)
    return material
