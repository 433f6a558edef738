"""The node of a model: a group whose sockets are the model's parameters, whole in itself.

Inside are the nodes of two backends: the one that renders in Cycles, and the fallback for other engines. Models whose
program follows the sockets share one group among all their nodes; a group with a program for its values has one node.
"""
import json
import math

import bpy

from ... import models
from ...models.parameters import COLOR, GEOMETRY, LOBE, RETROREFLECTION, SAMPLING
from ...version import VERSION
from .. import backend as backends
from ..backend import BSDF, MODEL_KEY, STAND_IN, stored, text_of

VERSION_KEY = "plausible_version"  # of a group
SOCKETS_KEY = "plausible_sockets"  # of a group: {parameter: identifier of its socket}, as JSON
KINDS = {"float": "NodeSocketFloat", "int": "NodeSocketInt", "enum": "NodeSocketInt", "bool": "NodeSocketBool",
         "color": "NodeSocketColor", "vector": "NodeSocketVector"}
_SUBTYPES = {"rad": "ANGLE", "m": "DISTANCE"}
# Sockets of these sections stand by themselves, in this order; the others fold into panels below, some closed.
_OPEN, _PANELS = (LOBE, GEOMETRY), {RETROREFLECTION: True, COLOR: False, SAMPLING: True}


# Making.

def add_node(tree, model, backend=backends.DEFAULT, values: dict | None = None):
    """Add the node of a model to a node tree. Its sockets have the parameters' defaults.

    `values` by parameter id are what the program is made for, where it does not follow the sockets. Raises as
    `Backend.program`.
    """
    return add_program(tree, model, backend, backend.program(model, values))


def add_program(tree, model, backend, program):
    """Add the node of a model whose program is made already to a node tree."""
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = _shared(model, backend, program) or _new_group(model, backend, program)
    node.name = node.label = model.label
    node.width = 220.0
    return node


def _shared(model, backend, program):
    """A group of this file that holds the program already, and is as it was made: users may edit what they have.

    Groups whose program is for their own values, or names files, are not shared.
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
    """Whether each of the group's sockets is there, of its type, and feeds its parameter, and its outputs are fed."""
    kinds = {item.identifier: item.socket_type for item in group.interface.items_tree if item.item_type == "SOCKET"}
    identifiers = socket_identifiers(group)
    right = all(kinds.get(identifiers.get(p.id)) == kind_of(p) for p in backend.parameters(model) if p.kind in KINDS)
    return right and not backend.unfed(group, identifiers) and not lacking(group)


def _new_group(model, backend, program):
    group = bpy.data.node_groups.new(model.label, "ShaderNodeTree")
    group[MODEL_KEY], group[VERSION_KEY], group[backends.BACKEND_KEY] = model.id, VERSION, backend.id
    backend.keep_options(group)
    if hasattr(group, "description"):
        group.description = model.description
    entry, end = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    entry.location, end.location = (-900.0, 0.0), (500.0, 0.0)
    identifiers = _declare(group.interface, backend.parameters(model))
    group[SOCKETS_KEY] = json.dumps(identifiers)
    outputs = {socket.identifier: socket for socket in entry.outputs}
    inputs = {name: outputs[identifier] for name, identifier in identifiers.items()}
    fallback = backends.FALLBACK
    stand_in = fallback.install(group, model, program if backend == fallback else fallback.blank(model), inputs)
    group.links.new(stand_in, end.inputs[STAND_IN])
    shown = stand_in if backend == fallback else backend.install(group, model, program, inputs)
    group.links.new(shown, end.inputs[BSDF])
    _hold_texts(group, backend.parameters(model))
    return group


def _hold_texts(group, parameters):
    """Give texts a socket inside the group, where the backend's nodes have none: groups have none before Blender 5."""
    held = texts_of(group)
    lost = [p for p in parameters if p.kind == "image" and p.id not in held]
    holder = group.nodes.new("ShaderNodeScript") if lost else None
    for parameter in lost:
        holder.inputs.new("NodeSocketString", parameter.label, identifier=parameter.id)


def _declare(interface, parameters) -> dict:
    """Make the group's sockets; {parameter id: identifier of its socket}."""
    bsdf = interface.new_socket(BSDF, in_out="OUTPUT", socket_type="NodeSocketShader")
    bsdf.description = "For an output whose target is Cycles or All"
    other = interface.new_socket(STAND_IN, in_out="OUTPUT", socket_type="NodeSocketShader")
    other.description = "What looks alike in EEVEE, for an output whose target is EEVEE"
    held = [p for p in parameters if p.kind in KINDS]
    identifiers = {}
    for section in _OPEN:
        for parameter in held:
            if parameter.section == section:
                identifiers[parameter.id] = _new_socket(interface, parameter, None)
    for section, closed in _PANELS.items():
        inside = [p for p in held if p.section == section]
        panel = interface.new_panel(section, default_closed=closed) if inside else None
        for parameter in inside:
            identifiers[parameter.id] = _new_socket(interface, parameter, panel)
    return identifiers


