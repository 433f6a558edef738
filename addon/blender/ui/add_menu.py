"""Add > Shader > Plausible in the shader editor: one node for each model."""
import bpy

from ...models import MODELS
from .. import backend as backends
from ..material import baked_state, groups
from .operators.common import renders_here, reporting
from .properties import MODEL_ITEMS

# Blender's menu Add > Shader.
_SHADER_MENU = "NODE_MT_category_shader_shader"


class PLAUSIBLE_OT_add_node(bpy.types.Operator):
    """Add the node of a reflectance model"""

    bl_idname = "plausible.add_node"
    bl_label = "Add Plausible Node"
    bl_options = {"REGISTER", "UNDO"}

    model: bpy.props.EnumProperty(name="Model", items=MODEL_ITEMS, default="pumped_phong")

    @classmethod
    def description(cls, context, properties):
        return MODELS[properties.model].description

    @classmethod
    def poll(cls, context):
        space = context.space_data
        if space is None or space.type != "NODE_EDITOR" or space.tree_type != "ShaderNodeTree":
            return False
        if space.edit_tree is None or not space.edit_tree.is_editable:
            cls.poll_message_set("There are no nodes here that can be edited")
            return False
        return renders_here(cls)

    def invoke(self, context, event):
        # The node goes to the mouse, not to the last position of the menu.
        context.space_data.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        result = self.execute(context)
        if result == {"FINISHED"}:
            bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return result

    @reporting
    def execute(self, context):
        tree = context.space_data.edit_tree
        # The node, selected and active.
        node = groups.add_node(tree, MODELS[self.model])
        baked_state.record(node)
        for other in tree.nodes:
            other.select = False
        node.location, node.select = context.space_data.cursor_location, True
        tree.nodes.active = node
        if context.scene is not None and not backends.DEFAULT.is_ready(context.scene):
            self.report({"INFO"}, "Cycles runs this node when Open Shading Language is on: see the sidebar, Plausible")
        return {"FINISHED"}


class PLAUSIBLE_MT_add(bpy.types.Menu):
    """Nodes of reflectance models"""

    bl_idname = "PLAUSIBLE_MT_add"
    bl_label = "Plausible"

    def draw(self, context):
        for model in MODELS.values():
            if backends.DEFAULT.follows_sockets(model):
                self.layout.operator("plausible.add_node", text=model.label).model = model.id
        self.layout.separator()
        self.layout.menu("PLAUSIBLE_MT_add_baked")


class PLAUSIBLE_MT_add_baked(bpy.types.Menu):
    """Nodes of models that are baked for the values of their parameters"""

    bl_idname = "PLAUSIBLE_MT_add_baked"
    bl_label = "Baked for Their Values"

    def draw(self, context):
        for model in MODELS.values():
            if not backends.DEFAULT.follows_sockets(model):
                self.layout.operator("plausible.add_node", text=model.label).model = model.id


def _entry(self, context):
    self.layout.menu("PLAUSIBLE_MT_add")


def start():
    """Append the menu to Blender's menu of shaders."""
    getattr(bpy.types, _SHADER_MENU).append(_entry)


def stop():
    """Remove the menu."""
    getattr(bpy.types, _SHADER_MENU).remove(_entry)


CLASSES = (PLAUSIBLE_OT_add_node, PLAUSIBLE_MT_add, PLAUSIBLE_MT_add_baked)
