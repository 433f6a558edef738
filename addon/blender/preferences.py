"""The extension's preferences: where the albedo tables are, and baking them."""
import bpy

from ..brdf import tables
from . import luts, osl
from .panels import draw_bake, draw_text


class PlausiblePreferences(bpy.types.AddonPreferences):
    """Where the albedo tables are, whether they are usable, and a button to bake them"""

    bl_idname = luts.ROOT_PACKAGE

    def draw(self, context):
        layout = self.layout
        reason = osl.unavailable()
        if reason:
            draw_text(layout, context, reason, "ERROR")
        problem = luts.problem(tables.TABLES)
        if problem:
            draw_text(layout, context, problem, "ERROR")
        draw_text(layout, context, f"Albedo tables: {tables.folder()}", "FILE_FOLDER")
        draw_bake(layout)


CLASSES = (PlausiblePreferences,)
