"""The operators that update all materials of a file to this version and to the tables in use."""
import bpy

from ...material import baked_state, groups, upgrade
from .common import renders_here, reporting


class PLAUSIBLE_OT_upgrade(bpy.types.Operator):
    """Bring all nodes that an earlier version of the extension made up to this one; values, links and keyframes stay"""

    bl_idname = "plausible.upgrade"
    bl_label = "Upgrade Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return renders_here(cls)

    def execute(self, context):
        text = upgrade.upgrade_all() or "No node is of an earlier version"
        self.report({"WARNING"} if upgrade.outdated() else {"INFO"}, text)
        return {"FINISHED"}


class PLAUSIBLE_OT_update_materials(bpy.types.Operator):
    """Compile the shaders of all Plausible BRDF nodes in this file again, with today's tables; values stay"""

    bl_idname = "plausible.update_materials"
    bl_label = "Update Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return renders_here(cls)

    @reporting
    def execute(self, context):
        upgrade.upgrade_all()
        nodes = [node for tree in groups.trees() for node in tree.nodes if groups.model_of(node) is not None]
        for node in nodes:
            baked_state.bake(node)
        self.report({"INFO"}, f"{len(nodes)} nodes updated")
        return {"FINISHED"}


CLASSES = (PLAUSIBLE_OT_upgrade, PLAUSIBLE_OT_update_materials,)
