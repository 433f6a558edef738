"""The node of a model: a self-contained group whose sockets are the model's parameters.

The group contains the nodes of two backends: the one that renders in Cycles, and the fallback for other engines. All
nodes of a model whose program follows the sockets share one group; a group with a program for its values has one node.
"""
import json
import math

import bpy

from ... import models
from ...models.parameters import COLOR, GEOMETRY, LOBE, RETROREFLECTION, SAMPLING
from ...version import VERSION
from .. import backend as backends
from ..backend import BSDF, MODEL_KEY, STAND_IN, stored, text_of

# Custom property of a group: the version of the extension that made it.
VERSION_KEY = "plausible_version"
# Custom property of a group: {parameter: identifier of its socket}, as JSON.
SOCKETS_KEY = "plausible_sockets"
# Socket types by kind of parameter; images have no socket on the group.
KINDS = {"float": "NodeSocketFloat", "int": "NodeSocketInt", "enum": "NodeSocketInt", "bool": "NodeSocketBool",
         "color": "NodeSocketColor", "vector": "NodeSocketVector"}
# Subtypes of float sockets by unit.
_SUBTYPES = {"rad": "ANGLE", "m": "DISTANCE"}
# Sections outside panels, in order; and sections in panels below them, with whether the panel is closed at first.
_OPEN, _PANELS = (LOBE, GEOMETRY), {RETROREFLECTION: True, COLOR: False, SAMPLING: True}


# Making.

def add_node(tree, model, backend=backends.DEFAULT, values: dict | None = None):
    """Add the node of a model to a node tree. Its sockets have the parameters' defaults.

    A program that does not follow the sockets is made for `values`, by parameter id. Raises as `Backend.program`.
    """
    return add_program(tree, model, backend, backend.program(model, values))


def add_program(tree, model, backend, program):
    """Add the node of a model to a node tree, with an existing program."""
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = _shared(model, backend, program) or _new_group(model, backend, program)
    node.name = node.label = model.label
    node.width = 220.0
    return node


def _shared(model, backend, program):
    """An existing group of this file with the same program and without a user's edits, or None.

    Groups whose program is for their own values, or reads files, are not shared.
    """
    if not backend.can_share(model):
        return None
    for group in bpy.data.node_groups:
        if (named_model(group) == model and text_of(group, VERSION_KEY) == VERSION and group.library is None
                and backends.of_group(group) == backend and backend.installed(group) == program
                and _is_untouched(group, backend, model)):
            return group
    return None


def _is_untouched(group, backend, model):
    """Whether all of the group's sockets exist, have the right type and are linked inside, as are its outputs."""
    kinds = {item.identifier: item.socket_type for item in group.interface.items_tree if item.item_type == "SOCKET"}
    identifiers = socket_identifiers(group)
    are_right = all(kinds.get(identifiers.get(p.id)) == kind_of(p)
                    for p in backend.parameters(model) if p.kind in KINDS)
    return are_right and not backend.unfed(group, identifiers) and not lacking(group)


def _new_group(model, backend, program):
    """A new group of a model, with the nodes of `backend` and of the fallback."""
    group = bpy.data.node_groups.new(model.label, "ShaderNodeTree")
    group[MODEL_KEY], group[VERSION_KEY], group[backends.BACKEND_KEY] = model.id, VERSION, backend.id
    backend.keep_options(group)
    if hasattr(group, "description"):
        group.description = model.description
    # The group's input and output nodes, and its sockets.
    entry, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    entry.location, end.location = (-900.0, 0.0), (500.0, 0.0)
    identifiers = _declare(group.interface, backend.parameters(model))
    group[SOCKETS_KEY] = json.dumps(identifiers)
    outputs = {socket.identifier: socket for socket in entry.outputs}
    inputs = {name: outputs[identifier] for name, identifier in identifiers.items()}
    # The nodes of both backends; one set of nodes where the backend is the fallback itself.
    fallback = backends.FALLBACK
    stand_in = fallback.install(group, model, program if backend == fallback else fallback.blank(model), inputs)
    group.links.new(stand_in, end.inputs[STAND_IN])
    bsdf = stand_in if backend == fallback else backend.install(group, model, program, inputs)
    group.links.new(bsdf, end.inputs[BSDF])
    _add_text_sockets(group, backend.parameters(model))
    return group


