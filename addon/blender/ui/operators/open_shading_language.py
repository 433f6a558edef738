"""The operator that switches Open Shading Language on."""
import bpy

from ... import backend as backends
from .common import renders_here


class PLAUSIBLE_OT_use_osl(bpy.types.Operator):
    """Switch on Open Shading Language in this scene; without it Cycles does not run the materials' shaders"""

    bl_idname = "plausible.use_osl"
    bl_label = "Switch on OSL"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.scene is not None and renders_here(cls)

    def execute(self, context):
        backends.DEFAULT.prepare(context.scene)
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_use_osl,)
