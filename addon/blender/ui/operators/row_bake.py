"""The operators that bake a material's lobe rows and cancel the bake."""
import bpy

from ...material import baked_state, row_jobs
from .common import OnMaterial, material_of, plausible_node, reporting


class PLAUSIBLE_OT_bake_weights(OnMaterial, bpy.types.Operator):
    """Bake the weights that the material renders by, for the values that its sockets hold and over ranges of those that
    links, drivers or keyframes change. It takes some seconds, and Blender stays usable"""

    bl_idname = "plausible.bake_weights"
    bl_label = "Bake Weights"

    @reporting
    def execute(self, context):
        material = material_of(context)
        if bpy.app.background:
            baked_state.bake(plausible_node(material)[0])
        else:
            row_jobs.soon(material)
        return {"FINISHED"}


class PLAUSIBLE_OT_cancel_weights(OnMaterial, bpy.types.Operator):
    """End the bake of these weights; the material keeps those that it has"""

    bl_idname = "plausible.cancel_weights"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    def execute(self, context):
        row_jobs.cancel(material_of(context))
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_bake_weights, PLAUSIBLE_OT_cancel_weights,)
