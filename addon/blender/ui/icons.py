"""Pictures of models and presets for menus, as icons. There are none in background mode, where nobody sees them."""
import bpy
import bpy.utils.previews

from ... import assets
from ...library.presets import PRESETS
from ...models import MODELS

_pictures = None


def start(in_background: bool = False):
    """Have the pictures ready that there are. Blender reads each file when it is first shown."""
    global _pictures
    if bpy.app.background and not in_background:
        return
    _pictures = bpy.utils.previews.new()
    for key in (*MODELS, *PRESETS):
        path = assets.preview(key)
        if path.is_file():
            _pictures.load(key, str(path), "IMAGE")


def stop():
    """Take back what `start` did."""
    global _pictures
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
        _pictures = None


def icon_of(key: str) -> int:
    """The icon of a model or preset, by id; 0, which is no icon, where there is no picture of it."""
    return _pictures[key].icon_id if _pictures is not None and key in _pictures else 0
