"""Pictures of models and presets for menus, as icons. There are none in background mode, where nobody sees them."""
import bpy
import bpy.utils.previews

from .. import assets
from ..brdf import MODELS
from ..brdf.presets import PRESETS

_pictures = None


def start(in_background: bool = False):
    """Have the pictures ready that there are. Blender reads each file when it is first shown."""
    global _pictures
    if bpy.app.background and not in_background:
        return
    _pictures = bpy.utils.previews.new()
    for path in (*map(assets.model_preview, MODELS), *map(assets.preset_preview, PRESETS)):
        if path.is_file():
            _pictures.load(str(path), str(path), "IMAGE")


def stop():
    """Take back what `start` did."""
    global _pictures
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
        _pictures = None


def of_model(model_id: str) -> int:
    """The icon of a model; 0, which is no icon, where there is no picture of it."""
    return _icon(assets.model_preview(model_id))


def of_preset(name: str) -> int:
    """The icon of a preset, or 0."""
    return _icon(assets.preset_preview(name))


def _icon(path):
    return _pictures[str(path)].icon_id if _pictures is not None and str(path) in _pictures else 0
