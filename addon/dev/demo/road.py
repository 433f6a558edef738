"""A road at night in a driver's headlights: after figure 10 of Edwards et al.

Signs, markings and posts are diffuse in one picture, and in the other retroreflectors of the same colors. Lengths in
meters, z up; the road leaves the camera along +y, climbs a little and bends to the left. Traffic keeps to the right.
"""
import math
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import bpy

from . import parts, picture, shapes

RESOLUTION = (640, 368)
EXPOSURE = 0.0  # stops, the same for both
INDIRECT_CLAMP = 1.0
EYE = (1.6, 0.0, 1.30)
LENS = 36.0  # mm, on a sensor 36 mm wide
# The car's lamps, to both sides of the eye and 0.6 m below it; power (W), half the beam's angle and its dip (degrees),
# radius (m).
HEADLIGHTS = ((1.15, 0.6, 0.70), (2.35, 0.6, 0.70))
HEADLIGHT_POWER, HEADLIGHT_ANGLE, HEADLIGHT_PITCH, HEADLIGHT_RADIUS = 1250.0, 32.0, 0.8, 0.05
HEADLIGHT_COLOR = (1.0, 0.95, 0.86)
SKY = {0.00: (0.0060, 0.0068, 0.0100), 0.06: (0.0026, 0.0036, 0.0075), 0.35: (0.0008, 0.0013, 0.0034)}
BEND_START, BEND_RADIUS = 38.0, 170.0
CLIMB_START, CLIMB_RADIUS = 20.0, 1500.0
ROAD_END, HALF_WIDTH = 170.0, 3.9
ASPHALT, VERGE, LEAVES, METAL = (0.11, 0.11, 0.115), (0.07, 0.09, 0.035), (0.035, 0.075, 0.03), (0.25, 0.25, 0.26)
# Colors of what shines: linear RGB, as diffuse albedo and as F0 alike.
COLORS = {
    "white": (0.85, 0.85, 0.82), "red": (0.60, 0.02, 0.025), "blue": (0.015, 0.09, 0.42), "yellow": (0.85, 0.55, 0.04),
    "paint": (0.80, 0.80, 0.76),
}
BLACK = (0.008, 0.008, 0.008)
LIFT = 0.006  # between layers that lie on one another: sheets on a board, paint on the road


@dataclass(frozen=True)
class Version:
    """One picture: `stem` names its files; `parameters` are what makes a color shine back, None for diffuse."""

    stem: str
    caption: str
    parameters: dict | None = None
    paint: dict = field(default_factory=dict)


VERSIONS = (
    Version("road_diffuse", "diffuse reflectors"),
    Version("road_retro", "retroreflectors: Edwards Empirical, k = 0.8",
            {"retro": 0.8, "retro_exponent": 60.0, "exponent": 20.0},
            # At grazing the disk takes lamp and eye, one twice as high as the other, far apart: a narrower lump would
            # miss the eye close by; this one is 7 times as bright as diffuse paint at 6 m and 170 times at 70 m.
            {"retro_exponent": 78.0}),
)


@dataclass(frozen=True)
class Sign:
    """A sign beside the road: `at` meters ahead and `offset` to the right of the middle, its center `height` above."""

    name: str
    at: float
    offset: float
    height: float


SIGNS = (Sign("Limit", 20.0, 5.1, 2.35), Sign("Bend", 31.0, 5.4, 2.3), Sign("Guide", 27.0, -6.4, 2.7))


@dataclass(frozen=True)
class Stage:
    """The built scene, and the objects that wear each of COLORS: color -> list of objects."""

    scene: object
    wearers: dict


def captions() -> list:
    """Captions of the two pictures."""
    return [version.caption for version in VERSIONS]


def centre(s: float, offset: float = 0.0, height: float = 0.0):
    """Point (x, y, z) `s` meters along the road, `offset` to the right of its middle and `height` above it."""
    turn = heading(s)
    bent = max(s - BEND_START, 0.0)
    x = -BEND_RADIUS * (1.0 - math.cos(bent / BEND_RADIUS))
    y = min(s, BEND_START) + BEND_RADIUS * math.sin(bent / BEND_RADIUS)
    z = max(s - CLIMB_START, 0.0) ** 2 / (2.0 * CLIMB_RADIUS)
    return x + offset * math.cos(turn), y + offset * math.sin(turn), z + height