def _new_socket(interface, parameter, panel):
    """Make the socket of a parameter; returns its identifier."""
    kind = kind_of(parameter)
    socket = interface.new_socket(parameter.label, in_out="INPUT", socket_type=kind, parent=panel)
    socket.description = parameter.help + "".join(f"; {i}: {item[1]}" for i, item in enumerate(parameter.items))
    if kind == "NodeSocketFloat":
        socket.subtype = subtype(parameter)
    if kind in ("NodeSocketFloat", "NodeSocketInt", "NodeSocketVector") and math.isfinite(parameter.maximum):
        whole = int if kind == "NodeSocketInt" else float
        socket.min_value, socket.max_value = whole(parameter.minimum), whole(parameter.maximum)
    socket.default_value = stored(socket, parameter.default)
    # A normal of zeros means the surface's own; it is linked or nothing.
    socket.hide_value = parameter.kind == "vector"
    return socket.identifier


def kind_of(parameter) -> str:
    """The type of a parameter's socket. Only reflectances are colors to look at; an index is three numbers."""
    triple = parameter.kind == "color" and parameter.maximum > 1.0
    return "NodeSocketVector" if triple else KINDS[parameter.kind]


def subtype(parameter) -> str:
    """How Blender shows the number of a parameter: with a unit, as a part of a range, or as it is."""
    if parameter.unit in _SUBTYPES:
        return _SUBTYPES[parameter.unit]
    bounded = not parameter.logarithmic and math.isfinite(parameter.maximum)
    return "FACTOR" if bounded else "NONE"


# Finding.

def trees() -> list:
    """The node trees of this file that can be edited and may hold nodes of ours."""
    found = [m.node_tree for m in bpy.data.materials if m.node_tree is not None and m.is_editable]
    found += [tree for tree in bpy.data.node_groups if tree.is_editable and MODEL_KEY not in tree]
    return [tree for tree in found if tree.bl_idname == "ShaderNodeTree"]


def find_node(material):
    """The node of ours in a material, or None."""
    if material is None or material.node_tree is None:
        return None
    return next((node for node in material.node_tree.nodes if model_of(node) is not None), None)


def material_of(node):
    """The material whose tree a node is in; None for one inside a group, which may be in several."""
    return next((m for m in bpy.data.materials if m.node_tree == node.id_data), None)


def model_of(node):
    """The model that a node is of, or None when it is not ours or of an unknown model."""
    group = getattr(node, "node_tree", None)
    return None if group is None else named_model(group)


def named_model(thing):
    """The model that a group, or a Script node of a version before groups, names; None where it names none."""
    return models.MODELS.get(text_of(thing, MODEL_KEY))


def backend_of(node):
    """The backend that renders a node of ours."""
    return backends.of_group(node.node_tree)


def socket_identifiers(group) -> dict:
    """{parameter id: identifier of its socket on the group}, as the group was made."""
    try:
        found = json.loads(text_of(group, SOCKETS_KEY))
    except ValueError:  # a group of version 0.2, whose sockets are called as the parameters
        model = named_model(group)
        labels = {p.label: p.id for p in (model.parameters if model else ())}
        return {labels[item.name]: item.identifier for item in group.interface.items_tree
                if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name in labels}
    return found if isinstance(found, dict) else {}


def texts_of(group) -> dict:
    """{identifier: socket} of the texts inside a group: images' paths, and files of tables."""
    return {socket.identifier: socket for node in group.nodes for socket in node.inputs if socket.type == "STRING"}


def lacking(group) -> list:
    """Labels of a group's outputs that are gone or fed by nothing."""
    fed = {socket.name for node in group.nodes if node.bl_idname == "NodeGroupOutput" for socket in node.inputs
           if socket.is_linked and socket.type == "SHADER"}
    return [name for name in (BSDF, STAND_IN) if name not in fed]


# Changing.

def load(node, values: dict | None = None, ranges: dict | None = None):
    """Put a fresh program into a node, for `values` and over `ranges`; sockets and links stay.

    A group that other nodes use, too, is left to them where the program is for the node's own values, and the node
    gets a copy. Raises as `Backend.program`, and ValueError where the group lacks the backend's nodes.
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
    """Have a node use its group alone: what belongs to other nodes or to another file is copied."""
    group = node.node_tree
    if group.users - group.use_fake_user > 1 or not group.is_editable:
        node.node_tree = group.copy()


def switch_backend(node, backend):
    """Have another backend feed a node's BSDF output; sockets, values and links stay.

    Its program is the one that the group has, or a blank one where programs are for values: see `baked_state`. Raises
    as `Backend.program`, and ValueError where the group lacks its output.
    """
    model = model_of(node)
    program = backend.program(model) if backend.follows_sockets(model) else backend.blank(model)
    own(node)
    group = node.node_tree
    end = next((each for each in group.nodes if each.bl_idname == "NodeGroupOutput" and BSDF in each.inputs), None)
    entry = next((each for each in group.nodes if each.bl_idname == "NodeGroupInput"), None)
    if end is None or entry is None:
        raise ValueError(f"{node.name} was edited and lacks {BSDF}: Renew Node in the panel makes it whole")
    shown = backend.output(group)
    if shown is None:
        texts = {name: socket.default_value for name, socket in texts_of(group).items()}
        outputs = {socket.identifier: socket for socket in entry.outputs}
        inputs = {name: outputs[each] for name, each in socket_identifiers(group).items() if each in outputs}
        shown = backend.install(group, model, program, inputs)
        for socket in [s for node in group.nodes for s in node.inputs if s.type == "STRING" and s.identifier in texts]:
            socket.default_value = texts[socket.identifier]
    elif backend.follows_sockets(model):
        backend.update(group, program)
    group.links.new(shown, end.inputs[BSDF])
    group[backends.BACKEND_KEY] = backend.id
    backend.keep_options(group)
