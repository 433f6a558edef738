"""Parts of the demos' scenes: bodies, matte materials, skies, the camera, and the file. Lengths in meters."""
import math

import bpy

from . import shapes


def empty_scene(name: str, resolution):
    """Empty the file and return its scene, set to Cycles and `resolution` (width, height) in pixels."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.name = name
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = resolution
    scene.render.resolution_percentage = 100
    return scene


def save(scene, path):
    """Write the scene to `path`, compressed, with all that it needs and no path of this machine."""
    scene.render.filepath = "//"
    bpy.context.preferences.filepaths.save_version = 0  # no older file beside it
    path.parent.mkdir(parents=True, exist_ok=True)
    for _ in range(3):
        bpy.data.orphans_purge()
    bpy.ops.wm.save_as_mainfile(filepath=str(path.resolve()), compress=True, check_existing=False)


def add(scene, name, shape, bevel=0.0):
    """A smooth-shaded mesh object; `bevel` (m) rounds its edges without bending its flat faces."""
    vertices, faces = shape
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    mesh.set_sharp_from_angle(angle=math.radians(40.0))
    body = place(scene, name, mesh)
    if bevel:
        modifier = body.modifiers.new("Bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, 4
        modifier.limit_method, modifier.angle_limit = "ANGLE", math.radians(25.0)
        modifier.harden_normals = True
    return body


def place(scene, name, data):
    """An object of `data`, which may be shared or None, at the origin."""
    body = bpy.data.objects.new(name, data)
    scene.collection.objects.link(body)
    return body


def ball(scene, name, radius, mesh=None):
    """A sphere about the origin with one empty material slot; it shares `mesh` if that is not None."""
    if mesh is not None:
        return place(scene, name, mesh)
    angles = [math.pi * (i / 64.0 - 0.5) for i in range(65)]
    profile = [(radius * math.cos(a) if 0 < i < 64 else 0.0, radius * math.sin(a)) for i, a in enumerate(angles)]
    return wear(add(scene, name, shapes.lathe(profile, 128)), None)


def text(scene, name, words, size):
    """A flat mesh of `words` in Blender's own font, centered in the xy plane and read from +z; `size` in meters."""
    curve = bpy.data.curves.new(name, "FONT")
    curve.body, curve.size = words, size
    curve.align_x, curve.align_y = "CENTER", "CENTER"
    curve.resolution_u = 3
    font = bpy.data.objects.new(name, curve)
    mesh = bpy.data.meshes.new_from_object(font)  # a mesh needs no font in the file
    mesh.name = name
    bpy.data.objects.remove(font)
    bpy.data.curves.remove(curve)
    return place(scene, name, mesh)


def wear(body, material):
    """Give the object `material` alone."""
    body.data.materials.clear()
    body.data.materials.append(material)
    return body


def nodes_of(block):
    """The emptied node tree of a material or world."""
    if block.node_tree is None:  # 5.x makes blocks with a tree, and warns about this switch
        block.use_nodes = True
    block.node_tree.nodes.clear()
    return block.node_tree


def matte(name, color):
    """A material that reflects `color` (linear RGB) diffusely."""
    material = bpy.data.materials.new(name)
    tree = nodes_of(material)
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    material.diffuse_color = (*color, 1.0)
    return material


def gradient_sky(scene, colors):
    """A vertical gradient, the same all around. `colors`: sine of the elevation -> linear RGB radiance."""
    world = scene.world = bpy.data.worlds.new("Sky")
    tree = nodes_of(world)
    nodes, links = tree.nodes, tree.links
    coordinates, split, ramp, background, output = (nodes.new(f"ShaderNode{kind}") for kind in (
        "TexCoord", "SeparateXYZ", "ValToRGB", "Background", "OutputWorld"))
    while len(ramp.color_ramp.elements) < len(colors):
        ramp.color_ramp.elements.new(0.5)
    for element, (position, color) in zip(ramp.color_ramp.elements, colors.items(), strict=True):
        element.position, element.color = position, (*color, 1.0)
    links.new(coordinates.outputs["Generated"], split.inputs[0])
    links.new(split.outputs["Z"], ramp.inputs[0])
    links.new(ramp.outputs["Color"], background.inputs["Color"])
    links.new(background.outputs[0], output.inputs["Surface"])


def camera(scene, location, pitch, lens, yaw=0.0):
    """The scene's camera at `location`; `pitch` in degrees above the horizon, `yaw` to the left of +y, `lens` in mm."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    body = place(scene, "Camera", data)
    body.location = location
    body.rotation_euler = (math.radians(90.0 + pitch), 0.0, math.radians(yaw))
    scene.camera = body
    return body
