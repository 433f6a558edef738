"""Redraws of the areas that show the extension's panels."""
import bpy

# Types of areas with panels of the extension.
_AREA_TYPES = ("PROPERTIES", "NODE_EDITOR", "PREFERENCES")


def redraw():
    """Request a redraw of the panels."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in _AREA_TYPES:
                area.tag_redraw()
