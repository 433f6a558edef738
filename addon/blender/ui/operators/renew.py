"""The operator that replaces edited nodes which no longer work."""
import bpy

from ...material import repair
from .common import material_of, renders_here, reporting


class PLAUSIBLE_OT_renew(bpy.types.Operator):
    """Put a fresh node in the place of one that was edited and no longer works; values, links and keyframes stay"""

    bl_idname = "plausible.renew"
    bl_label = "Renew Node"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        material = material_of(context)
        return (material is not None and material.is_editable and any(map(repair.can_renew, repair.broken(material)))
                and renders_here(cls))

    @reporting
    def execute(self, context):
        for node in repair.broken(material_of(context)):
            if repair.can_renew(node):
                repair.renew(node)
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_renew,)
