"""The scene of the pumping paper's figure 8, built in bpy: a golden tank among metal pyramids.

Everything is a mesh with modifiers; no file is read. Metal faces are seen at every angle up to grazing, since that is
where the models differ: the floor is a sheet of metal seen from low above, and each pyramid turns one face nearly
edge-on. Lengths in meters, z up, the camera looks along +y.
"""
import math
from dataclasses import dataclass

import bpy

from . import parts, shapes

CAMERA = (0.08, -8.2, 1.6)
FLOOR_RADIUS = 10.0
SKY = {  # sine of the elevation: linear RGB radiance
    0.00: (0.98, 0.93, 0.86), 0.15: (0.76, 0.80, 0.84), 0.45: (0.54, 0.56, 0.60), 1.00: (0.42, 0.43, 0.46),
}
GROUND = (0.25, 0.21, 0.16)
# Point lights: position (m), radiant power (W), radius (m), linear RGB.
LIGHTS = {
    "Key": ((-3.6, -4.2, 6.2), 200.0, 0.3, (1.0, 0.95, 0.88)),
    "Fill": ((5.2, -1.6, 4.8), 140.0, 0.3, (0.9, 0.95, 1.0)),
}
# Pyramids: metal, base side, position, turn (degrees; at 0 one face looks at the camera, at 45 an edge does).
PYRAMIDS = (
    ("aluminium", 1.60, (-1.95, 1.75), -19.0),
    ("silver", 1.15, (-1.28, -1.70), 20.0),
    ("copper", 1.25, (1.22, -1.95), -22.0),
    ("gold", 1.70, (2.22, 0.75), -17.0),
)
SLOPE = math.radians(51.8)  # of the Great Pyramid's faces
# The tank's parts: profiles to turn (radius, height) and outlines to extrude (x, z), with its front towards +x.
DRUM = shapes.rounded([
    (0.0, 0.0), (0.10, 0.0), (0.125, 0.02), (0.125, 0.19), (0.133, 0.20), (0.133, 0.22), (0.125, 0.23), (0.125, 0.47),
    (0.133, 0.48), (0.133, 0.50), (0.125, 0.51), (0.125, 0.68), (0.10, 0.70), (0.0, 0.70)], 0.01)
WHEEL = shapes.rounded([
    (0.0, -0.05), (0.215, -0.05), (0.215, 0.05), (0.155, 0.05), (0.135, 0.015), (0.06, 0.02), (0.05, 0.075),
    (0.0, 0.075)], 0.02)
DOME = shapes.rounded([
    (0.0, 0.0), (0.50, 0.0), (0.60, 0.05), (0.66, 0.15), (0.60, 0.28), (0.44, 0.39), (0.24, 0.44), (0.0, 0.455)],
    0.3, 10)
CUPOLA = shapes.rounded([
    (0.0, 0.0), (0.19, 0.0), (0.19, 0.10), (0.21, 0.10), (0.21, 0.135), (0.14, 0.17), (0.0, 0.18)], 0.012)
BARREL = shapes.rounded([
    (0.0, 0.0), (0.15, 0.0), (0.13, 0.16), (0.072, 0.22), (0.058, 1.15), (0.085, 1.16), (0.085, 1.34), (0.045, 1.34),
    (0.045, 1.20), (0.0, 1.20)], 0.012)
HULL = [(-1.22, 0.42), (-1.05, 0.24), (1.00, 0.24), (1.32, 0.52), (0.82, 0.80), (-1.16, 0.80)]
FENDER = [(-1.42, 0.60), (1.42, 0.60), (1.42, 0.64), (-1.42, 0.64)]


@dataclass(frozen=True)
class Stage:
    """The built scene and the objects that wear each metal: metal id -> list of objects."""

    scene: object
    wearers: dict


