"""`plausible assets`."""
import json
import sys
from pathlib import Path

from ... import assets as shipped
from ...cli import CommandError
from ...measure.scene import quiet, require_blender
from ..packaging import assets

DESCRIPTION = ("Make the asset library that ships with the extension: presets as materials, models as nodes, with "
               "catalogs and thumbnails (`plausible previews` renders those). Blender reads what its own and older "
               "versions wrote, so the library that ships is made in Blender 4.2: ./run assets does that.")


def add_arguments(parser):
    parser.add_argument("--output", type=Path, default=shipped.LIBRARY.parent, metavar="DIR",
                        help="where the library goes (default: where the extension has it)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    bpy = require_blender()
    missing = assets.missing_previews()
    if missing:
        raise CommandError(f"no thumbnail of {', '.join(missing)}: run `plausible previews` first")
    with quiet():
        path = assets.build(arguments.output, _progress)
    size = path.stat().st_size
    if arguments.json:
        print(json.dumps({"path": str(path), "bytes": size, "blender": bpy.app.version_string}))
    else:
        print(f"{path}: {size / 1e6:.1f} MB, by Blender {bpy.app.version_string}")


def _progress(done, total):
    """Updates a line of progress on a terminal."""
    if sys.stderr.isatty():
        print(f"\rassets: {done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)
