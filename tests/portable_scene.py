"""The scene that is sent on journeys: three materials of the three kinds there are, each on a sphere.

As a script, `python tests/portable_scene.py FILE.blend` saves it in the Blender of that Python.
"""
import os
import sys
from pathlib import Path

import bpy

from addon import create_material

PUMPED, LUMP, BAKED = "Pumped Phong, painted", "Lump", "Ward"


def build(*, lut="compiled"):
    """Fill an empty file with the scene; returns it. The first material's exponent is driven by a packed image."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    painted = create_material("pumped_phong", PUMPED, lut=lut, pumps=2.0, control=True)
    paint(painted)
    looks = [painted, create_material("disk_scaling", LUMP, exponent=20.0),
             create_material("ward", BAKED, roughness_u=0.3, roughness_v=0.3)]
    for x, material in zip((-2.2, 0.0, 2.2), looks, strict=True):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, location=(x, 0.0, 0.0))
        ball = bpy.context.object
        ball.name = material.name
        ball.data.materials.append(material)
        ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.5, 0.0))
    bpy.context.object.data.energy, bpy.context.object.data.angle = 3.0, 0.1
    bpy.ops.object.camera_add(location=(0.0, -11.0, 1.0), rotation=(1.48, 0.0, 0.0))
    scene.camera = bpy.context.object
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.color = (0.4, 0.5, 0.6)
    scene.render.engine, scene.cycles.shading_system = "CYCLES", True
    scene.render.resolution_x, scene.render.resolution_y = 1920, 640
    return scene


def paint(material):
    """Drive the exponent by a checkerboard of 4 and 200, painted here and packed."""
    from addon.blender.materials import script_node

    node = script_node(material)
    tree = node.id_data
    image = bpy.data.images.new("Exponents", 8, 8, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set([value for y in range(8) for x in range(8)
                              for value in (*(3 * [4.0 if (x + y) % 2 else 200.0]), 1.0)])
    image.pack()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["UV"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], next(s for s in node.inputs if s.identifier == "exponent"))


def save(path):
    """Save the open file; the folder is made where there is none."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)
    return Path(path)


if __name__ == "__main__":
    build()
    save(Path(sys.argv[1]).resolve())
    sys.stdout.flush()
    os._exit(0)
