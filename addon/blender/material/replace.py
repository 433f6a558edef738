"""Putting one node in the place of another: its values, links, keyframes and drivers go on."""
import re

import bpy

from ..backend import stored, text_of
from .curves import curves
from .driven import RANGES_KEY
from .groups import backend_of, model_of
from .sockets import by_id


def replace_node(old, before: dict, new):
    """Remove the node `old`, whose sockets by parameter id are `before`; `new`, of one of our models, takes its place.

    What both have stays: values, links, keyframes and drivers. Keyframes of what `new` lacks are kept where they move
    nothing, under the name of the socket that they were for.
    """
    tree, model = new.id_data, model_of(new)
    after = by_id(new)
    declared = {p.id: p for p in model.parameters}
    for name in before.keys() & after.keys():
        _carry(before[name], after[name], declared.get(name))
        for link in list(before[name].links):
            if before[name].node == old:
                tree.links.new(link.from_socket, after[name])
    for socket in old.outputs:
        for link in list(socket.links):
            if socket.name in new.outputs:
                tree.links.new(new.outputs[socket.name], link.to_socket)
    places = {_index(old, socket): _index(new, after[name]) if name in after else None
              for name, socket in before.items() if socket.node == old}
    labels = {_index(old, socket): socket.name for socket in before.values() if socket.node == old}
    ranges = text_of(getattr(old, "node_tree", None) or {}, RANGES_KEY)
    if ranges and not backend_of(new).follows_sockets(model):
        new.node_tree[RANGES_KEY] = ranges
    new.location, new.width, new.parent, new.mute = old.location, old.width, old.parent, old.mute
    name = old.name
    # With a node Blender removes the keyframes under its name: they are taken to the new one before.
    old.name = f"{name} (old)"
    _move_curves(tree, old.name, name, places, labels)
    tree.nodes.remove(old)
    new.name = name


def _carry(source, target, parameter):
    """Copy a socket's value, clamped to the parameter's range."""
    value = source.default_value
    if parameter is None:  # the path of a table
        target.default_value = value
        return
    if parameter.kind in ("color", "vector"):
        value = tuple(value)[:3]
    target.default_value = stored(target, parameter.clamp(value))


def _index(node, socket):
    """The place of a socket among its node's inputs, which data paths name it by; None where it is inside a group."""
    return next((i for i, each in enumerate(node.inputs) if each == socket), None)


def _move_curves(tree, old_name, new_name, places, labels):
    old, new = (f'nodes["{bpy.utils.escape_identifier(name)}"]' for name in (old_name, new_name))
    path = re.compile(re.escape(old) + r"(?:\.inputs\[(\d+)\])?")

    def moved(match):
        place = int(match[1]) if match[1] else None
        if place not in places:
            return match[0].replace(old, new)
        if places[place] is None:
            return f'{new}.inputs["{bpy.utils.escape_identifier(labels[place])}"]'
        return f"{new}.inputs[{places[place]}]"

    for curve in curves(tree):
        curve.data_path = path.sub(moved, curve.data_path)
