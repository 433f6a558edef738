"""White spheres in a constant environment: after figure 2 of Edwards et al. Lengths in meters, z up.

A sphere that reflects all that it receives, and no more, cannot be told from what is behind it.
"""
import math
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from . import parts, picture

RESOLUTION = (960, 480)
CAPTION = "All eight are white: what is darker than the background lost light, what is brighter made it"
RADIUS = 0.76
COLUMNS, ROWS = (-3.0, -1.0, 1.0, 3.0), (1.14, -0.84)  # x and z of the spheres
LABEL_DROP, LABEL_SIZE = 0.96, 0.165  # below a sphere's center
VIEW_WIDTH = 8.0
BACKGROUND = 0.6  # radiance: light gray on screen, with room above for a sphere that makes light
EXPONENT = 20.0  # of (N·H)^n; all lobes are about as wide at normal incidence
SLOPE = math.sqrt(2.0 / (EXPONENT + 2.0))  # of Beckmann's distribution (Walter et al. 2007, section 5.2)
# On the disk, h is near tan(theta_h) by the scaling and 2 sin(theta_h) by the orthogonal projection.
SCALING_EXPONENT, ORTHOGONAL_EXPONENT = EXPONENT / 2.0, EXPONENT / 8.0
FIT = {"base_color": 1.0, "f90": 1.0, "exponent": ORTHOGONAL_EXPONENT, "radius": 1.0, "blend": 0.0, "samples": 8}


@dataclass(frozen=True)
class Sphere:
    """A sphere of a `model` with `parameters`."""

    label: str
    model: str
    parameters: dict = field(default_factory=dict)


SPHERES = (
    Sphere("Ward", "ward", {"roughness_u": SLOPE, "roughness_v": SLOPE}),
    Sphere("Ashikhmin-Shirley", "ashikhmin_shirley", {"exponent_u": EXPONENT, "exponent_v": EXPONENT}),
    Sphere("Blinn-Phong", "blinn", {"exponent": EXPONENT}),
    Sphere("Cook-Torrance", "cook_torrance", {"roughness": SLOPE}),
    Sphere("Edwards fit, raw", "edwards_fit", {**FIT, "renormalize": False}),
    Sphere("Edwards fit, renormalized", "edwards_fit", FIT),
    Sphere("Edwards empirical", "edwards_empirical",
           {"base_color": 1.0, "diffuse_color": 0.0, "exponent": SCALING_EXPONENT}),
    Sphere("Reciprocal disk, pumped", "reciprocal_disk", {"exponent": SCALING_EXPONENT}),
)


def captions() -> list:
    """Caption of the picture."""
    return [CAPTION]


def build(resolution=RESOLUTION):
    """Empty the file, build and dress the scene with `resolution` (width, height) and return it."""
    from ... import create_material

    scene = parts.empty_scene("Furnace", resolution)
    ink = parts.matte("Letters", (0.0, 0.0, 0.0))
    parts.gradient_sky(scene, {0.0: (BACKGROUND,) * 3, 1.0: (BACKGROUND,) * 3})
    # The materials sample all that they reflect; light sampled from the sky besides would be noise and time.
    scene.world.cycles.sampling_method = "NONE"
    mesh = None
    for index, sphere in enumerate(SPHERES):
        x, z = COLUMNS[index % len(COLUMNS)], ROWS[index // len(COLUMNS)]
        body = parts.ball(scene, f"Sphere {sphere.label}", RADIUS, mesh)
        mesh = body.data
        body.location = (x, 0.0, z)
        body.material_slots[0].link = "OBJECT"  # the mesh is shared
        body.material_slots[0].material = create_material(sphere.model, name=sphere.label, **sphere.parameters)
        label = parts.wear(parts.text(scene, f"Label {sphere.label}", sphere.label, LABEL_SIZE), ink)
        label.location = (x, 0.0, z - LABEL_DROP)
        label.rotation_euler.x = 0.5 * math.pi
        for seen in (body, label):  # by the camera alone: spheres see nothing but the environment
            seen.visible_diffuse = seen.visible_glossy = seen.visible_transmission = seen.visible_shadow = False
    camera = parts.camera(scene, (0.0, -10.0, 0.0), pitch=0.0, lens=50.0).data
    camera.type, camera.ortho_scale = "ORTHO", VIEW_WIDTH
    return scene


def prepare(scene, samples: int):
    """Set the renderer to `samples` per pixel."""
    picture.prepare(scene, samples, exposure=0.0, indirect_clamp=0.0, bounces=1)
    scene.cycles.use_adaptive_sampling = False  # its threshold is more than what is to be seen
    scene.render.dither_intensity = 0.0  # so that the background is one value


def render_all(folder: Path, resolution, samples: int, report=None) -> list:
    """Build the scene, render its picture, return the PNG's path in a list. `report(line)` gets the progress."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = build(resolution)
    prepare(scene, samples)
    return picture.write_all([(CAPTION, partial(picture.write, scene, folder, "furnace"))], report)


def save_blend(path: Path, resolution, samples: int):
    """Write the scene to the .blend `path`."""
    scene = build(resolution)
    prepare(scene, samples)
    parts.save(scene, path)

