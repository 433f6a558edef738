"""The sockets of a node's parameters: find, read and write them."""
from ..backend import stored
from ..host.translation import tr
from . import groups
from .groups import model_of

# Types of sockets that can store a parameter's value, by kind. Users may change a socket's type in the group editor.
_TYPES = {"float": {"VALUE"}, "int": {"INT"}, "enum": {"INT"}, "bool": {"BOOLEAN", "INT"}, "color": {"RGBA", "VECTOR"},
          "vector": {"VECTOR"}, "image": {"STRING"}}


def by_id(node) -> dict:
    """{parameter id: socket with its value} of a Plausible node. Text sockets are inside the group.

    In an edited group a parameter may lack its socket, or the socket may have the wrong type: it is left out then.
    """
    outside = {socket.identifier: socket for socket in node.inputs}
    on_group = {name: outside.get(identifier) for name, identifier in groups.socket_identifiers(node.node_tree).items()}
    return fitting(model_of(node), {**groups.texts_of(node.node_tree), **on_group})


def fitting(model, found: dict) -> dict:
    """The sockets among `found`, {parameter id: socket or None}, whose type can store their parameter's value."""
    declared = {p.id: p for p in model.parameters}
    return {name: socket for name, socket in found.items() if socket is not None and _fits(socket, declared.get(name))}


def _fits(socket, parameter):
    """Whether a socket's type can store a parameter's value; None stands for the path of an albedo table."""
    return socket.type in (_TYPES[parameter.kind] if parameter else {"STRING"})


def socket_of(node, parameter):
    """The socket of a parameter; None where the node lacks it."""
    return by_id(node).get(parameter.id)


def is_linked(node, parameter) -> bool:
    """Whether the socket of a parameter is linked."""
    socket = socket_of(node, parameter)
    return socket is not None and socket.is_linked


def read(socket, parameter):
    """The value of a parameter's socket: a number, a text, or a tuple of three numbers."""
    value = socket.default_value
    return tuple(value)[:3] if parameter.kind in ("color", "vector") else value


def get_value(node, parameter):
    """The value of a parameter's socket, see `read`; the parameter's default where the node lacks the socket."""
    socket = socket_of(node, parameter)
    return parameter.default if socket is None else read(socket, parameter)


def values(node) -> dict:
    """The values of all parameters of the formula, by id, clamped to their ranges as in the shader.

    The node editor accepts any number, so a socket's value may be out of range.
    """
    sockets = by_id(node)
    return {p.id: p.clamp(read(sockets[p.id], p)) if p.id in sockets else p.default
            for p in model_of(node).parameters if p.evaluated}


def carried(model, before: dict) -> dict:
    """Values, by parameter id, that a node of `model` takes over from the sockets `before`, clamped to its ranges."""
    return {p.id: p.clamp(read(before[p.id], p)) for p in model.parameters if p.evaluated and p.id in before}


def write(node, parameter, value):
    """Write a parameter's socket, without updates of viewport or lobe rows.

    Raises ValueError for a value out of range, and where the node lacks the socket as it was edited.
    """
    value = parameter.check(value)
    require(node, [parameter])
    if socket_of(node, parameter).node != node:  # a text socket inside the group, which other nodes may share
        groups.own(node)
    socket = socket_of(node, parameter)
    socket.default_value = stored(socket, value)


def require(node, parameters):
    """Raise ValueError, which names the remedy, where an edited node lacks a socket of `parameters`."""
    missing = [tr(p.label) for p in parameters if socket_of(node, p) is None]
    if missing:
        raise ValueError(tr("{node} was edited and lacks {names}: Renew Node in the panel makes it whole",
                             node=node.name, names=", ".join(missing)))
