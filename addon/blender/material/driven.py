"""Driven parameters: those that links, drivers or keyframes change, and the ranges that rows are baked over."""
import json

import numpy as np

from ...forms.rows import grid
from ..backend import pair_of, text_of
from . import groups
from .curves import curves
from .groups import model_of
from .sockets import by_id, get_value, socket_of

RANGES_KEY = "plausible_ranges"  # of a group: {parameter: [least, most]} that was chosen for driven ones, as JSON
_FRAMES = 65  # of an animation, at which its reach is looked up


def ranges(node) -> dict:
    """{parameter id: (least, most)}: the ranges that a node's program is made over, see `range_of`."""
    return {p.id: range_of(node, p)
            for p in driven_among(model_of(node), groups.backend_of(node), by_id(node), node.id_data)}


def is_driven(node, parameter) -> bool:
    """Whether a parameter is one that has one of the `ranges`."""
    return parameter in driven_among(model_of(node), groups.backend_of(node), by_id(node), node.id_data)


def driven_among(model, backend, held: dict, tree) -> list:
    """Parameters that need a range, as links, drivers or keyframes change the sockets `held` in a tree.

    There are none where the backend's program follows the sockets.
    """
    if backend.follows_sockets(model):
        return []
    paths = {curve.data_path for curve in curves(tree)}
    changed = {name for name, socket in held.items() if socket.is_linked or path_of(socket) in paths}
    return [p for p in model.parameters if p.can_be_driven and p.id in changed]


def range_of(node, parameter) -> tuple:
    """(least, most) of a driven parameter: the range chosen for it, else the reach of its keyframes, else a range about
    its socket's value."""
    chosen = pair_of(ranges_of(node.node_tree).get(parameter.id))
    try:
        return grid.check(parameter, *(chosen or _reach(node, parameter)))
    except (TypeError, ValueError):  # written by hand, or keyframes that are all alike
        return parameter.usual_range(parameter.clamp(get_value(node, parameter)))


def set_range(node, parameter, least: float, most: float):
    """Choose the range of a parameter that is driven.

    Raises ValueError as `grid.check`, and where the node's program follows its sockets.
    """
    model = model_of(node)
    if groups.backend_of(node).follows_sockets(model):
        raise ValueError(f"{model.id} follows what drives {parameter.id} as it is: it has no range")
    chosen = {parameter.id: grid.check(parameter, least, most)}
    groups.own(node)
    keep_ranges(node.node_tree, chosen)


def keep_ranges(group, ranges: dict):
    """Keep the ranges {parameter id: (least, most)} on a group, beside those that it has."""
    group[RANGES_KEY] = json.dumps({**ranges_of(group), **ranges})


def ranges_of(group) -> dict:
    """The ranges that a group keeps; what is written by hand and is none counts for nothing."""
    try:
        found = json.loads(text_of(group, RANGES_KEY))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def path_of(socket) -> str:
    """The data path of a socket's value, as curves name it."""
    return f"{socket.path_from_id()}.default_value"


def _reach(node, parameter):
    """(least, most) value of a parameter's keyframes; None, None where a link or a driver rules, or nothing does."""
    socket = socket_of(node, parameter)
    ours = [curve for curve in curves(node.id_data) if curve.data_path == path_of(socket) and curve.array_index < 3]
    if socket.is_linked or any(curve.driver for curve in ours):
        return None, None
    values = [curve.evaluate(frame) for curve in ours for frame in _frames(curve)]
    clamped = [min(max(value, parameter.minimum), parameter.maximum) for value in values]
    return (min(clamped), max(clamped)) if clamped else (None, None)


def _frames(curve):
    """Frames that tell how far a curve goes: those of its keyframes, and some between."""
    keys = [key.co[0] for key in curve.keyframe_points]
    return np.union1d(keys, np.linspace(keys[0], keys[-1], _FRAMES)) if keys else []
