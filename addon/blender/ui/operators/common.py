"""What operators share: reports of what went wrong, the material shown, polls."""
import functools

import bpy

from ... import backend as backends
from ...material import groups


def reporting(execute):
    """An operator's `execute` that reports what a user or a file can get wrong, and is then cancelled."""
    @functools.wraps(execute)
    def reported(self, context):
        try:
            return execute(self, context)
        except (RuntimeError, ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return reported


def material_of(context):
    """The material that a material tab or shader editor shows; None when it shows none."""
    space = context.space_data
    if space is not None and space.type == "NODE_EDITOR":
        return space.id if isinstance(space.id, bpy.types.Material) else None
    return getattr(context, "material", None)


def plausible_node(material):
    """(node, model) of a material made here; (None, None) for any other."""
    node = groups.find_node(material)
    model = groups.model_of(node) if node else None
    return (node, model) if model else (None, None)


def renders_here(cls, backend=backends.DEFAULT) -> bool:
    """Whether this Blender runs a backend, for an operator's poll; where not, the button's tooltip tells why."""
    hindrances = backend.why_not()
    if hindrances:
        cls.poll_message_set(hindrances[0].text)
    return not hindrances


class OnMaterial:
    """An operator that changes the material shown, and can be undone."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        material = material_of(context)
        return material is not None and material.is_editable and plausible_node(material)[1] is not None
