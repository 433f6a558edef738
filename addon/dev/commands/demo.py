"""`plausible demo`."""
import argparse
import importlib
import sys
from dataclasses import dataclass
from pathlib import Path

from ...cli import CommandError, require
from ...resources import ROOT

DESCRIPTION = ("Build and render a scene. metals: a golden tank among metal pyramids, with the reciprocal Phong model, "
               "pumped up once, and pumped up under control. spheres: anisotropic spheres under an HDRI. road: a road "
               "at night with diffuse reflectors and with retroreflectors. furnace: white spheres in a constant "
               "environment, which vanish where their model conserves energy. reflector: a lamp near the focus of a "
               "paraboloid, by six models of one width, with what tells them apart in reflector.json. presets: a "
               "sphere of each preset. all: the six.")
BLENDS = ROOT / "demo_blends"
SAVE_THERE = object()  # --save-blend without a file


@dataclass(frozen=True)
class Scene:
    """A demo: its module in `addon.dev.demo`, the sheet of its pictures, and its .blend.

    `resolution` (width, height) in pixels and `samples` per pixel are the defaults.
    """

    module: str
    sheet: str
    blend: str
    title: str
    note: str
    columns: int
    resolution: tuple
    samples: int


SCENES = {
    "metals": Scene(
        "panels", "demo.png", "pumped_metals.blend", "Albedo pumping-up in stock Cycles",
        "A golden tank and pyramids of aluminium, silver, copper and gold on nickel, under sky light and two point "
        "lights, after figure 8 of\nNeumann, Neumann and Szirmay-Kalos. Measured n and k, one exposure, no denoising.",
        2, (480, 360), 64),
    "spheres": Scene(
        "spheres", "disk_spheres.png", "disk_spheres.blend", "Anisotropic spheres in stock Cycles",
        "Under an HDRI, after figure 9 of Edwards et al. Front: Radius V falls. Middle: Rotation.\n"
        "Back: where the tangent runs, around the object's tilted z axis or linked. No denoising.",
        1, (640, 480), 48),
    "road": Scene(
        "road", "night_road.png", "night_road.blend", "A road at night in stock Cycles",
        "Signs, markings and posts in a car's headlights, after figure 10 of Edwards et al. "
        "The same colors and lamps, one exposure, no denoising.",
        2, (640, 368), 64),
    "furnace": Scene(
        "furnace", "invisible_spheres.png", "invisible_spheres.blend", "Invisible spheres in stock Cycles",
        "In a constant environment, after figure 2 of Edwards et al. Lobes of about one width (Blinn exponent 20).\n"
        "Where a model neither loses nor makes light, its sphere cannot be seen. No denoising.",
        1, (960, 480), 96),
    "reflector": Scene(
        "reflector", "light_points.png", "light_points.blend", "Light points on a reflector in stock Cycles",
        "A lamp inside the focus of a paraboloid seen 30° off its axis, after Sawicki: models with one half-value "
        "angle at normal incidence.\nRight: radiance over the brightest of He-Torrance's. Light, and shape at equal "
        "light, are compared with He-Torrance's: ± is the standard error by two seeds.",
        2, (320, 300), 64),
    "presets": Scene(
        "presets", "presets.png", "presets.blend", "Presets in stock Cycles",
        "Spheres under an HDRI, and a lamp beside the camera that shows what comes back to it. No denoising.",
        9, (112, 112), 64),
}


def add_arguments(parser):
    parser.add_argument("scene", nargs="?", choices=(*SCENES, "all"), default="metals",
                        help="which scene (default %(default)s)")
    parser.add_argument("--output", type=Path, default=Path("out/demo"), metavar="DIR",
                        help="folder of the pictures (default %(default)s)")
    parser.add_argument("--samples", type=_count, metavar="N",
                        help="samples per pixel, at most (default 64; spheres 48, furnace 96)")
    parser.add_argument("--resolution", type=_resolution, metavar="WxH",
                        help="size of each panel (default 480x360; spheres 640x480, road 640x368, furnace 960x480, "
                             "reflector 320x300, presets 112x112)")
    parser.add_argument("--save-blend", type=Path, nargs="?", const=SAVE_THERE, metavar="FILE",
                        help="only write the scene, with the last panel's materials (default FILE: the scene's own in "
                             "demo_blends)")


def _count(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{value} is less than 1")
    return value


def _resolution(text):
    width, _, height = text.lower().partition("x")
    if not (width.isdigit() and height.isdigit() and 4 <= int(width) <= 8192 and 4 <= int(height) <= 8192):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form 480x360, each side 4 to 8192")
    return int(width), int(height)


def run(arguments):
    names = list(SCENES) if arguments.scene == "all" else [arguments.scene]
    if len(names) > 1 and arguments.save_blend not in (None, SAVE_THERE):
        raise CommandError("--save-blend: one file cannot hold all scenes; name a scene, or no file")
    require("bpy", "render")
    if not arguments.save_blend:
        require("matplotlib", "demo")
    from ...blender.backend.osl import OslError

    try:
        for name in names:
            (_save_blend if arguments.save_blend else _render)(SCENES[name], arguments)
    except OslError as error:
        raise CommandError(str(error)) from None


def _settings(scene, arguments):
    """The scene's module, and the resolution and samples of the arguments or, by default, of the scene."""
    module = importlib.import_module(f"..demo.{scene.module}", __package__)
    return module, arguments.resolution or scene.resolution, arguments.samples or scene.samples


def _render(scene, arguments):
    from ..demo import sheet

    module, resolution, samples = _settings(scene, arguments)
    paths = module.render_all(arguments.output, resolution, samples,
                              report=lambda line: print(line, file=sys.stderr, flush=True))
    output = arguments.output / scene.sheet
    sheet.compose(paths, module.captions(), scene.columns, scene.title, scene.note, output)
    pictures = [path.with_suffix(".exr") for path in paths]
    print("\n".join(str(path) for path in [*(path for path in pictures if path.exists()), output]))


def _save_blend(scene, arguments):
    from ..demo import picture

    module, resolution, samples = _settings(scene, arguments)
    path = BLENDS / scene.blend if arguments.save_blend is SAVE_THERE else arguments.save_blend
    with picture.quiet():
        module.save_blend(path, resolution, samples)
    print(path)