def heading(s: float) -> float:
    """Direction of the road `s` meters along it, in radians to the left of +y."""
    return max(s - BEND_START, 0.0) / BEND_RADIUS


def build(resolution=RESOLUTION) -> Stage:
    """Empty the file, build the scene with `resolution` (width, height) and return it. Nothing shines yet."""
    scene = parts.empty_scene("Night road", resolution)
    stage = Stage(scene, {color: [] for color in COLORS})
    dull = {name: parts.matte(name, color) for name, color in (
        ("Verge", VERGE), ("Leaves", LEAVES), ("Metal", METAL), ("Black", BLACK))}
    _land(scene, dull["Verge"])
    parts.wear(_ribbon(scene, "Road", -HALF_WIDTH, HALF_WIDTH, -4.0, ROAD_END), _asphalt())
    _markings(stage)
    _posts(stage, dull["Black"])
    _limit_sign(stage, SIGNS[0], dull)
    _bend_sign(stage, SIGNS[1], dull)
    _guide_sign(stage, SIGNS[2], dull)
    _chevrons(stage, dull)
    _trees(scene, dull["Leaves"])
    parts.gradient_sky(scene, SKY)
    for position in HEADLIGHTS:
        _headlight(scene, position)
    parts.camera(scene, EYE, pitch=-0.3, lens=LENS, yaw=3.0)
    return stage


def dress(stage: Stage, version: Version):
    """Give the scene the materials of `version`; those of the version before are deleted."""
    old = {material for bodies in stage.wearers.values() for body in bodies for material in body.data.materials}
    for color, bodies in stage.wearers.items():
        material = _shining(color, version)
        for body in bodies:
            parts.wear(body, material)
    for material in old - {None}:
        bpy.data.materials.remove(material)


def prepare(stage: Stage, samples: int):
    """Set the renderer to `samples` per pixel at most."""
    picture.prepare(stage.scene, samples, EXPOSURE, INDIRECT_CLAMP, bounces=2)


def render(stage: Stage, version: Version, folder: Path) -> Path:
    """Render `version` to `folder`/<stem>.exr (float32, linear Rec. 709) and <stem>.png; returns the PNG's path."""
    dress(stage, version)
    return picture.write(stage.scene, folder, version.stem)


def render_all(folder: Path, resolution, samples: int, report=None) -> list:
    """Build the scene, render both versions, return their PNG paths. `report(line)` gets the progress."""
    folder.mkdir(parents=True, exist_ok=True)
    stage = build(resolution)
    prepare(stage, samples)
    return picture.write_all([(v.caption, partial(render, stage, v, folder)) for v in VERSIONS], report)


def save_blend(path: Path, resolution, samples: int):
    """Write the scene, with its retroreflectors, to the .blend `path`."""
    stage = build(resolution)
    prepare(stage, samples)
    dress(stage, VERSIONS[-1])
    parts.save(stage.scene, path)


def _shining(color, version):
    from ... import create_material

    name = f"Road {color}" if color == "paint" else f"Sheet {color}"
    if version.parameters is None:
        return parts.matte(f"{name}, diffuse", COLORS[color])
    parameters = {**version.parameters, **(version.paint if color == "paint" else {})}
    return create_material("edwards_empirical", name=name, base_color=COLORS[color], diffuse_color=COLORS[color],
                           **parameters)


def _asphalt():
    """Matte, with grains of stone: they let the eye see how far the light reaches."""
    material = parts.matte("Asphalt", ASPHALT)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    coordinates, noise, ramp = (nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "ValToRGB"))
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 9.0, 8.0
    for element, position, factor in zip(ramp.color_ramp.elements, (0.3, 0.7), (0.45, 1.6), strict=True):
        element.position, element.color = position, (*(factor * c for c in ASPHALT), 1.0)
    links.new(coordinates.outputs["Object"], noise.inputs["Vector"])
    links.new(noise.outputs[0], ramp.inputs[0])
    diffuse = next(node for node in nodes if node.bl_idname == "ShaderNodeBsdfDiffuse")
    links.new(ramp.outputs["Color"], diffuse.inputs["Color"])
    return material


def _land(scene, material):
    """Fields on both sides: they follow the road's climb."""
    body = _ribbon(scene, "Fields", -90.0, 160.0, -30.0, ROAD_END, height=-0.10, step=10.0)
    return parts.wear(body, material)


