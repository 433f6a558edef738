"""The extension's asset library, for drag and drop: presets as materials, models as nodes."""
import bpy

from ...assets import LIBRARY

# Name of the library in the preferences.
NAME = "Plausible BRDF"


def start():
    """Add the library to the preferences, in place of one that an earlier run of Blender left there."""
    stop()
    if LIBRARY.is_file():
        library = bpy.context.preferences.filepaths.asset_libraries.new(name=NAME, directory=str(LIBRARY.parent))
        # Assets are appended, so that files do not depend on the extension. Newer versions of Blender, which also offer
        # "PACK", have a single method of appending.
        methods = type(library).bl_rna.properties["import_method"].enum_items
        library.import_method = "APPEND" if "PACK" in methods else "APPEND_REUSE"
        library.use_relative_path = False


def stop():
    """Remove the library from the preferences."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    for library in [entry for entry in libraries if entry.name == NAME]:
        libraries.remove(library)
