"""The operator that adds a new material to the active object."""
import bpy

from ....models import MODELS
from ... import backend as backends
from ...host import settings
from ...material import materials
from ..properties import MODEL_ITEMS
from .common import renders_here, reporting


class PLAUSIBLE_OT_new_material(bpy.types.Operator):
    """Give the active object a new Plausible BRDF material, and switch on Open Shading Language in this scene"""

    bl_idname = "plausible.new_material"
    bl_label = "New Plausible Material"
    bl_options = {"REGISTER", "UNDO"}

    model: bpy.props.EnumProperty(name="Model", items=MODEL_ITEMS, default="pumped_phong")

    @classmethod
    def poll(cls, context):
        thing = context.object
        if thing is None or not hasattr(thing.data, "materials"):
            cls.poll_message_set("The active object cannot have materials")
            return False
        if not (thing.is_editable and thing.data.is_editable):
            cls.poll_message_set("The active object is linked from another file")
            return False
        return renders_here(cls)

    @reporting
    def execute(self, context):
        material = materials.create_material(self.model, **settings.for_new(MODELS[self.model]))
        _put_on(context.object, material)
        if backends.DEFAULT.prepare(context.scene):
            self.report({"INFO"}, f"{material.name}: Open Shading Language is now on for this scene")
        return {"FINISHED"}


def _put_on(thing, material):
    """Assign the material to the object's active slot, or to a new slot where it has none."""
    if not thing.material_slots:
        thing.data.materials.append(material)
    else:
        thing.material_slots[thing.active_material_index].material = material


CLASSES = (PLAUSIBLE_OT_new_material,)
