"""The asset library that comes with the extension: presets as materials, models as nodes, to drag and drop."""
import bpy

from ...assets import LIBRARY

NAME = "Plausible BRDF"


def start():
    """Add the library to the preferences, in place of one that an earlier start left there."""
    stop()
    if LIBRARY.is_file():
        library = bpy.context.preferences.filepaths.asset_libraries.new(name=NAME, directory=str(LIBRARY.parent))
        # What is dragged in becomes the file's own: the extension may go. Newer versions know one way to append.
        known = type(library).bl_rna.properties["import_method"].enum_items
        library.import_method = "APPEND" if "PACK" in known else "APPEND_REUSE"
        library.use_relative_path = False


def stop():
    """Take the library out of the preferences."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    for library in [each for each in libraries if each.name == NAME]:
        libraries.remove(library)
