"""`plausible demo`."""
import argparse
import importlib
import sys
from pathlib import Path

from ..cli import CommandError

DESCRIPTION = ("Build and render the pumping paper's scene: a golden tank among metal pyramids, under sky light and "
               "point lights, with the reciprocal Phong model, pumped up once, and pumped up under control.")
TITLE = "Albedo pumping-up in stock Cycles"
NOTE = ("A golden tank and pyramids of aluminium, silver, copper and gold on nickel, under sky light and two point "
        "lights, after figure 8 of\nNeumann, Neumann and Szirmay-Kalos. Measured n and k, one exposure, no denoising.")
BLEND = Path(__file__).resolve().parents[2] / "demo_blends" / "pumped_metals.blend"


def add_arguments(parser):
    parser.add_argument("--output", type=Path, default=Path("out/demo"), metavar="DIR",
                        help="folder of the pictures (default %(default)s)")
    parser.add_argument("--samples", type=_count, default=64, metavar="N",
                        help="samples per pixel, at most (default %(default)s)")
    parser.add_argument("--resolution", type=_resolution, default=(480, 360), metavar="WxH",
                        help="size of each panel (default 480x360)")
    parser.add_argument("--save-blend", type=Path, nargs="?", const=BLEND, metavar="FILE",
                        help=f"only write the scene, dressed as the last panel (default demo_blends/{BLEND.name})")


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


def _require(package, extra):
    try:
        importlib.import_module(package)
    except ImportError as error:
        raise CommandError(f"needs {package} ({error}); pip install plausible-brdf[{extra}]") from None


def run(arguments):
    _require("bpy", "render")
    if not arguments.save_blend:
        _require("matplotlib", "demo")
    from ..blender.osl import OslError

    try:
        (_save_blend if arguments.save_blend else _render)(arguments)
    except OslError as error:
        raise CommandError(str(error)) from None


def _render(arguments):
    from ..demo import panels, sheet

    paths = panels.render_all(arguments.output, arguments.resolution, arguments.samples,
                              report=lambda line: print(line, file=sys.stderr, flush=True))
    output = arguments.output / "demo.png"
    sheet.compose(paths, [panel.caption for panel in panels.panels()], len(panels.EXPONENTS), TITLE, NOTE, output)
    print("\n".join(str(path) for path in [*(path.with_suffix(".exr") for path in paths), output]))


def _save_blend(arguments):
    from ..demo import panels, scene

    stage = scene.build(arguments.resolution)
    panels.prepare(stage, arguments.samples)
    panels.dress(stage, panels.panels()[-1])
    with panels.quiet():
        scene.save(stage, arguments.save_blend)
    print(arguments.save_blend)