def _add_text_sockets(group, parameters):
    """Add sockets for image paths inside the group, where the backend's nodes have none.

    Before Blender 5 a group itself cannot have text sockets, so a Script node without a script gets them.
    """
    existing = texts_of(group)
    missing = [p for p in parameters if p.kind == "image" and p.id not in existing]
    script = group.nodes.new("ShaderNodeScript") if missing else None
    for parameter in missing:
        script.inputs.new("NodeSocketString", parameter.label, identifier=parameter.id)


def _declare(interface, parameters) -> dict:
    """Make the group's sockets. Returns {parameter id: identifier of its socket}."""
    # Outputs.
    bsdf = interface.new_socket(BSDF, in_out="OUTPUT", socket_type="NodeSocketShader")
    bsdf.description = "For an output whose target is Cycles or All"
    other = interface.new_socket(STAND_IN, in_out="OUTPUT", socket_type="NodeSocketShader")
    other.description = "What looks alike in EEVEE, for an output whose target is EEVEE"
    # Inputs, first those outside panels.
    with_socket = [p for p in parameters if p.kind in KINDS]
    identifiers = {}
    for section in _OPEN:
        for parameter in with_socket:
            if parameter.section == section:
                identifiers[parameter.id] = _new_socket(interface, parameter, None)
    for section, closed in _PANELS.items():
        inside = [p for p in with_socket if p.section == section]
        panel = interface.new_panel(section, default_closed=closed) if inside else None
        for parameter in inside:
            identifiers[parameter.id] = _new_socket(interface, parameter, panel)
    return identifiers


def _new_socket(interface, parameter, panel):
    """Make the socket of a parameter, in a `panel` or outside (None). Returns the socket's identifier."""
    kind = kind_of(parameter)
    socket = interface.new_socket(parameter.label, in_out="INPUT", socket_type=kind, parent=panel)
    socket.description = parameter.help + "".join(f"; {i}: {item[1]}" for i, item in enumerate(parameter.items))
    if kind == "NodeSocketFloat":
        socket.subtype = subtype(parameter)
    if kind in ("NodeSocketFloat", "NodeSocketInt", "NodeSocketVector") and math.isfinite(parameter.maximum):
        number = int if kind == "NodeSocketInt" else float
        socket.min_value, socket.max_value = number(parameter.minimum), number(parameter.maximum)
    socket.default_value = stored(socket, parameter.default)
    # A zero vector means the surface's own normal or tangent; other values come by a link only.
    socket.hide_value = parameter.kind == "vector"
    return socket.identifier


def kind_of(parameter) -> str:
    """The type of a parameter's socket. A refractive index has three channels, but is a vector, not a color."""
    is_vector = parameter.kind == "color" and parameter.maximum > 1.0
    return "NodeSocketVector" if is_vector else KINDS[parameter.kind]


def subtype(parameter) -> str:
    """The subtype of a parameter's socket: a unit, "FACTOR" for a slider over a finite range, or "NONE"."""
    if parameter.unit in _SUBTYPES:
        return _SUBTYPES[parameter.unit]
    bounded = not parameter.logarithmic and math.isfinite(parameter.maximum)
    return "FACTOR" if bounded else "NONE"


# Finding.

def trees() -> list:
    """The editable node trees of this file that may contain Plausible nodes."""
    candidates = [m.node_tree for m in bpy.data.materials if m.node_tree is not None and m.is_editable]
    candidates += [tree for tree in bpy.data.node_groups if tree.is_editable and MODEL_KEY not in tree]
    return [tree for tree in candidates if tree.bl_idname == "ShaderNodeTree"]


def find_node(material):
    """The first Plausible node in a material, or None."""
    if material is None or material.node_tree is None:
        return None
    return next((node for node in material.node_tree.nodes if model_of(node) is not None), None)


def material_of(node):
    """The material whose tree contains a node; None for a node inside a group, which several materials may use."""
    return next((m for m in bpy.data.materials if m.node_tree == node.id_data), None)


def model_of(node):
    """The model of a node; None for nodes that are not Plausible nodes, and for unknown models."""
    group = getattr(node, "node_tree", None)
    return None if group is None else named_model(group)


