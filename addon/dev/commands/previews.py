"""`plausible previews`."""
import time
from pathlib import Path

from ... import assets
from ...cli import CommandError, require
from ...library.presets import PRESETS
from ...models import MODELS

DESCRIPTION = ("Render the small pictures of models and presets that the panel's menus show: a ball each. Baked models "
               "take seconds to bake first.")
LARGEST = 12 * 1024  # bytes of a picture; all pictures ship in the extension's zip


def add_arguments(parser):
    parser.add_argument("name", nargs="*", metavar="NAME",
                        help="model or preset, see `plausible list`; all of both when none is given")
    parser.add_argument("--missing", action="store_true", help="only those that have no picture yet")
    parser.add_argument("--output", type=Path, default=assets.PREVIEWS, metavar="DIR",
                        help="folder of the pictures (default %(default)s)")


def run(arguments):
    for name in arguments.name:
        if name not in MODELS and name not in PRESETS:
            raise CommandError(f"no model or preset {name!r}; there are {', '.join([*MODELS, *PRESETS])}")
    require("bpy", "render")
    require("PIL", "demo")
    from ..demo import previews

    for path, model_id, parameters, headlight in _jobs(arguments, previews):
        start = time.monotonic()
        previews.render(path, model_id, parameters, headlight)
        size = path.stat().st_size
        if size > LARGEST:
            raise CommandError(f"{path}: {size} bytes, more than {LARGEST}")
        print(f"{path}  {size / 1024:.1f} KB, {time.monotonic() - start:.0f} s", flush=True)


def _jobs(arguments, previews):
    """(path, model, parameters, whether a light stands at the camera) of each picture to render."""
    names = arguments.name or [*MODELS, *PRESETS]
    for name in names:
        path = assets.preview(name, arguments.output)
        if arguments.missing and path.exists():
            continue
        if name in MODELS:
            yield path, name, previews.look(name), False
        else:
            parameters = PRESETS[name].parameters
            yield path, PRESETS[name].model, parameters, parameters.get("retro", 0.0) > 0.5
