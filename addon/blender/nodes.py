"""The node of ours in a material: what its sockets hold, and whether what is baked into it is for that."""
import json

import bpy
import numpy as np

from ..baking.rows import error as rows_error
from ..baking.rows import grid
from . import cache, groups, osl, stand_in
from .groups import model_of
from .replace import curves, replace_node
from .words import say

BAKED_KEY = "plausible_baked"  # of a group: the values that the weights of a baked model were made for
ERROR_KEY = "plausible_baked_error"  # of these weights: largest errors of the lobe and of the albedo up to 80 degrees
_FRAMES = 65  # of an animation, at which it is looked up how far it goes


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


def material_of(node):
    """The material whose tree a node is in; None for one inside a group, which may be in several."""
    return next((m for m in bpy.data.materials if m.node_tree == node.id_data), None)


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


def take_over(old, before: dict, model, given: dict):
    """Put a node of `model` in the place of `old`, whose sockets by parameter id are `before`; returns it.

    Where the model is baked it is so for the values `given`; but where something goes on to drive it, which takes
    ranges and longer, its weights are blank until they are baked. Raises as `groups.add_node`.
    """
    lut = groups.lut_of(old.node_tree)
    if _moved(model, before, old.id_data):
        new = groups.add_compiled(old.id_data, model, osl.compile_blank(model), lut)
    else:
        new = groups.add_node(old.id_data, model, lut, given)
    replace_node(old, before, new)
    return new


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
    *then, files = _baked_for(node.node_tree)
    *now, files_now = _read_noted(_noted(node, driven(node)))
    return then != now or any(files.get(name, stamp) != stamp for name, stamp in files_now.items() if stamp)


def _baked_for(tree):
    """(values, ranges of the driven, {parameter: stamp of its file}) that a group's weights are for.

    (None, {}, {}) where it is not known.
    """
    try:
        return _read_noted(groups.text_of(tree, BAKED_KEY))
    except (TypeError, ValueError):  # nothing is written there, or by hand
        return None, {}, {}


def _noted(node, over):
    """What weights are for, as text: values that do not change, stamps of files, the ranges `over` of the driven."""
    given = {name: value for name, value in values(node).items() if name not in over}
    stamps = {p.id: p.stamp(given[p.id]) for p in model_of(node).parameters if p.kind == "image"}
    return json.dumps([given, stamps, over])


def _read_noted(text):
    """(values, ranges, stamps) of `_noted`; files of older versions know no ranges. Raises TypeError, ValueError."""
    given, stamps, over = [*json.loads(text), {}][:3]
    if not isinstance(stamps, dict) or not isinstance(over, dict):
        raise ValueError(text)
    return given, over, stamps


def baked_error(node):
    """Largest errors (of the lobe, of the albedo) of a node's weights up to 80 degrees; None where none are known."""
    return groups.pair_of(node.node_tree.get(ERROR_KEY))


def _moved(model, sockets, tree):
    """Parameters that a baked model has ranges of, as links, drivers or keyframes change their `sockets` in a tree."""
    if not model.baked:
        return []
    paths = {curve.data_path for curve in curves(tree)}
    changed = {name for name, socket in sockets.items() if socket.is_linked or _path(socket) in paths}
    return [p for p in model.parameters if p.can_be_driven and p.id in changed]


def is_driven(node, parameter) -> bool:
    """Whether a parameter is one of those `driven`."""
    return parameter in _moved(model_of(node), groups.sockets(node), node.id_data)


def driven(node) -> dict:
    """{parameter id: (least, most)} of what a model is baked over, as something changes its socket; see `range_of`."""
    return {p.id: range_of(node, p) for p in _moved(model_of(node), groups.sockets(node), node.id_data)}


def range_of(node, parameter) -> tuple:
    """(least, most) that a parameter of a baked model is baked over where it is driven.

    It is what was chosen for it, else what its keyframes reach, else about the value that its socket has.
    """
    chosen = groups.pair_of(_ranges(node.node_tree).get(parameter.id))
    try:
        return grid.check(parameter, *(chosen or _reach(node, parameter)))
    except (TypeError, ValueError):  # written by hand, or keyframes that are all alike
        return parameter.usual_range(parameter.clamp(get_value(node, parameter)))


def set_range(node, parameter, least: float, most: float):
    """Choose what a parameter is baked over where it is driven.

    Raises ValueError as `grid.check`, and of a model that is not baked.
    """
    if not model_of(node).baked:
        raise ValueError(f"{model_of(node).id} follows what drives {parameter.id} as it is: it has no range")
    chosen = {parameter.id: grid.check(parameter, least, most)}
    groups.own(node)
    node.node_tree[groups.RANGES_KEY] = json.dumps({**_ranges(node.node_tree), **chosen})


def _ranges(tree):
    """The ranges that were chosen; what is written by hand and is none counts for nothing."""
    try:
        found = json.loads(groups.text_of(tree, groups.RANGES_KEY))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def _path(socket):
    return f"{socket.path_from_id()}.default_value"


def _reach(node, parameter):
    """(least, most) value of a parameter's keyframes; None, None where a link or a driver rules, or nothing does."""
    socket = socket_of(node, parameter)
    ours = [curve for curve in curves(node.id_data) if curve.data_path == _path(socket) and curve.array_index < 3]
    if socket.is_linked or any(curve.driver for curve in ours):
        return None, None
    values = [curve.evaluate(frame) for curve in ours for frame in _frames(curve)]
    held = [min(max(value, parameter.minimum), parameter.maximum) for value in values]
    return (min(held), max(held)) if held else (None, None)


def _frames(curve):
    """Frames that tell how far a curve goes: those of its keyframes, and some between."""
    keys = [key.co[0] for key in curve.keyframe_points]
    return np.union1d(keys, np.linspace(keys[0], keys[-1], _FRAMES)) if keys else []


def wanted(node) -> tuple:
    """(values, ranges of the driven) that a node's weights ought to be for."""
    over = driven(node)
    return {name: value for name, value in values(node).items() if name not in over}, over


def bake_weights(node, error: tuple | None = None):
    """Bake a node's weights for the values of its sockets, and over ranges of what is driven.

    `error` is that of the weights if it is known. Raises ValueError, osl.OslError as `create_material`.
    """
    given, over = wanted(node)
    groups.load(node, given, over)
    note_values(node, error, over)


def note_values(node, error: tuple | None = None, over: dict | None = None):
    """Remember what a baked model's weights, just put into its node, are for, and show it in the stand-in.

    `over` are the ranges of what is driven.
    """
    model = model_of(node)
    if model.baked:
        given, tree = values(node), node.node_tree
        tree[BAKED_KEY] = _noted(node, over or {})
        # A driver's socket has another value at every frame: the range about the first one stays.
        paths = {curve.data_path for curve in curves(node.id_data) if curve.driver}
        held = groups.sockets(node)
        kept = {name: each for name, each in (over or {}).items() if _path(held[name]) in paths}
        if kept:
            tree[groups.RANGES_KEY] = json.dumps({**_ranges(tree), **kept})
        tree[ERROR_KEY] = cache.fetch(cache.key(model, given, "error", over),
                                      lambda: error or rows_error.largest(model, given, over))
        show(node)


def show(node):
    """Have the stand-in of a baked model's node look like its values; one that cannot be made stays as it was."""
    try:
        stand_in.write(node, model_of(node), values(node))
    except ValueError as error:  # an image that cannot be read
        print(f"Plausible BRDF: {node.name}: {error}")