def build(resolution=(480, 360)) -> Stage:
    """Empty the file, build the scene with `resolution` (width, height) and return it. No metal is assigned yet."""
    scene = parts.empty_scene("Pumped metals", resolution)
    wearers = {metal: [] for metal, *_ in PYRAMIDS}
    wearers["gold"] += _tank(scene)
    for metal, side, position, turn in PYRAMIDS:
        body = parts.add(scene, f"Pyramid {metal}", shapes.pyramid(side, 0.5 * side * math.tan(SLOPE)), bevel=0.012)
        to_camera = math.atan2(CAMERA[0] - position[0], position[1] - CAMERA[1])
        body.location, body.rotation_euler = (*position, 0.0), (0.0, 0.0, to_camera + math.radians(turn))
        wearers[metal].append(body)
    edge = shapes.rounded([(0.0, -0.12), (FLOOR_RADIUS, -0.12), (FLOOR_RADIUS, 0.0), (0.0, 0.0)], 0.03)
    wearers["nickel"] = [parts.add(scene, "Floor", shapes.lathe(edge, 256))]
    _ground(scene)
    parts.gradient_sky(scene, SKY)
    for name, light in LIGHTS.items():
        _point_light(scene, name, *light)
    parts.camera(scene, CAMERA, pitch=-8.0, lens=55.0)
    return Stage(scene, wearers)


def dress(stage: Stage, material_of_metal):
    """Give each object the material `material_of_metal[metal id]`."""
    for metal, objects in stage.wearers.items():
        for body in objects:
            parts.wear(body, material_of_metal[metal])


def save(stage: Stage, path):
    """Write the scene to `path`, compressed, with all that it needs and no path of this machine."""
    parts.save(stage.scene, path)


def _tank(scene):
    """The tank, facing the camera's right: hull, tracks with wheels, turret, gun. Returns its objects."""
    bodies = [parts.add(scene, "Hull", shapes.prism(HULL, 0.96), 0.045), *_tracks(scene), *_turret(scene)]
    pivot = parts.place(scene, "Tank", None)
    for part in bodies:
        part.parent = pivot
    pivot.location, pivot.rotation_euler = (0.05, 0.95, 0.0), (0.0, 0.0, math.radians(-33.0))
    return bodies


def _tracks(scene):
    wheels = [parts.add(scene, "Wheel", shapes.lathe(WHEEL, 64))]
    wheels += [parts.place(scene, "Wheel", wheels[0].data) for _ in range(9)]
    for i, wheel in enumerate(wheels):
        side = 1.0 if i < 5 else -1.0
        wheel.location = (-1.09 + 0.545 * (i % 5), side * 0.82, 0.28)
        wheel.rotation_euler.x = -side * 0.5 * math.pi
    bodies = wheels
    for side in (-1.0, 1.0):
        track = parts.add(scene, "Track", shapes.prism(shapes.stadium(2.75, 0.56), 0.34), 0.035)
        track.location.y = side * 0.67
        fender = parts.add(scene, "Fender", shapes.prism(FENDER, 0.40), 0.015)
        fender.location.y = side * 0.67
        drum = parts.add(scene, "Drum", shapes.lathe(DRUM))
        drum.location, drum.rotation_euler.y = (-1.28, side * 0.70, 0.765), 0.5 * math.pi
        bodies += [track, fender, drum]
    return bodies


def _turret(scene):
    turret = parts.add(scene, "Turret", shapes.lathe(DOME, 128))
    turret.location, turret.scale = (-0.12, 0.0, 0.80), (1.12, 0.88, 1.0)
    hatch = parts.add(scene, "Cupola", shapes.lathe(CUPOLA, 96))
    hatch.location = (-0.30, 0.12, 1.215)
    gun = parts.add(scene, "Gun", shapes.lathe(BARREL, 96))
    gun.location, gun.rotation_euler = (0.50, 0.0, 1.00), (0.0, math.radians(84.0), 0.0)
    return [turret, hatch, gun]


def _ground(scene):
    ground = parts.add(scene, "Ground", shapes.lathe([(400.0, -0.12), (0.0, -0.12)], 64))
    parts.wear(ground, parts.matte("Ground", GROUND))


def _point_light(scene, name, position, power, radius, color):
    data = bpy.data.lights.new(name, "POINT")
    data.energy, data.shadow_soft_size, data.color = power, radius, color
    parts.place(scene, name, data).location = position