def named_model(thing):
    """The model whose id is stored on a group, or on a Script node from before groups; None where it is unknown."""
    return models.MODELS.get(text_of(thing, MODEL_KEY))


def backend_of(node):
    """The backend that renders a Plausible node."""
    return backends.of_group(node.node_tree)


def socket_identifiers(group) -> dict:
    """{parameter id: identifier of its socket on the group}, as stored when the group was made."""
    try:
        identifiers = json.loads(text_of(group, SOCKETS_KEY))
    except ValueError:  # a group of version 0.2, whose sockets have the names of the parameters
        model = named_model(group)
        labels = {p.label: p.id for p in (model.parameters if model else ())}
        return {labels[item.name]: item.identifier for item in group.interface.items_tree
                if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name in labels}
    return identifiers if isinstance(identifiers, dict) else {}


def texts_of(group) -> dict:
    """{identifier: socket} of the text sockets inside a group: paths of images and of albedo tables."""
    return {socket.identifier: socket for node in group.nodes for socket in node.inputs if socket.type == "STRING"}


def lacking(group) -> list:
    """Names of a group's outputs that are missing or not linked."""
    linked = {socket.name for node in group.nodes if node.bl_idname == "NodeGroupOutput" for socket in node.inputs
           if socket.is_linked and socket.type == "SHADER"}
    return [name for name in (BSDF, STAND_IN) if name not in linked]


# Changing.

def load(node, values: dict | None = None, ranges: dict | None = None):
    """Make a new program for a node, for `values` and over `ranges`. Sockets and links stay.

    If the program is for the node's own values and other nodes use its group, the node gets a copy of the group.
    Raises as `Backend.program`, and ValueError where the group lacks the backend's nodes.
    """
    model, backend = model_of(node), backend_of(node)
    if backend.output(node.node_tree) is None:
        raise ValueError(f"{node.name} was edited and its shader is gone: Renew Node in the panel makes it whole")
    program = backend.program(model, values, ranges)
    if backend.installed(node.node_tree) != program:
        if not backend.follows_sockets(model):
            own(node)
        backend.update(node.node_tree, program)


def own(node):
    """Make a node the only user of its group: copies a group that other nodes use, or that another file owns."""
    group = node.node_tree
    if group.users - group.use_fake_user > 1 or not group.is_editable:
        node.node_tree = group.copy()


def switch_backend(node, backend):
    """Let `backend` feed a node's BSDF output. Sockets, values and links stay.

    A program for values stays where the group contains it already; otherwise it is blank at first, see `baked_state`.
    Raises as `Backend.program`, and ValueError where the group lacks its output, its input node or a socket.
    """
    model = model_of(node)
    program = backend.program(model) if backend.follows_sockets(model) else backend.blank(model)
    own(node)
    group = node.node_tree
    # The group's output and input nodes.
    end = next((n for n in group.nodes if n.bl_idname == "NodeGroupOutput" and BSDF in n.inputs), None)
    entry = next((n for n in group.nodes if n.bl_idname == "NodeGroupInput"), None)
    if end is None or entry is None:
        raise ValueError(f"{node.name} was edited and lacks {BSDF}: Renew Node in the panel makes it whole")
    # Add the backend's nodes where they are missing, with the text values that the group has.
    bsdf = backend.output(group)
    if bsdf is None:
        texts = {name: socket.default_value for name, socket in texts_of(group).items()}
        outputs = {socket.identifier: socket for socket in entry.outputs}
        identifiers = socket_identifiers(group)
        removed = [model.parameter(name).label for name in identifiers if identifiers[name] not in outputs]
        if removed:
            raise ValueError(f"{node.name} was edited and lacks {', '.join(removed)}: Renew Node in the panel makes it "
                             "whole")
        inputs = {name: outputs[identifier] for name, identifier in identifiers.items()}
        bsdf = backend.install(group, model, program, inputs)
        for socket in [s for node in group.nodes for s in node.inputs if s.type == "STRING" and s.identifier in texts]:
            socket.default_value = texts[socket.identifier]
    elif backend.follows_sockets(model):
        backend.update(group, program)
    group.links.new(bsdf, end.inputs[BSDF])
    group[backends.BACKEND_KEY] = backend.id
    backend.keep_options(group)
