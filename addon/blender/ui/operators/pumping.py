"""The operator that compares a material before and after pumping."""
import bpy

from ...material import materials, sockets
from .common import OnMaterial, material_of, plausible_node, reporting

# Custom property of a node: its value of Pumps while it shows the model before pumping.
_PUMPS_KEY = "plausible_pumps"


def shows_before(node) -> bool:
    """Whether a node shows its model before pumping, for comparison."""
    return isinstance(node.get(_PUMPS_KEY), int | float)


class PLAUSIBLE_OT_compare_pumping(OnMaterial, bpy.types.Operator):
    """Show the material before pumping, and, pressed again, after it"""

    bl_idname = "plausible.compare_pumping"
    bl_label = "Compare"

    @reporting
    def execute(self, context):
        node, model = plausible_node(material_of(context))
        now = sockets.values(node)
        if "pumps" not in now:
            raise ValueError(f"{model.label} is not pumped: there is nothing to compare")
        # Restore the stored number of pumps, or store it and show 0 pumps.
        if shows_before(node):
            pumps = node[_PUMPS_KEY]
            del node[_PUMPS_KEY]
        else:
            node[_PUMPS_KEY], pumps = now["pumps"], 0.0
        materials.set_value(node, model.parameter("pumps"), pumps)
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_compare_pumping,)
