"""Previews of models and presets: a ball each, in one neutral light. Lengths in meters, z up."""
import math
from pathlib import Path

import bpy

from ...forms.files import replacing
from ...library.metals import METALS
from ...models import MODELS
from ...models.pumped_model import PumpedModel
from . import parts, picture

SIDE, SAMPLES, COLORS = 128, 48, 128
BACKGROUND = (40, 40, 42)  # of 255: between a dark theme's panel and the ball's dark side
HDRI = "city.exr"  # comes with Blender, CC0: gray light from all sides, in which rims tell grazing albedos
STRENGTH, TURN = 0.55, 60.0  # of the HDRI; degrees about z
# Lights as (azimuth from the camera, elevation, both in degrees, W/m², angular size in degrees): one over the camera's
# left shoulder, small enough to show the shape of a highlight, and one at the camera for what reflects back.
KEY, HEADLIGHT = (-38.0, 42.0, 0.9, 5.0), (0.0, 3.0, 0.1, 5.0)
EXPOSURE = 0.0  # stops
DISTANCE, LENS = 6.0, 96.0  # of the camera: meters, mm
# Models that do not look typical at their defaults, and better values.
SPECIAL = {
    "phong_original": {"base_color": (1.0, 0.78, 0.42), "diffuse_color": (0.30, 0.19, 0.05)},
    "blinn_original": {"base_color": (1.0, 0.78, 0.42), "diffuse_color": (0.30, 0.19, 0.05)},
    "kajiya_kay": {"base_color": (0.10, 0.065, 0.03), "diffuse_color": (0.05, 0.025, 0.01)},
}


def look(model_id: str) -> dict:
    """Parameters that a model is shown with: its defaults, in gold where it is a metal, in copper where pumped up."""
    model, ids = MODELS[model_id], {p.id for p in MODELS[model_id].parameters}
    metal = METALS["copper" if isinstance(model, PumpedModel) or "pumps" in ids else "gold"]
    if model_id in SPECIAL:
        return SPECIAL[model_id]
    if "fresnel_type" in ids:
        return {"fresnel_type": "conductor", "ior": metal.ior, "extinction": metal.extinction, "base_color": metal.f0}
    if "base_color" in ids and model.parameter("base_color").default == (1.0, 1.0, 1.0):
        return {"base_color": metal.f0}
    return {}


def render(path: Path, model_id: str, parameters: dict, headlight: bool = False):
    """Render the ball with a model, quantize it and write it to `path`, which is replaced when all is done."""
    from PIL import Image

    from ... import create_material

    scene = _stage(headlight)
    body = next(thing for thing in scene.objects if thing.type == "MESH")
    parts.wear(body, create_material(model_id, **parameters))
    path.parent.mkdir(parents=True, exist_ok=True)
    raw = path.with_name(f".{path.name}.raw.png")
    scene.render.filepath = str(raw)
    try:
        with picture.quiet():
            bpy.ops.render.render(write_still=True, scene=scene.name)
        with Image.open(raw) as rendered:
            over = Image.new("RGBA", rendered.size, (*BACKGROUND, 255))
            over.alpha_composite(rendered.convert("RGBA"))
        few = over.convert("RGB").quantize(COLORS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        with replacing(path) as beside:
            few.save(beside, format="PNG", optimize=True)
    finally:
        raw.unlink(missing_ok=True)


def _stage(headlight):
    """The emptied file's scene with ball, lights and camera, ready to render."""
    scene = parts.empty_scene("Preview", (SIDE, SIDE))
    parts.ball(scene, "Ball", 1.0)
    for sun in (KEY, HEADLIGHT) if headlight else (KEY,):
        _sun(scene, *sun)
    _sky(scene)
    parts.camera(scene, (0.0, -DISTANCE, 0.0), pitch=0.0, lens=LENS)
    picture.prepare(scene, SAMPLES, EXPOSURE, indirect_clamp=0.0, bounces=2)
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = True
    scene.render.film_transparent = True
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGBA", "8"
    return scene


def _sun(scene, azimuth, elevation, power, size):
    data = bpy.data.lights.new("Sun", "SUN")
    data.energy, data.angle = power, math.radians(size)
    # A sun shines along its -z; azimuth 0 shines from the camera, which looks along +y.
    body = parts.place(scene, "Sun", data)
    body.rotation_euler = (math.radians(90.0 - elevation), 0.0, math.radians(azimuth))


def _sky(scene):
    folder = Path(bpy.utils.resource_path("LOCAL")) / "datafiles" / "studiolights" / "world"
    world = scene.world = bpy.data.worlds.new("Sky")
    tree = parts.nodes_of(world)
    coordinates, turn, sky, background, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in (
        "TexCoord", "Mapping", "TexEnvironment", "Background", "OutputWorld"))
    sky.image = bpy.data.images.load(str(folder / HDRI))
    turn.inputs["Rotation"].default_value[2] = math.radians(TURN)
    background.inputs["Strength"].default_value = STRENGTH
    for output_socket, input_socket in (
            (coordinates.outputs["Generated"], turn.inputs["Vector"]), (turn.outputs[0], sky.inputs["Vector"]),
            (sky.outputs["Color"], background.inputs["Color"]), (background.outputs[0], output.inputs["Surface"])):
        tree.links.new(output_socket, input_socket)
