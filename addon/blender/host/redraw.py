"""The areas of the window that show our panels."""
import bpy

_SHOWING = ("PROPERTIES", "NODE_EDITOR", "PREFERENCES")


def redraw():
    """Have the panels drawn again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in _SHOWING:
                area.tag_redraw()