def _ribbon(scene, name, left, right, start, end, height=0.0, step=2.0):
    """A strip along the road between two offsets, from `start` to `end`."""
    return parts.add(scene, name, _strip(left, right, start, end, height, step))


def _strip(left, right, start, end, height=0.0, step=2.0):
    count = max(math.ceil((end - start) / step), 1)
    stations = [start + (end - start) * i / count for i in range(count + 1)]
    vertices = [centre(s, offset, height) for s in stations for offset in (left, right)]
    return vertices, [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(count)]


def _joined(shapes_):
    """One body of several."""
    vertices, faces = [], []
    for more, sides in shapes_:
        faces += [tuple(i + len(vertices) for i in side) for side in sides]
        vertices += more
    return vertices, faces


def _markings(stage):
    edges = [_strip(side * 3.5 - 0.08, side * 3.5 + 0.08, -3.0, ROAD_END, LIFT) for side in (-1.0, 1.0)]
    dashes = [_strip(-0.08, 0.08, s, s + 4.0, LIFT) for s in range(5, int(ROAD_END) - 8, 9)]
    stage.wearers["paint"] += [parts.add(stage.scene, "Edge lines", _joined(edges)),
                               parts.add(stage.scene, "Middle line", _joined(dashes))]


def _flat(outline):
    """A polygon of (x, z) pairs in the xz plane that faces -y, towards the driver."""
    return [(x, 0.0, z) for x, z in outline], [tuple(range(len(outline)))]


def _rectangle(width, height, x=0.0, z=0.0):
    return [(x - width / 2, z - height / 2), (x + width / 2, z - height / 2), (x + width / 2, z + height / 2),
            (x - width / 2, z + height / 2)]


def _regular(radius, count, first=90.0):
    """A regular polygon of `count` corners, the first at `first` degrees from +x."""
    angles = [math.radians(first) + 2.0 * math.pi * i / count for i in range(count)]
    return [(radius * math.cos(a), radius * math.sin(a)) for a in angles]


def _pivot(scene, name, at, offset, height):
    """An empty beside the road that looks back along it, for the parts of a sign."""
    pivot = parts.place(scene, name, None)
    pivot.location, pivot.rotation_euler.z = centre(at, offset, height), heading(at)
    return pivot


def _on(pivot, body, layer, material=None):
    """Hang `body` on a sign, `layer` sheets in front of its board."""
    body.parent, body.location.y = pivot, -layer * LIFT
    return parts.wear(body, material) if material else body


def _sheet(stage, pivot, name, outline, layer, color):
    body = _on(pivot, parts.add(stage.scene, name, _flat(outline)), layer)
    stage.wearers[color].append(body)


def _board(scene, pivot, dull, outline, height, columns=(0.0,)):
    """The sign's back of metal, and the columns that carry it from the ground, `height` below its center."""
    back = parts.add(scene, f"{pivot.name} back", shapes.prism(outline, 0.02))
    back.parent, back.location.y = pivot, 0.012
    parts.wear(back, dull["Metal"])
    for x in columns:
        column = parts.add(scene, f"{pivot.name} column", shapes.lathe([(0.04, -height - 0.2), (0.04, 0.3)], 16))
        column.parent, column.location = pivot, (x, 0.07, 0.0)
        parts.wear(column, dull["Metal"])


def _words(stage, pivot, words, size, layer, x=0.0, z=0.0):
    body = _on(pivot, parts.text(stage.scene, f"{pivot.name} {words}", words, size), layer)
    body.location.x, body.location.z, body.rotation_euler.x = x, z, 0.5 * math.pi
    return body


def _limit_sign(stage, sign, dull):
    pivot = _pivot(stage.scene, sign.name, sign.at, sign.offset, sign.height)
    _board(stage.scene, pivot, dull, _regular(0.56, 48), sign.height)
    _sheet(stage, pivot, "Limit ring", _regular(0.55, 48), 1, "red")
    _sheet(stage, pivot, "Limit face", _regular(0.42, 48), 2, "white")
    parts.wear(_words(stage, pivot, "70", 0.62, 3), dull["Black"])


