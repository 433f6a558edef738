"""`plausible bench`."""
import argparse
import importlib
import json
import sys
from pathlib import Path

from ...cli import CommandError, require
from ...commands import furnace
from ...forms.files import replace_text, replacing
from ...measure import scene
from .. import bench
from ..bench import efficiency

PARTS = "\n".join(f"  {name:10} {what}" for name, what in bench.PARTS.items())
DESCRIPTION = ("Measure the cost of rendering, baking and waiting, side by side with Cycles' own materials and other "
               f"methods: ratios in one run, medians, processor time.\n\n{PARTS}")
WITHOUT_BLENDER = ("bake", "luts", "interface")
BY_MODEL = ("render", "startup", "interface")


def add_arguments(parser):
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(bench.PARTS)}; all when none is given")
    parser.add_argument("--models", nargs="+", metavar="MODEL", help="models, for render, startup and interface "
                        "(default: all)")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="for render: as in `plausible furnace`")
    parser.add_argument("--scenes", nargs="+", choices=efficiency.SCENES, default=list(efficiency.SCENES),
                        help="for render: scenes to render in (default: all)")
    parser.add_argument("--samples", type=int, nargs="+", default=[4], metavar="N",
                        help="for render: samples per hit of our models (default: %(default)s)")
    parser.add_argument("--hdri", metavar="FILE", help="for render: HDRI to light with (default: one of Blender's)")
    parser.add_argument("--resolution", type=int, default=64, metavar="N",
                        help="for render: pixels across (default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="short renders and few repeats: rough figures")
    parser.add_argument("--output", type=Path, metavar="DIR",
                        help="write a plot of each part, bench_PART.png, and the figures, bench_PART.json, there")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    for name in arguments.parts:
        if name not in bench.PARTS:
            raise CommandError(f"no part {name!r}; there are {', '.join(bench.PARTS)}")
    parts = arguments.parts or list(bench.PARTS)
    if arguments.hdri and not Path(arguments.hdri).is_file():
        raise CommandError(f"no file {arguments.hdri}")
    if any(name not in WITHOUT_BLENDER for name in parts):
        scene.require_blender()
    if "bake" in parts:
        require("scipy", "bake")
    if arguments.output:
        require("matplotlib", "demo")
        arguments.output.mkdir(parents=True, exist_ok=True)
    reports = {}
    for name in parts:
        part = importlib.import_module(f"..bench.{name}", __package__)
        effort = bench.QUICK if arguments.quick else bench.USUAL
        progress = furnace.progress(f"bench, {name}", what="step")
        reports[name] = part.measure(effort, progress, **_options(name, arguments))
        if not arguments.json:
            print("\n".join([f"{name}: {bench.PARTS[name]}", *part.lines(reports[name]), ""]), flush=True)
        if arguments.output:
            _write(arguments.output, name, part, reports[name])
    if arguments.json:
        print(json.dumps({"blender": _blender(), **reports}, indent=2))


def _options(name, arguments):
    """Keyword arguments of a part's `measure`."""
    options = {"models": arguments.models} if name in BY_MODEL and arguments.models else {}
    if name == "render":
        options.update(scenes=arguments.scenes, samples=arguments.samples, assignments=arguments.assignments,
                       hdri=arguments.hdri, resolution=arguments.resolution)
    return options


def _blender():
    """Blender's version, None where bpy is not loaded."""
    bpy = sys.modules.get("bpy")
    return bpy.app.version_string if bpy else None


def _write(folder, name, part, report):
    """Writes a part's report and plot into a folder."""
    replace_text(folder / f"bench_{name}.json", json.dumps({"blender": _blender(), name: report}, indent=2) + "\n")
    figure = part.draw(report)
    with replacing(folder / f"bench_{name}.png") as beside:
        figure.savefig(beside, format="png", metadata={"Software": None})
