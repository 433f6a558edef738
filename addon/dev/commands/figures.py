"""`plausible figures`."""
import importlib
from pathlib import Path

from ...cli import CommandError, require

DESCRIPTION = ("Plot albedos, lobes and half vectors of the reference models, as PNG and SVG. pumping: the pumping "
               "paper's figures 1 and 3 to 7. disk: the disk paper's 7, 8 and 13. compare: lobes of all models in "
               "the plane of incidence, as wide as one another. rtr: spheres with original and with "
               "normalized Phong highlights, rendered, after figure 7.38 of Real-Time Rendering.")
SETS = {name: f"addon.dev.figures.{name}" for name in ("pumping", "disk", "compare", "rtr")}
RENDERED = ("rtr",)


def add_arguments(parser):
    parser.add_argument("set", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}; all when none is given")
    parser.add_argument("--output", type=Path, default=Path("out/figures"), metavar="DIR",
                        help="folder of the figures (default %(default)s)")


def run(arguments):
    for name in arguments.set:
        if name not in SETS:
            raise CommandError(f"no set {name!r}; there are {', '.join(SETS)}")
    require("matplotlib", "demo")
    if any(name in RENDERED for name in arguments.set or SETS):
        require("bpy", "render")
    arguments.output.mkdir(parents=True, exist_ok=True)
    for name in arguments.set or SETS:
        for path in write_set(name, arguments.output):
            print(path)


def write_set(name, folder):
    """Draws the set `name` into `folder`; yields each path written."""
    figures = importlib.import_module(SETS[name])
    for figure in figures.SET:
        yield from write(figures.draw(figure), folder, f"{name}_{figure}")


def write(figure, folder, name):
    """Writes a figure into `folder` as PNG and SVG; yields each path written."""
    for ending, metadata in (("png", {"Software": None}), ("svg", {"Date": None})):
        path = folder / f"{name}.{ending}"
        figure.savefig(path, metadata=metadata)
        yield path
