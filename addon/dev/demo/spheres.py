"""Anisotropic spheres on a stand, lit by an HDRI alone: after figure 9 of Edwards et al. Lengths in meters, z up."""
import math
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import bpy

from . import parts, picture, shapes

HDRI = "sunrise.exr"  # comes with Blender, CC0
HDRI_TURN = 90.0  # degrees about z
RESOLUTION = (640, 480)
CAPTION = "Front and middle: Edwards Empirical, back: Disk Lump"
RADIUS, SPACING = 0.42, 1.06
STEP_HEIGHT, STEP_DEPTH, STEP_LENGTH = 1.16, 1.0, 5.6
STAND, INK = (0.05, 0.05, 0.055), (0.6, 0.6, 0.6)
EXPOSURE = 0.0  # stops
INDIRECT_CLAMP = 2.0
UPRIGHT = (0.0, 0.0)


@dataclass(frozen=True)
class Sphere:
    """One sphere: its label, model and parameters.

    `axis`: tilt of the object's z axis towards the camera and to the right, degrees. `brushed`: a direction in world
    space that the tangent is linked to, or () where it is unlinked and runs around the object's z axis.
    """

    label: str
    model: str
    parameters: dict = field(default_factory=dict)
    axis: tuple = UPRIGHT
    brushed: tuple = ()


def rows() -> list:
    """The three rows of five spheres, from the front and lowest to the highest."""
    gold = {"base_color": (0.95, 0.66, 0.30), "diffuse_color": 0.0, "exponent": 5.0, "radius_u": 1.0}
    paint = {"base_color": (0.35, 0.42, 0.60), "diffuse_color": (0.02, 0.05, 0.30), "exponent": 5.0, "radius_u": 1.0,
             "radius_v": 0.05}
    steel = {"base_color": (0.72, 0.72, 0.74), "exponent": 5.0, "radius_u": 1.0, "radius_v": 0.05}
    return [
        [Sphere(f"v = {v:g}", "edwards_empirical", {**gold, "radius_v": v}) for v in (1.0, 0.4, 0.15, 0.06, 0.02)],
        [Sphere(f"turn {turn:g}°", "edwards_empirical", {**paint, "rotation": turn / 360.0})
         for turn in (0.0, 22.5, 45.0, 67.5, 90.0)],
        [Sphere("upright", "disk_scaling", steel),
         Sphere("tilted", "disk_scaling", steel, axis=(40.0, 0.0)),
         Sphere("to camera", "disk_scaling", steel, axis=(83.0, 0.0)),
         Sphere("sideways", "disk_scaling", steel, axis=(0.0, 60.0)),
         Sphere("brushed", "disk_scaling", steel, brushed=(1.0, 0.0, 1.0))],
    ]


def captions() -> list:
    """Caption of the picture."""
    return [CAPTION]


def build(resolution=RESOLUTION):
    """Empty the file, build and dress the scene with `resolution` (width, height) and return it."""
    scene = parts.empty_scene("Disk spheres", resolution)
    stand, ink = parts.matte("Stand", STAND), parts.matte("Letters", INK)
    ball = None
    for level, row in enumerate(rows()):
        depth, height = level * STEP_DEPTH, level * STEP_HEIGHT
        _step(scene, level, stand)
        for column, sphere in enumerate(row):
            x = (column - 0.5 * (len(row) - 1)) * SPACING
            body = parts.ball(scene, f"Sphere {sphere.label}", RADIUS, ball)
            ball = body.data
            body.location = (x, depth, height + RADIUS)
            body.rotation_euler = (math.radians(sphere.axis[0]), math.radians(sphere.axis[1]), 0.0)
            body.material_slots[0].link = "OBJECT"  # the mesh is shared
            body.material_slots[0].material = _material(sphere)
            label = parts.wear(parts.text(scene, f"Label {sphere.label}", sphere.label, 0.17), ink)
            label.location = (x, depth - 0.5 * STEP_DEPTH - 0.004, height - 0.14)
            label.rotation_euler.x = 0.5 * math.pi
    sky(scene)
    parts.camera(scene, (0.0, -12.0, 2.95), pitch=-6.7, lens=76.0)
    return scene


def prepare(scene, samples: int):
    """Set the renderer to `samples` per pixel at most."""
    picture.prepare(scene, samples, EXPOSURE, INDIRECT_CLAMP, bounces=4)


def render_all(folder: Path, resolution, samples: int, report=None) -> list:
    """Build the scene, render its picture, return the PNG's path in a list. `report(line)` gets the progress."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = build(resolution)
    prepare(scene, samples)
    return picture.write_all([(CAPTION, partial(picture.write, scene, folder, "spheres"))], report)


def save_blend(path: Path, resolution, samples: int):
    """Write the scene to the .blend `path`, with the HDRI packed."""
    scene = build(resolution)
    prepare(scene, samples)
    parts.save(scene, path)


def _step(scene, level, material):
    half, top = 0.5 * STEP_LENGTH, level * STEP_HEIGHT
    outline = [(-half, top - STEP_HEIGHT), (half, top - STEP_HEIGHT), (half, top), (-half, top)]
    body = parts.wear(parts.add(scene, f"Step {level + 1}", shapes.prism(outline, STEP_DEPTH + 0.1), 0.015), material)
    body.location.y = level * STEP_DEPTH + 0.05  # its back is within the next step


def _material(sphere):
    from ... import create_material
    from ...blender.material import groups, sockets

    material = create_material(sphere.model, name=f"{sphere.model} ({sphere.label})", **sphere.parameters)
    if sphere.brushed:
        tree = material.node_tree
        direction = tree.nodes.new("ShaderNodeCombineXYZ")
        direction.name = direction.label = "Brushed along"
        direction.location = (-480.0, 300.0)
        for socket, value in zip(direction.inputs, sphere.brushed, strict=True):
            socket.default_value = value
        tree.links.new(direction.outputs[0], sockets.by_id(groups.find_node(material))["tangent"])
    return material


def sky(scene, name=HDRI, turned=HDRI_TURN):
    """The HDRI `name` of Blender's own, `turned` by degrees about z; packed, so that the file needs none beside it."""
    folder = Path(bpy.utils.resource_path("LOCAL")) / "datafiles" / "studiolights" / "world"
    image = bpy.data.images.load(str(folder / name))
    image.pack()
    image.filepath_raw = f"//{name}"  # no path of this machine in the file
    for packed in image.packed_files:
        packed.filepath = f"//{name}"
    world = scene.world = bpy.data.worlds.new("Sky")
    tree = parts.nodes_of(world)
    coordinates, turn, sky, background, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in (
        "TexCoord", "Mapping", "TexEnvironment", "Background", "OutputWorld"))
    sky.image = image
    turn.inputs["Rotation"].default_value[2] = math.radians(turned)
    for output_socket, input_socket in (
            (coordinates.outputs["Generated"], turn.inputs["Vector"]), (turn.outputs[0], sky.inputs["Vector"]),
            (sky.outputs["Color"], background.inputs["Color"]), (background.outputs[0], output.inputs["Surface"])):
        tree.links.new(output_socket, input_socket)
