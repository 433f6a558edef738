"""Switches between two states of a material: width by exponent or by roughness, before and after pumping, the model or
what Cycles ships in its place."""
import bpy

from .. import brdf
from . import groups, materials, nodes
from .operators import OnMaterial, material_of, plausible_node, reporting

_PUMPS_KEY = "plausible_pumps"  # of a node: its pumps while it shows the model before pumping


class PLAUSIBLE_OT_switch_width(OnMaterial, bpy.types.Operator):
    """Give the lobe's width by roughness instead of by exponent, or the other way; the lobe stays as wide as it is"""

    bl_idname = "plausible.switch_width"
    bl_label = "Exponent ↔ Roughness"

    @reporting
    def execute(self, context):
        node, model = plausible_node(material_of(context))
        now = nodes.values(node)
        if "use_roughness" not in now:
            raise ValueError(f"{model.label} has no roughness to give its width by")
        new = {"use_roughness": not now["use_roughness"]}
        if now["use_roughness"]:
            new["exponent"] = brdf.exponent_of_roughness(now["roughness"])
        else:
            new["roughness"] = brdf.roughness_of_exponent(now["exponent"])
        materials.set_values(node, {model.parameter(name): value for name, value in new.items()})
        return {"FINISHED"}


def shows_before(node) -> bool:
    """Whether a node shows its model before pumping, to compare."""
    return isinstance(node.get(_PUMPS_KEY), int | float)


class PLAUSIBLE_OT_compare_pumping(OnMaterial, bpy.types.Operator):
    """Show the material before pumping, and, pressed again, after it"""

    bl_idname = "plausible.compare_pumping"
    bl_label = "Compare"

    @reporting
    def execute(self, context):
        node, model = plausible_node(material_of(context))
        now = nodes.values(node)
        if "pumps" not in now:
            raise ValueError(f"{model.label} is not pumped: there is nothing to compare")
        if shows_before(node):
            pumps = node[_PUMPS_KEY]
            del node[_PUMPS_KEY]
        else:
            node[_PUMPS_KEY], pumps = now["pumps"], 0.0
        materials.set_value(node, model.parameter("pumps"), pumps)
        return {"FINISHED"}


def is_native(node) -> bool:
    """Whether the stand-in renders in Cycles, too, in place of the model."""
    return groups.MOVED_KEY in node


class PLAUSIBLE_OT_switch_native(OnMaterial, bpy.types.Operator):
    """Render what Cycles ships in place of the model, on any device and without Open Shading Language, or go back"""

    bl_idname = "plausible.switch_native"
    bl_label = "Native Approximation"

    @reporting
    def execute(self, context):
        node = plausible_node(material_of(context))[0]
        if is_native(node):
            _move_back(node)
        else:
            _move(node)
        return {"FINISHED"}


def _move(node):
    links = list(nodes.output_of(node, groups.BSDF).links)
    if not links:
        raise ValueError("The node's BSDF is plugged into nothing: there is nothing to replace")
    node[groups.MOVED_KEY] = [[link.to_node.name, link.to_socket.identifier] for link in links]
    for link in links:
        node.id_data.links.new(nodes.output_of(node, groups.STAND_IN), link.to_socket)


def _move_back(node):
    """Plug the model in again where the stand-in still is; what was plugged in otherwise since then stays."""
    places = _places(node[groups.MOVED_KEY])
    for link in list(nodes.output_of(node, groups.STAND_IN).links):
        if (link.to_node.name, link.to_socket.identifier) in places:
            node.id_data.links.new(nodes.output_of(node, groups.BSDF), link.to_socket)
    del node[groups.MOVED_KEY]


def _places(noted) -> list:
    """Where a shader was plugged in, as it was noted; [] of what was written there by hand."""
    try:
        return [tuple(place) for place in noted]
    except TypeError:
        return []


CLASSES = (PLAUSIBLE_OT_switch_width, PLAUSIBLE_OT_compare_pumping, PLAUSIBLE_OT_switch_native)
