"""A lamp near the focus of a metal paraboloid, seen off its axis, by several models: the figure of its light points.

After Sawicki, "Modeling the metallic reflection using appropriate BRDF model", who compares models for simulating such
figures and makes them comparable by one angle of the half vector at which each has fallen to half of its peak. The
paper gives neither reflector, lamp nor view: these are ours. Lengths in meters, z along the reflector's axis.
"""
import json
import math
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import bpy
import numpy as np

from ... import brdf
from ...fitting import match
from . import parts, picture, shapes

FOCUS, RIM = 0.1, 0.19  # focal length, and radius of the rim
# So far inside the focus that the near wall mirrors the lamp to the camera: lobes are seen, not their tails alone.
LAMP = (0.0, 0.0, 0.06)
LAMP_POWER, LAMP_RADIUS = 0.02, 0.002  # W and m: the brightest picture just stays below white
VIEW_ANGLE = 30.0  # degrees between the axis and the view, which is parallel
VIEW_WIDTH = 0.48
CENTRE = (0.0, 0.0, 0.035)  # what the camera looks at
DECADES = 3.0  # of the picture in false color
# The reference, which others are as wide as: rough enough to show no mirror image of the lamp up to 70 degrees.
REFERENCE = ("he_torrance", {"sigma": 0.4, "tau": 7.0})
MATCHED = ("cook_torrance", "ashikhmin_shirley", "ward", "phong", "pumped_phong")


@dataclass(frozen=True)
class Surface:
    """A model as the reflector wears it; its color is white, so that only lobes differ."""

    model: str
    parameters: dict

    @property
    def caption(self):
        """The model's label and what sets its width."""
        symbols = {"sigma": "σ₀", "tau": "τ", "roughness": "m", "exponent": "n"}
        shown = {symbols[name.removesuffix("_u")]: value for name, value in self.parameters.items()
                 if not name.endswith("_v")}
        return ", ".join([brdf.MODELS[self.model].label, *(f"{name} = {value:.3g}" for name, value in shown.items())])


def half_angle() -> float:
    """The half vector's angle (radians) at which the reference has fallen to half of its peak."""
    model, parameters = REFERENCE
    return match.half_angle(brdf.MODELS[model], parameters, match.ALONG)


def surfaces() -> list:
    """The reference, and the other models at its width."""
    rows = [Surface(*REFERENCE)]
    for model in MATCHED:
        names = brdf.MODELS[model].axes or (brdf.MODELS[model].width_parameter,)
        matched = match.match(*REFERENCE, model).parameters
        rows.append(Surface(model, {name: matched[name] for name in names}))
    return rows


def captions() -> list:
    """Captions of the pictures."""
    return [surface.caption for surface in surfaces()]


def build(resolution):
    """Empty the file, build the scene with `resolution` (width, height) and return it and the reflector."""
    scene = parts.empty_scene("Reflector", resolution)
    scene.world = bpy.data.worlds.new("Darkness")
    parts.nodes_of(scene.world)
    # From the rim down to the vertex: the faces look inwards.
    profile = [(r, r * r / (4.0 * FOCUS)) for r in np.linspace(RIM, 0.0, 65)]
    bowl = parts.add(scene, "Reflector", shapes.lathe(profile, 192))
    # One reflection is compared: reflected light does not meet the bowl again.
    bowl.visible_diffuse = bowl.visible_glossy = bowl.visible_shadow = False
    data = bpy.data.lights.new("Lamp", "POINT")
    data.energy, data.shadow_soft_size = LAMP_POWER, LAMP_RADIUS
    lamp = parts.place(scene, "Lamp", data)
    lamp.location, lamp.visible_camera = LAMP, False
    camera = parts.camera(scene, np.add(CENTRE, towards_camera()), pitch=VIEW_ANGLE - 90.0, lens=50.0).data
    camera.type, camera.ortho_scale = "ORTHO", VIEW_WIDTH
    return scene, bowl


def towards_camera():
    """Unit vector (3,) to the viewer."""
    return np.array([0.0, -math.sin(math.radians(VIEW_ANGLE)), math.cos(math.radians(VIEW_ANGLE))])


def prepare(scene, samples: int):
    """Set the renderer to `samples` per pixel."""
    picture.prepare(scene, samples, exposure=0.0, indirect_clamp=0.0, bounces=1)
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.sampling_pattern = "TABULATED_SOBOL"  # the default pattern correlates the noise of neighboring pixels


def dress(bowl, surface):
    """Give the reflector the material of `surface`; the one before is deleted."""
    from ... import create_material

    old = [material for material in bowl.data.materials if material]
    parts.wear(bowl, create_material(surface.model, name=surface.caption, **surface.parameters))
    for material in old:
        bpy.data.materials.remove(material)


