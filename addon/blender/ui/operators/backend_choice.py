"""The operator that chooses the backend of a material."""
import bpy

from ... import backend as backends
from ...material import groups, materials
from .common import OnMaterial, material_of, plausible_node, reporting


class PLAUSIBLE_OT_switch_native(OnMaterial, bpy.types.Operator):
    """Render what Cycles ships in place of the model, on any device and without Open Shading Language, or go back"""

    bl_idname = "plausible.switch_native"
    bl_label = "Native Approximation"

    @reporting
    def execute(self, context):
        node = plausible_node(material_of(context))[0]
        is_native = groups.backend_of(node) == backends.FALLBACK
        materials.switch_backend(node, backends.DEFAULT.as_kept(node.node_tree) if is_native else backends.FALLBACK)
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_switch_native,)
