"""The user's preferences, or defaults where the package is imported outside Blender's extensions."""
from pathlib import Path

import bpy

from ...models.parameters import ESTIMATOR
from ...resources import ROOT

# "bl_ext.<repository>.plausible_brdf" as an extension, else "addon".
ROOT_PACKAGE = __package__.rsplit(".", 3)[0]
# Default of the preference, in MB.
CACHE_LIMIT = 200
MANUAL = ROOT / "docs" / "manual.html"
# Parameters whose value in new materials is a preference.
BY_USER = ("samples", "light_spread")
DEFAULTS = {parameter.id: parameter for parameter in ESTIMATOR if parameter.id in BY_USER}


def preferences():
    """The extension's preferences, or None where it is not enabled as an extension."""
    entry = bpy.context.preferences.addons.get(ROOT_PACKAGE)
    return entry and entry.preferences


def granted_folder(name: str, create=False):
    """The folder `name` in the directory that Blender reserves for this extension's files, as a Path.

    None where the package is not an extension. Raises OSError if `create` is set and the folder cannot be created.
    """
    if not ROOT_PACKAGE.startswith("bl_ext."):
        return None
    folder = Path(bpy.utils.extension_path_user(ROOT_PACKAGE, path=name))
    if create:
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def lut_folder() -> str:
    """The user's folder of albedo tables, as an absolute path; "" where the preference is empty."""
    user = preferences()
    return bpy.path.abspath(user.lut_folder) if user and user.lut_folder.strip() else ""


def cache_limit() -> int:
    """The size limit of the cache in bytes, 0 or more."""
    user = preferences()
    # A damaged preferences file may contain a value outside the property's range.
    return 1_000_000 * max(user.cache_limit if user else CACHE_LIMIT, 0)


def for_new(model) -> dict:
    """The preferences' values for a new material, by parameter id, of those parameters that `model` has."""
    user, ids = preferences(), {parameter.id for parameter in model.parameters}
    return {name: DEFAULTS[name].clamp(getattr(user, name)) for name in BY_USER if user and name in ids}
