"""Replacing a node by another one, which takes over its values, links, keyframes and drivers."""
import re

import bpy

from ..backend import stored, text_of
from .curves import curves
from .driven import RANGES_KEY
from .groups import backend_of, model_of
from .sockets import by_id


def replace_node(old, before: dict, new):
    """Replace the node `old`, whose sockets by parameter id are `before`, by `new`, a node of a Plausible model.

    Values, links, keyframes and drivers of the parameters that both have are taken over. Keyframes of other parameters
    are kept under a data path that names the old socket, where they have no effect.
    """
    tree, model = new.id_data, model_of(new)
    after = by_id(new)
    declared = {p.id: p for p in model.parameters}
    # Inputs: values, and links from outside.
    for name in before.keys() & after.keys():
        _carry(before[name], after[name], declared.get(name))
        for link in list(before[name].links):
            if before[name].node == old:
                tree.links.new(link.from_socket, after[name])
    # Links of the outputs, matched by name.
    for socket in old.outputs:
        for link in list(socket.links):
            if socket.name in new.outputs:
                tree.links.new(new.outputs[socket.name], link.to_socket)
    # Data paths name an input by its index: map the old indices to the new ones.
    new_indices = {_index(old, socket): _index(new, after[name]) if name in after else None
                   for name, socket in before.items() if socket.node == old}
    labels = {_index(old, socket): socket.name for socket in before.values() if socket.node == old}
    ranges = text_of(getattr(old, "node_tree", None) or {}, RANGES_KEY)
    if ranges and not backend_of(new).follows_sockets(model):
        new.node_tree[RANGES_KEY] = ranges
    new.location, new.width, new.parent, new.mute = old.location, old.width, old.parent, old.mute
    name = old.name
    # Removing a node removes the keyframes under its name, so they are moved to the new node first.
    old.name = f"{name} (old)"
    _move_curves(tree, old.name, name, new_indices, labels)
    tree.nodes.remove(old)
    new.name = name


def _carry(source, target, parameter):
    """Copy a socket's value, clamped to the parameter's range."""
    value = source.default_value
    if parameter is None:  # the path of an albedo table
        target.default_value = value
        return
    if parameter.kind in ("color", "vector"):
        value = tuple(value)[:3]
    target.default_value = stored(target, parameter.clamp(value))


def _index(node, socket):
    """The index of a socket among the node's inputs, as in data paths; None where the socket is inside the group."""
    return next((i for i, entry in enumerate(node.inputs) if entry == socket), None)


def _move_curves(tree, old_name, new_name, new_indices, labels):
    """Rewrite the data paths of a tree's curves from one node to another.

    `new_indices` is {index of an old input: index of the new one, or None}, `labels` {index of an old input: its name}.
    """
    old, new = (f'nodes["{bpy.utils.escape_identifier(name)}"]' for name in (old_name, new_name))
    path = re.compile(re.escape(old) + r"(?:\.inputs\[(\d+)\])?")

    def moved(match):
        index = int(match[1]) if match[1] else None
        if index not in new_indices:  # another property of the node
            return match[0].replace(old, new)
        if new_indices[index] is None:
            return f'{new}.inputs["{bpy.utils.escape_identifier(labels[index])}"]'
        return f"{new}.inputs[{new_indices[index]}]"

    for curve in curves(tree):
        curve.data_path = path.sub(moved, curve.data_path)