def _bend_sign(stage, sign, dull):
    """A warning of the bend: a red triangle about a white one, and an arrow that turns left."""
    pivot = _pivot(stage.scene, sign.name, sign.at, sign.offset, sign.height)
    _board(stage.scene, pivot, dull, _regular(0.83, 3), sign.height)
    _sheet(stage, pivot, "Bend frame", _regular(0.82, 3), 1, "red")
    _sheet(stage, pivot, "Bend face", _regular(0.56, 3), 2, "white")
    shaft = [(0.08, -0.22), (0.18, -0.22), (0.18, -0.05), (0.0, 0.10), (-0.07, 0.03), (0.08, -0.09)]
    head = [(-0.16, 0.20), (-0.17, -0.05), (0.09, 0.17)]
    for outline in (shaft, head):
        _on(pivot, parts.add(stage.scene, "Bend arrow", _flat(outline)), 3, dull["Black"])


def _guide_sign(stage, sign, dull):
    pivot = _pivot(stage.scene, sign.name, sign.at, sign.offset, sign.height)
    _board(stage.scene, pivot, dull, _rectangle(4.0, 1.9), sign.height, (-1.4, 1.4))
    _sheet(stage, pivot, "Guide rim", _rectangle(4.0, 1.9), 1, "white")
    _sheet(stage, pivot, "Guide face", _rectangle(3.86, 1.76), 2, "blue")
    for words, z in (("Halfway   12", 0.40), ("Diskville   25", -0.38)):
        stage.wearers["white"].append(_words(stage, pivot, words, 0.62, 3, z=z))


def _chevrons(stage, dull):
    """Boards on the outside of the bend, their chevrons pointing into it."""
    for number, at in enumerate((46.0, 58.0, 70.0, 82.0, 94.0, 106.0, 118.0)):
        pivot = _pivot(stage.scene, f"Chevron {number + 1}", at, 5.6, 1.35)
        _board(stage.scene, pivot, dull, _rectangle(1.3, 1.1), 1.35)
        _sheet(stage, pivot, "Chevron face", _rectangle(1.3, 1.1), 1, "yellow")
        outline = [(-0.50, 0.0), (0.10, -0.45), (0.45, -0.45), (-0.12, 0.0), (0.45, 0.45), (0.10, 0.45)]
        _on(pivot, parts.add(stage.scene, "Chevron", _flat(outline)), 2, dull["Black"])


def _posts(stage, black):
    """Edge posts: white on the left, with a black band and a reflector, white or yellow."""
    plastic = parts.matte("Plastic", (0.45, 0.45, 0.44))
    for at in range(10, int(ROAD_END), 12):
        for side, color in ((-1.0, "white"), (1.0, "yellow")):
            pivot = _pivot(stage.scene, "Post", at, side * 4.5, 0.0)
            for name, size, z, layer, material in (("Post body", (0.13, 1.0), 0.5, 1, plastic),
                                                   ("Post band", (0.13, 0.26), 0.78, 2, black)):
                body = parts.add(stage.scene, name, shapes.prism(_rectangle(*size, z=z), 0.08))
                _on(pivot, body, layer, material)
            _sheet(stage, pivot, "Post reflector", _rectangle(0.08, 0.2, z=0.78), 10, color)


def _trees(scene, material):
    """Spruces beside the road, one mesh, placed by a fixed rule."""
    profile = [(0.10, -0.3), (0.10, 1.0), (1.5, 0.8), (0.5, 2.9), (1.2, 2.7), (0.35, 4.6), (0.8, 4.4), (0.0, 7.0)]
    mesh = None
    for i in range(60):
        at, side = 24.0 + 2.4 * i, 1.0 if i % 2 else -1.0
        offset = side * (10.0 + 7.0 * ((i * 0.618034) % 1.0))
        tree = parts.place(scene, "Spruce", mesh) if mesh else parts.add(scene, "Spruce", shapes.lathe(profile, 9))
        mesh = tree.data
        tree.location, tree.rotation_euler.z = centre(at, offset, -0.1), i
        tree.scale = (0.8 + 0.5 * ((i * 0.7548) % 1.0),) * 3
    parts.wear(tree, material)


def _headlight(scene, position):
    data = bpy.data.lights.new("Headlight", "SPOT")
    data.energy, data.color, data.shadow_soft_size = HEADLIGHT_POWER, HEADLIGHT_COLOR, HEADLIGHT_RADIUS
    data.spot_size, data.spot_blend = math.radians(2.0 * HEADLIGHT_ANGLE), 1.0
    lamp = parts.place(scene, "Headlight", data)
    lamp.location = position
    lamp.rotation_euler.x = math.radians(90.0 - HEADLIGHT_PITCH)  # a spot shines along its -z
