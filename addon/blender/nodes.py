"""The node of ours in a material: what its sockets hold, and whether what is baked into it is for that."""
import json

import bpy

from ..baking import weights_error
from . import cache, groups, osl, stand_in
from .groups import model_of
from .replace import curves
from .words import say

BAKED_KEY = "plausible_baked"  # of a group: the values that the weights of a baked model were made for
ERROR_KEY = "plausible_baked_error"  # of these weights: largest errors of the lobe and of the albedo up to 80 degrees


def trees() -> list:
    """The node trees of this file that can be edited and may hold nodes of ours."""
    found = [m.node_tree for m in bpy.data.materials if m.node_tree is not None and m.is_editable]
    found += [tree for tree in bpy.data.node_groups if tree.is_editable and groups.MODEL_KEY not in tree]
    return [tree for tree in found if tree.bl_idname == "ShaderNodeTree"]


def find_node(material):
    """The node of ours in a material, or None."""
    if material is None or material.node_tree is None:
        return None
    return next((node for node in material.node_tree.nodes if model_of(node) is not None), None)


def socket_of(node, parameter):
    """The socket of a parameter, or None where the node lacks it."""
    return groups.socket(node, parameter)


def is_linked(node, parameter) -> bool:
    """Whether something is plugged into the socket of a parameter."""
    socket = socket_of(node, parameter)
    return socket is not None and socket.is_linked


def get_value(node, parameter):
    """Value of a parameter as its socket holds it, see `read`; its default where the node lacks the socket."""
    socket = socket_of(node, parameter)
    return parameter.default if socket is None else read(socket, parameter)


def read(socket, parameter):
    """What a parameter's socket holds: a number, a text, or a tuple of three."""
    value = socket.default_value
    return tuple(value)[:3] if parameter.kind in ("color", "vector") else value


def carried(model, before: dict) -> dict:
    """Values, by parameter id, that a node of `model` takes over from the sockets `before`, held to their ranges."""
    return {p.id: p.clamp(read(before[p.id], p)) for p in model.parameters if p.evaluated and p.id in before}


def write(node, parameter, value):
    """Write a parameter's socket and nothing else.

    Raises ValueError for a value out of range, and where the node was edited and lacks the socket.
    """
    value = parameter.check(value)
    require(node, [parameter])
    if socket_of(node, parameter).node != node:  # inside the group, as a text's, which other nodes may share
        groups.own(node)
    socket = socket_of(node, parameter)
    socket.default_value = osl.stored(socket, value)


def require(node, parameters):
    """Raise ValueError, which tells the cure, where a node that was edited lacks a socket of `parameters`."""
    lost = [say(p.label) for p in parameters if socket_of(node, p) is None]
    if lost:
        raise ValueError(_lacks(node, lost))


def output_of(node, name: str):
    """An output of a node. Raises ValueError as `require`."""
    if name not in node.outputs:
        raise ValueError(_lacks(node, [name]))
    return node.outputs[name]


def _lacks(node, names):
    return say("{node} was edited and lacks {names}: Renew Node in the panel makes it whole", node=node.name,
               names=", ".join(names))


def values(node) -> dict:
    """All values of a node that the formula takes, by parameter id, held to their ranges as the shader holds them.

    A socket takes any number in the node editor, so what it holds may be out of range.
    """
    held = groups.sockets(node)
    return {p.id: p.clamp(read(held[p.id], p)) if p.id in held else p.default
            for p in model_of(node).parameters if p.evaluated}


def is_stale(node) -> bool:
    """Whether a node's weights are for other values than its sockets hold, or for an image that has changed since.

    An image that is gone has not changed: the weights are all that is left of it.
    """
    if not model_of(node).baked:
        return False
    then, files = _baked_for(node.node_tree)
    now, files_now = json.loads(_values_text(node))
    return then != now or any(files.get(name, stamp) != stamp for name, stamp in files_now.items() if stamp)


def _baked_for(tree):
    """(values, {parameter: stamp of its file}) that a group's weights are for; (None, {}) where it is not known."""
    try:
        values, files = json.loads(groups.text_of(tree, BAKED_KEY))
    except (TypeError, ValueError):  # nothing is written there, or by hand
        return None, {}
    return (values, files) if isinstance(files, dict) else (None, {})


def baked_error(node):
    """Largest errors (of the lobe, of the albedo) of a node's weights up to 80 degrees; None where none are known."""
    return groups.pair_of(node.node_tree.get(ERROR_KEY))


def driven(node) -> list:
    """Labels of parameters that a link drives although the node's weights are for one value of each."""
    model, held = model_of(node), groups.sockets(node)
    return [p.label for p in model.parameters
            if model.baked and p.evaluated and p.id in held and held[p.id].is_linked]


def animated(node) -> list:
    """Labels of parameters that keyframes or drivers change although the node's weights are for one value of each."""
    model = model_of(node)
    if not model.baked:
        return []
    held = groups.sockets(node)
    paths = {curve.data_path for curve in curves(node.id_data)}
    return [p.label for p in model.parameters if p.evaluated and p.id in held
            and f"{held[p.id].path_from_id()}.default_value" in paths]


def bake_weights(node, error: tuple | None = None):
    """Bake a node's weights for the values of its sockets; `error` is that of the weights if it is known.

    Raises ValueError, osl.OslError as `create_material`.
    """
    groups.load(node, values(node))
    note_values(node, error)


def note_values(node, error: tuple | None = None):
    """Remember what a baked model's weights, just put into its node, are for, and show it in the stand-in."""
    model = model_of(node)
    if model.baked:
        given = values(node)
        node.node_tree[BAKED_KEY] = _values_text(node)
        node.node_tree[ERROR_KEY] = cache.fetch(cache.key(model, given, "error"), lambda: error or weights_error.error(
            model, given).largest())
        show(node)


def show(node):
    """Have the stand-in of a baked model's node look like its values; one that cannot be made stays as it was."""
    try:
        stand_in.write(node, model_of(node), values(node))
    except ValueError as error:  # an image that cannot be read
        print(f"Plausible BRDF: {node.name}: {error}")


def _values_text(node):
    given = values(node)
    stamps = {p.id: p.stamp(given[p.id]) for p in model_of(node).parameters if p.kind == "image"}
    return json.dumps([given, stamps])
