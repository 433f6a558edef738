"""The extension's preferences: the folder of albedo tables, initial values of new materials, and the cache."""
import bpy

from ...forms.albedo import tables
from .. import backend as backends
from ..host import row_cache, settings, table_folder
from .operators import table_bake
from .panels import draw_bake, draw_tables, draw_text


def _tables_moved(self, context):
    table_folder.choose_folder()


def _limit_changed(self, context):
    row_cache.trim()


def _declared(name):
    """Keywords of the Blender property for a parameter's initial value in new materials."""
    parameter = settings.DEFAULTS[name]
    number = int if parameter.kind == "int" else float
    return {"name": parameter.label, "description": f"{parameter.help}. New materials begin with it",
            "min": number(parameter.minimum), "max": number(parameter.maximum), "default": number(parameter.default)}


class PlausiblePreferences(bpy.types.AddonPreferences):
    """Where the albedo tables are, what new materials begin with, and the cache"""

    bl_idname = settings.ROOT_PACKAGE

    lut_folder: bpy.props.StringProperty(
        name="LUT Folder", description="Folder that albedo tables are read from and baked to. Empty: a folder of the "
        "extension's own once there are tables baked here, else the shipped ones", subtype="DIR_PATH",
        update=_tables_moved)
    samples: bpy.props.IntProperty(**_declared("samples"))
    light_spread: bpy.props.FloatProperty(**_declared("light_spread"))
    cache_limit: bpy.props.IntProperty(
        name="Cache Limit (MB)", description="What was baked for materials is kept, and need not be baked again; what "
        "was not used for longest is dropped beyond this. 0 keeps nothing", min=0, max=100_000,
        default=settings.CACHE_LIMIT, update=_limit_changed)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        # Why this Blender cannot render the materials.
        for notice in backends.DEFAULT.why_not():
            draw_text(layout, context, notice.text, "ERROR")
        # Albedo tables.
        layout.prop(self, "lut_folder")
        draw_all_tables(layout, context)
        # New materials.
        column = layout.column(heading="New Materials")
        column.prop(self, "samples")
        column.prop(self, "light_spread")
        # The cache, and the manual.
        layout.prop(self, "cache_limit")
        row = layout.row()
        row.label(text=f"Cache: {row_cache.size() / 1e6:.1f} MB")
        row.operator("plausible.clear_cache", icon="TRASH")
        layout.operator("wm.url_open", text="Documentation", icon="HELP").url = settings.MANUAL.as_uri()


def draw_all_tables(layout, context):
    """Draw the problem of the albedo tables, their folder, and a line for each table."""
    problem = table_folder.problem(tables.TABLES)
    if problem:
        draw_text(layout, context, problem, "ERROR")
    draw_text(layout, context, f"Albedo tables: {tables.folder()}", "FILE_FOLDER")
    draw_tables(layout, context, tables.TABLES)
    draw_bake(layout)


class PLAUSIBLE_OT_clear_cache(bpy.types.Operator):
    """Delete what was baked for materials and is kept on disk; materials keep what they have"""

    bl_idname = "plausible.clear_cache"
    bl_label = "Clear"

    def execute(self, context):
        try:
            row_cache.clear()
        except OSError as error:
            self.report({"ERROR"}, f"The cache cannot be deleted: {table_bake.in_words(error)}")
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_clear_cache, PlausiblePreferences)
