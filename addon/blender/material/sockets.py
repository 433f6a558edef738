"""The sockets that hold a node's values: found by parameter, read, and written."""
from ..backend import stored
from ..host.translation import tr
from . import groups
from .groups import model_of

# Types of sockets that can hold a parameter's value: whoever edits a group may give a socket another.
_TYPES = {"float": {"VALUE"}, "int": {"INT"}, "enum": {"INT"}, "bool": {"BOOLEAN", "INT"}, "color": {"RGBA", "VECTOR"},
          "vector": {"VECTOR"}, "image": {"STRING"}}


def by_id(node) -> dict:
    """{parameter id: socket that holds its value} of a node of ours; texts have theirs inside the group.

    In a group that was edited a parameter may have no socket, or one that cannot hold its value, which counts for none.
    """
    outside = {socket.identifier: socket for socket in node.inputs}
    found = {name: outside.get(identifier) for name, identifier in groups.socket_identifiers(node.node_tree).items()}
    return fitting(model_of(node), {**groups.texts_of(node.node_tree), **found})


def fitting(model, found: dict) -> dict:
    """Those of the sockets `found`, by parameter id, that can hold their parameters' values."""
    declared = {p.id: p for p in model.parameters}
    return {name: socket for name, socket in found.items() if socket is not None and _fits(socket, declared.get(name))}


def _fits(socket, parameter):
    """Whether a socket can hold a parameter's value; the path of a table is no parameter."""
    return socket.type in (_TYPES[parameter.kind] if parameter else {"STRING"})


def socket_of(node, parameter):
    """The socket of a parameter, or None where the node lacks it."""
    return by_id(node).get(parameter.id)


def is_linked(node, parameter) -> bool:
    """Whether something is plugged into the socket of a parameter."""
    socket = socket_of(node, parameter)
    return socket is not None and socket.is_linked


def read(socket, parameter):
    """What a parameter's socket holds: a number, a text, or a tuple of three."""
    value = socket.default_value
    return tuple(value)[:3] if parameter.kind in ("color", "vector") else value


def get_value(node, parameter):
    """Value of a parameter as its socket holds it, see `read`; its default where the node lacks the socket."""
    socket = socket_of(node, parameter)
    return parameter.default if socket is None else read(socket, parameter)


def values(node) -> dict:
    """The values of all parameters of the formula, by id, clamped to their ranges as the shader clamps them.

    A socket takes any number in the node editor, so what it holds may be out of range.
    """
    held = by_id(node)
    return {p.id: p.clamp(read(held[p.id], p)) if p.id in held else p.default
            for p in model_of(node).parameters if p.evaluated}


def carried(model, before: dict) -> dict:
    """Values, by parameter id, that a node of `model` takes over from the sockets `before`, clamped to their ranges."""
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
    socket.default_value = stored(socket, value)


def require(node, parameters):
    """Raise ValueError, which names the cure, where a node that was edited lacks a socket of `parameters`."""
    lost = [tr(p.label) for p in parameters if socket_of(node, p) is None]
    if lost:
        raise ValueError(tr("{node} was edited and lacks {names}: Renew Node in the panel makes it whole",
                             node=node.name, names=", ".join(lost)))
