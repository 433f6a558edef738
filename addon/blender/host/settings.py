"""What the user has set in the preferences; the defaults where the package is imported by itself."""
from pathlib import Path

import bpy

from ...models.parameters import ESTIMATOR
from ...resources import ROOT

ROOT_PACKAGE = __package__.rsplit(".", 3)[0]  # "bl_ext.<repository>.plausible_brdf" inside Blender, else "addon"
CACHE_LIMIT = 200  # MB
MANUAL = ROOT / "docs" / "manual.html"
BY_USER = ("samples", "light_spread")  # parameters of new materials
DEFAULTS = {parameter.id: parameter for parameter in ESTIMATOR if parameter.id in BY_USER}


def preferences():
    """The extension's preferences, or None where it is not enabled as one."""
    entry = bpy.context.preferences.addons.get(ROOT_PACKAGE)
    return entry and entry.preferences


def granted_folder(name: str, create=False):
    """The folder `name` that Blender grants this extension for files of its own, as a Path.

    None outside of Blender's extensions. Raises OSError where it is to be created and cannot be.
    """
    if not ROOT_PACKAGE.startswith("bl_ext."):
        return None
    folder = Path(bpy.utils.extension_path_user(ROOT_PACKAGE, path=name))
    if create:
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def lut_folder() -> str:
    """The folder of albedo tables that the user chose, as an absolute path; "" where none."""
    chosen = preferences()
    return bpy.path.abspath(chosen.lut_folder) if chosen and chosen.lut_folder.strip() else ""


def cache_limit() -> int:
    """Bytes that the cache may hold."""
    chosen = preferences()
    # A file of preferences that was damaged may hold what its property does not allow.
    return 1_000_000 * max(chosen.cache_limit if chosen else CACHE_LIMIT, 0)


def for_new(model) -> dict:
    """Values for a new material of `model`, by parameter id, as far as it has these parameters."""
    chosen, known = preferences(), {parameter.id for parameter in model.parameters}
    return {name: DEFAULTS[name].clamp(getattr(chosen, name)) for name in BY_USER if chosen and name in known}
