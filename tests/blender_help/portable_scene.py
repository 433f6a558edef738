"""The scene for tests of portability: three materials, one of each kind, each on a sphere.

As a script, `python tests/blender_help/portable_scene.py FILE.blend` saves the scene with that Python's Blender.
"""
import os
import sys
from pathlib import Path

import bpy

from addon import create_material

PUMPED, LUMP, BAKED = "Pumped Phong, painted", "Lump", "Ward"


def build(*, lut="compiled"):
    """Fills an empty file with the scene; returns it. A packed image drives the first material's exponent."""
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
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.4, 0.5, 0.6, 1.0)
    settle(scene)
    return scene


def settle(scene):
    """Sets the scene's own settings."""
    scene.render.engine, scene.cycles.shading_system = "CYCLES", True
    scene.render.resolution_x, scene.render.resolution_y = 1920, 640


def bring(library, link):
    """Links or appends the objects and world of the file `library` to an empty file; returns the scene."""
    with bpy.data.libraries.load(str(library), link=link, relative=link) as (source, chosen):
        chosen.objects, chosen.worlds = source.objects, source.worlds
    scene = bpy.context.scene
    for body in chosen.objects:
        scene.collection.objects.link(body)
    scene.camera, scene.world = next(x for x in chosen.objects if x.type == "CAMERA"), chosen.worlds[0]
    settle(scene)
    return scene


def paint(material):
    """Drives the exponent by a packed image, a checkerboard of 4 and 200."""
    from addon.blender.material import groups, sockets

    tree = material.node_tree
    image = bpy.data.images.new("Exponents", 8, 8, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set([value for y in range(8) for x in range(8)
                              for value in (*(3 * [4.0 if (x + y) % 2 else 200.0]), 1.0)])
    image.pack()
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["UV"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], sockets.by_id(groups.find_node(material))["exponent"])


def save(path, compress=False):
    """Saves the open file; makes the folder where it is missing."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False, compress=compress)


def build_needy(library, folder):
    """Builds a scene that needs files of every kind, to be saved in `folder`; writes a script and a picture there."""
    from addon.blender.backend import osl
    from addon.blender.material import groups, sockets

    def script_of(material):
        return osl.script_of(groups.find_node(material))

    bpy.ops.wm.read_factory_settings(use_empty=True)
    save(folder / "needy.blend")
    scene = bring(library, link=True)
    scene.cycles.device = "GPU"
    scene.camera = scene.camera.copy()  # a linked camera would be missing in the copy
    scene.camera.data = scene.camera.data.copy()
    scene.collection.objects.link(scene.camera)
    for name, engine in (("No OSL", "CYCLES"), ("Workbench", "BLENDER_WORKBENCH")):
        bpy.data.scenes.new(name).render.engine = engine
    tables = create_material("pumped_phong", "Tables", lut="file", control=False)
    sockets.by_id(groups.find_node(tables))["table_plain"].default_value = str(folder / "gone.exr")
    outside = create_material("phong", "Outside")
    script_of(outside).mode, script_of(outside).filepath = "EXTERNAL", "//metal.osl"
    # A baked model keeps the name of the image that it was baked from.
    baked = create_material("blinn", "Image")
    script_of(baked).inputs.new("NodeSocketString", "Image", identifier="image").default_value = "//star.png"
    picture = bpy.data.images.new("Wood", 4, 4)
    picture.filepath_raw, picture.file_format = str(folder / "wood.png"), "PNG"
    picture.save()
    node = tables.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load("//wood.png")
    (folder / "metal.osl").write_text("shader metal(output closure color BSDF = 0) { BSDF = diffuse(N); }\n")
    ball = next(body for body in bpy.data.objects if body.name == PUMPED).copy()
    ball.data = ball.data.copy()
    scene.collection.objects.link(ball)
    ball.data.materials.clear()
    for material in (tables, outside, baked):
        ball.data.materials.append(material)


if __name__ == "__main__":
    build()
    save(Path(sys.argv[1]).resolve())
    sys.stdout.flush()
    os._exit(0)