def render_all(folder: Path, resolution, samples: int, report=None) -> list:
    """Render each surface; write its picture beside one in false color, and reflector.json with what was measured.

    `resolution` is that of one of the two. Returns the PNGs' paths; `report(line)` gets the progress.
    """
    folder.mkdir(parents=True, exist_ok=True)
    scene, bowl = build(resolution)
    prepare(scene, samples)
    figures, measured = [], []

    def step(surface):
        dress(bowl, surface)
        png, figure = _render_twice(scene, folder, f"reflector_{surface.model}")
        figures.append(figure)
        reference = figures[0]
        difference = None if figure is reference else compare(figure, reference)
        measured.append({"model": surface.model, "parameters": surface.parameters, **(difference or {})})
        _show(png, figure.mean(axis=0), reference.mean(axis=0).max(), difference)
        return png

    paths = picture.write_all([(surface.caption, partial(step, surface)) for surface in surfaces()], report)
    text = {"reference": REFERENCE[0], "half_angle_deg": math.degrees(half_angle()), "samples": samples,
            "resolution": list(resolution), "models": measured}
    (folder / "reflector.json").write_text(json.dumps(text, indent=2) + "\n", encoding="utf-8")
    return paths


def compare(figure, reference) -> dict:
    """The difference of two luminous figures, each (2, height, width): radiance rendered with two seeds.

    `flux` is the light towards the camera, `difference` the root mean square of the difference of the two figures at
    equal flux, both in parts of the reference's; keys in `_noise` hold standard errors. The seeds are
    independent, so the product of both seeds' differences has the square of the true difference as its mean, without
    noise.
    """
    mean, other = figure.mean(axis=0), reference.mean(axis=0)
    flux, power = mean.sum() / other.sum(), np.mean(other**2)
    # The mean of two seeds errs by half of their difference, pixel by pixel.
    errors = [0.5 * math.sqrt((np.diff(f, axis=0) ** 2).sum()) / f.mean(axis=0).sum() for f in (figure, reference)]
    product = np.prod(figure / flux - reference, axis=0) / power
    difference = math.sqrt(max(product.mean(), 0.0))
    error = product.std() / math.sqrt(product.size)  # of the square
    return {"flux": flux, "flux_noise": flux * math.hypot(*errors), "difference": difference,
            "difference_noise": math.sqrt(difference**2 + error) - difference}


def save_blend(path: Path, resolution, samples: int):
    """Write the scene, with the last of the surfaces, to the .blend `path`."""
    scene, bowl = build(resolution)
    prepare(scene, samples)
    dress(bowl, surfaces()[-1])
    parts.save(scene, path)


def _render_twice(scene, folder, stem):
    """Path of the PNG, and radiance (2, height, width) for two seeds, first row at the bottom."""
    with tempfile.TemporaryDirectory(prefix="plausible-") as aside:
        scene.cycles.seed = 1
        other = _radiance(picture.write(scene, Path(aside), stem))
        scene.cycles.seed = 0
        png = picture.write(scene, folder, stem)
    return png, np.stack([_radiance(png), other])


def _radiance(png):
    """Green channel (height, width) of the EXR beside a PNG; all is white."""
    image = bpy.data.images.load(str(png.with_suffix(".exr")))
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, -1)[..., 1].astype(np.float64)


def rim() -> np.ndarray:
    """The rim as it is seen, (N, 2): across and up in the picture, in meters from its middle."""
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    up = np.array([0.0, math.cos(math.radians(VIEW_ANGLE)), math.sin(math.radians(VIEW_ANGLE))])
    points = np.stack([RIM * np.cos(turn), RIM * np.sin(turn), np.full(181, RIM * RIM / (4.0 * FOCUS))], axis=-1)
    return np.stack([points[:, 0], (points - CENTRE) @ up], axis=-1)


def _show(png, radiance, brightest, measured):
    """Put the picture `png` beside its radiance over `brightest` in false color, with what was measured, in its place.

    `measured` is the result of `compare`, or None for the reference.
    """
    from matplotlib import image
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    height, width = radiance.shape
    figure = Figure(figsize=(2 * width / 100.0, height / 100.0), dpi=100, facecolor="black")
    FigureCanvasAgg(figure)
    plain, false = (figure.add_axes((0.5 * i, 0.0, 0.5, 1.0)) for i in range(2))
    half = 0.5 * VIEW_WIDTH, 0.5 * VIEW_WIDTH * height / width
    extent = (-half[0], half[0], -half[1], half[1])
    plain.imshow(image.imread(png), extent=extent)
    shown = false.imshow(np.maximum(radiance / brightest, 1e-9), extent=extent, origin="lower", cmap="inferno",
                         norm=LogNorm(10.0**-DECADES, 1.0))
    for at in (plain, false):
        at.plot(*rim().T, color="#8a8a92", linewidth=0.8)
        at.set(xlim=extent[:2], ylim=extent[2:])
        at.axis("off")
    small = max(min(width / 320.0, 1.2), 0.2)
    bar = figure.colorbar(shown, cax=figure.add_axes((0.952, 0.07, 0.008, 0.86)))
    ticks = [10.0**-d for d in range(int(DECADES) + 1)]
    bar.set_ticks(ticks, labels=[f"{tick:g}".removeprefix("0") for tick in ticks])
    bar.ax.tick_params(colors="white", labelsize=7.5 * small, length=2, pad=1.5)
    bar.outline.set_visible(False)
    note = "the reference" if measured is None else (
        f"light {measured['flux']:.4f} ± {measured['flux_noise']:.4f}\n"
        f"shape differs by {100.0 * measured['difference']:.1f} ± {100.0 * measured['difference_noise']:.1f} %")
    figure.text(0.51, 0.03, note, color="white", size=8.5 * small, va="bottom")
    figure.savefig(png, dpi=100, facecolor="black")
