"""The demo's six pictures: the reciprocal Phong model, pumped once, and pumped under control, each at two exponents."""
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from ...library.metals import METALS

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
    from ... import create_material

    metal = METALS[metal_id]
    return create_material(
        panel.model, name=f"{metal.label} ({panel.caption})", fresnel_type="conductor", ior=metal.ior,
        extinction=metal.extinction, base_color=metal.f0, **panel.parameters)


def prepare(stage, samples: int):
    """Set the renderer: CPU, OSL, `samples` per pixel at most, no denoising, every bounce between the metals.

    Indirect light brighter than INDIRECT_CLAMP per sample is cut, so that few samples make a clean picture: the
    highlights that metals throw on each other come out a little too dark. Direct light is whole.
    """
    from . import picture

    picture.prepare(stage.scene, samples, EXPOSURE, INDIRECT_CLAMP)


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
    from . import picture

    dress(stage, panel, material_factory)
    return picture.write(stage.scene, folder, panel.stem)


def render_all(folder: Path, resolution, samples: int, material_factory=metal_material, report=None) -> list:
    """Build the scene, render the six panels, return their PNG paths. `report(line)` gets the progress."""
    from . import picture, scene

    folder.mkdir(parents=True, exist_ok=True)
    stage = scene.build(resolution)
    prepare(stage, samples)
    return picture.write_all(
        [(panel.caption, partial(render, stage, panel, folder, material_factory)) for panel in panels()], report)


def captions() -> list:
    """Captions of the six pictures."""
    return [panel.caption for panel in panels()]


def save_blend(path: Path, resolution, samples: int):
    """Write the scene, dressed as the last panel, to the .blend `path`."""
    from . import scene

    stage = scene.build(resolution)
    prepare(stage, samples)
    dress(stage, panels()[-1])
    scene.save(stage, path)
