"""The asset library that comes with the extension: presets as materials, models as nodes, to drag and drop."""
from pathlib import Path

import bpy

NAME = "Plausible BRDF"
FOLDER = Path(__file__).resolve().parents[1] / "assets"
FILE = FOLDER / "plausible.blend"


def start():
    """Add the library to the preferences, in place of one that an earlier start left there."""
    stop()
    if FILE.is_file():
        library = bpy.context.preferences.filepaths.asset_libraries.new(name=NAME, directory=str(FOLDER))
        # What is dragged in becomes the file's own: the extension may go.
        library.import_method = "APPEND_REUSE"
        library.use_relative_path = False


def stop():
    """Take the library out of the preferences."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    for library in [each for each in libraries if each.name == NAME]:
        libraries.remove(library)
