"""The demo's six pictures: the reciprocal Phong model, pumped once, and pumped under control, each at two exponents."""
import contextlib
import os
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from ..brdf.metals import METALS

EXPONENTS = (20.0, 5000.0)
# Row: file name's stem, caption, model, its parameters.
ROWS = (
    ("phong", "reciprocal Phong", "phong", {}),
    ("pumped", "pumped up once", "pumped_phong", {"pumps": 1.0, "control": False}),
    ("controlled", "pumped up twice, controlled", "pumped_phong", {"pumps": 2.0, "control": True}),
)
EXPOSURE = -0.15  # stops, the same for all: the sky at the horizon stays just below white
INDIRECT_CLAMP = 4.0  # of white


@dataclass(frozen=True)
class Panel:
    """One picture: `stem` names its files."""

    stem: str
    caption: str
    model: str
    parameters: dict = field(default_factory=dict)


def panels() -> list:
    """The six panels, row by row."""
    return [
        Panel(f"{stem}_n{exponent:g}", f"{caption}, n = {exponent:g}", model, {"exponent": exponent, **parameters})
        for stem, caption, model, parameters in ROWS for exponent in EXPONENTS
    ]


def metal_material(metal_id: str, panel: Panel):
    """The material that a metal wears in a panel: the panel's model with the exact reflectance of the metal."""
    from .. import create_material

    metal = METALS[metal_id]
    return create_material(
        panel.model, name=f"{metal.label} ({panel.caption})", fresnel_type="conductor", ior=metal.ior,
        extinction=metal.extinction, base_color=metal.f0, **panel.parameters)


def prepare(stage, samples: int):
    """Set the renderer: CPU, OSL, `samples` per pixel at most, no denoising, every bounce between the metals.

    Indirect light brighter than INDIRECT_CLAMP per sample is cut, so that few samples make a clean picture: the
    highlights that metals throw on each other come out a little too dark. Direct light is whole.
    """
    scene = stage.scene
    cycles = scene.cycles
    cycles.device, cycles.shading_system = "CPU", True
    cycles.samples, cycles.seed = samples, 0
    cycles.use_adaptive_sampling, cycles.adaptive_threshold = True, 0.02
    cycles.use_denoising = False
    cycles.max_bounces = cycles.glossy_bounces = 8
    cycles.caustics_reflective = True
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct, cycles.sample_clamp_indirect = 0.0, INDIRECT_CLAMP
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.exposure = EXPOSURE


def dress(stage, panel: Panel, material_factory=metal_material):
    """Give the scene the materials of `panel`; those of the panel before are deleted."""
    import bpy

    from . import scene

    old = {material for bodies in stage.wearers.values() for body in bodies for material in body.data.materials}
    scene.dress(stage, {metal: material_factory(metal, panel) for metal in stage.wearers})
    for material in old - {None}:
        bpy.data.materials.remove(material)


def render(stage, panel: Panel, folder: Path, material_factory=metal_material) -> Path:
    """Render `panel` to `folder`/<stem>.exr (float32, linear Rec. 709) and <stem>.png; returns the PNG's path."""
    import bpy

    dress(stage, panel, material_factory)
    settings = stage.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    settings.exr_codec = "ZIP"
    stage.scene.render.filepath = str(folder / f"{panel.stem}.exr")
    with quiet():
        bpy.ops.render.render(write_still=True, scene=stage.scene.name)
    image = bpy.data.images.load(stage.scene.render.filepath)
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "8"
    png = folder / f"{panel.stem}.png"
    image.save_render(str(png), scene=stage.scene)
    bpy.data.images.remove(image)
    return png


def render_all(folder: Path, resolution, samples: int, material_factory=metal_material, report=None) -> list:
    """Build the scene, render the six panels, return their PNG paths. `report(line)` is told of each."""
    from . import scene

    folder.mkdir(parents=True, exist_ok=True)
    stage = scene.build(resolution)
    prepare(stage, samples)
    paths = []
    for number, panel in enumerate(panels(), 1):
        start = time.monotonic()
        paths.append(render(stage, panel, folder, material_factory))
        if report:
            report(f"[{number}/{len(panels())}] {panel.caption}: {time.monotonic() - start:.0f} s")
    return paths


@contextlib.contextmanager
def quiet():
    """Keep what the renderer prints off the standard output, where the command's results belong."""
    sys.stdout.flush()
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)
