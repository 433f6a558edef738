"""Driven parameters, which links, drivers or keyframes change, and the ranges that their lobe rows are baked over."""
import json

import numpy as np

from ...forms.rows import grid
from ..backend import pair_of, text_of
from . import groups
from .curves import curves
from .groups import model_of
from .sockets import by_id, get_value, socket_of

# Custom property of a group: {parameter: [least, most]} of the ranges chosen for driven parameters, as JSON.
RANGES_KEY = "plausible_ranges"
# Number of evenly spaced frames at which an animation is evaluated for its extent.
_FRAMES = 65


def ranges(node) -> dict:
    """{parameter id: (least, most)} of a node's driven parameters, see `range_of`. Its program covers these ranges."""
    return {p.id: range_of(node, p)
            for p in driven_among(model_of(node), groups.backend_of(node), by_id(node), node.id_data)}


def is_driven(node, parameter) -> bool:
    """Whether a parameter of a node is driven, and so has one of the `ranges`."""
    return parameter in driven_among(model_of(node), groups.backend_of(node), by_id(node), node.id_data)


def driven_among(model, backend, held: dict, tree) -> list:
    """The parameters of `model` that need a range, as links, drivers or keyframes change their socket.

    `held` is {parameter id: socket} of a node in `tree`. The list is empty where the backend's program follows the
    sockets.
    """
    if backend.follows_sockets(model):
        return []
    paths = {curve.data_path for curve in curves(tree)}
    changed = {name for name, socket in held.items() if socket.is_linked or path_of(socket) in paths}
    return [p for p in model.parameters if p.can_be_driven and p.id in changed]


def range_of(node, parameter) -> tuple:
    """(least, most) of a driven parameter.

    This is the chosen range, else the extent of its keyframes, else the usual range about its socket's value.
    """
    chosen = pair_of(ranges_of(node.node_tree).get(parameter.id))
    try:
        return grid.check(parameter, *(chosen or _extent(node, parameter)))
    except (TypeError, ValueError):  # an invalid range written by hand, no keyframes, or keyframes of equal values
        return parameter.usual_range(parameter.clamp(get_value(node, parameter)))


def set_range(node, parameter, least: float, most: float):
    """Set the range of a driven parameter.

    Raises ValueError for an invalid range, see `grid.check`, and where the node's program follows its sockets.
    """
    model = model_of(node)
    if groups.backend_of(node).follows_sockets(model):
        raise ValueError(f"{model.id} follows the socket of {parameter.id}, so the parameter has no range")
    chosen = {parameter.id: grid.check(parameter, least, most)}
    groups.own(node)
    keep_ranges(node.node_tree, chosen)


def keep_ranges(group, ranges: dict):
    """Store the ranges {parameter id: (least, most)} on a group, in addition to the ranges of other parameters."""
    group[RANGES_KEY] = json.dumps({**ranges_of(group), **ranges})


def ranges_of(group) -> dict:
    """The ranges {parameter id: [least, most]} that are stored on a group; {} where they are missing or damaged."""
    try:
        stored_ranges = json.loads(text_of(group, RANGES_KEY))
    except ValueError:
        return {}
    return stored_ranges if isinstance(stored_ranges, dict) else {}


def path_of(socket) -> str:
    """The data path of a socket's value, as in `FCurve.data_path`."""
    return f"{socket.path_from_id()}.default_value"


def _extent(node, parameter):
    """(least, most) value of a parameter's keyframes; (None, None) without keyframes, or with a link or a driver."""
    socket = socket_of(node, parameter)
    # The curves of the socket, without that of a color's alpha.
    socket_curves = [curve for curve in curves(node.id_data)
                     if curve.data_path == path_of(socket) and curve.array_index < 3]
    if socket.is_linked or any(curve.driver for curve in socket_curves):
        return None, None
    # Curves may overshoot the parameter's limits.
    values = [curve.evaluate(frame) for curve in socket_curves for frame in _frames(curve)]
    clamped = [min(max(value, parameter.minimum), parameter.maximum) for value in values]
    return (min(clamped), max(clamped)) if clamped else (None, None)


def _frames(curve):
    """The frames at which a curve is evaluated for its extent: its keyframes, and `_FRAMES` evenly spaced ones."""
    keys = [key.co[0] for key in curve.keyframe_points]
    return np.union1d(keys, np.linspace(keys[0], keys[-1], _FRAMES)) if keys else []
