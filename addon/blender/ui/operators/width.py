"""The operator that switches a lobe's width between exponent and roughness."""
import bpy

from .... import models
from ...material import materials, sockets
from .common import OnMaterial, material_of, plausible_node, reporting


class PLAUSIBLE_OT_switch_width(OnMaterial, bpy.types.Operator):
    """Give the lobe's width by roughness instead of by exponent, or the other way; the lobe stays as wide as it is"""

    bl_idname = "plausible.switch_width"
    bl_label = "Exponent ↔ Roughness"

    @reporting
    def execute(self, context):
        node, model = plausible_node(material_of(context))
        now = sockets.values(node)
        if "use_roughness" not in now:
            raise ValueError(f"{model.label} has no roughness to give its width by")
        new = {"use_roughness": not now["use_roughness"]}
        if now["use_roughness"]:
            new["exponent"] = models.exponent_of_roughness(now["roughness"])
        else:
            new["roughness"] = models.roughness_of_exponent(now["exponent"])
        materials.set_values(node, {model.parameter(name): value for name, value in new.items()})
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_switch_width,)
