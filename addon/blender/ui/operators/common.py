"""Shared parts of operators: error reports, the shown material, polls."""
import functools

import bpy

from ... import backend as backends
from ...material import groups


def reporting(execute):
    """Wraps an operator's `execute`: RuntimeError, ValueError and OSError are reported, and cancel the operator."""
    @functools.wraps(execute)
    def reported(self, context):
        try:
            return execute(self, context)
        except (RuntimeError, ValueError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return reported


def material_of(context):
    """The material in the material tab or shader editor of the context; None without one."""
    space = context.space_data
    if space is not None and space.type == "NODE_EDITOR":
        return space.id if isinstance(space.id, bpy.types.Material) else None
    return getattr(context, "material", None)


def plausible_node(material):
    """(node, model) of a Plausible material; (None, None) for any other."""
    node = groups.find_node(material)
    model = groups.model_of(node) if node else None
    return (node, model) if model else (None, None)


def renders_here(cls, backend=backends.DEFAULT) -> bool:
    """Whether this Blender runs a backend, for an operator's poll. If not, the button's tooltip gives the reason."""
    notices = backend.why_not()
    if notices:
        cls.poll_message_set(notices[0].text)
    return not notices


class OnMaterial:
    """Base of operators that change the shown material and can be undone."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        material = material_of(context)
        return material is not None and material.is_editable and plausible_node(material)[1] is not None
