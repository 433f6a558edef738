"""Icons of models and presets for menus. None are loaded in background mode."""
import bpy
import bpy.utils.previews

from ... import assets
from ...library.presets import PRESETS
from ...models import MODELS

_pictures = None  # Blender's collection of previews, by id of a model or preset


def start(in_background: bool = False):
    """Register the existing picture files. Blender reads a file when it shows the icon first.

    `in_background` registers them in background mode, too.
    """
    global _pictures
    if bpy.app.background and not in_background:
        return
    _pictures = bpy.utils.previews.new()
    for key in (*MODELS, *PRESETS):
        path = assets.preview(key)
        if path.is_file():
            _pictures.load(key, str(path), "IMAGE")


def stop():
    """Remove the pictures."""
    global _pictures
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
        _pictures = None


def icon_of(key: str) -> int:
    """The icon number of a model or preset, by id; 0, Blender's number for no icon, where it has no picture."""
    return _pictures[key].icon_id if _pictures is not None and key in _pictures else 0
