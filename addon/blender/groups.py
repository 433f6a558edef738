"""The node of a model: a group with the registry's parameters for sockets, whole in itself.

Inside are the Script node that renders in Cycles, with its bytecode, and a stand-in for other engines. Models that read
tables share one group among all their nodes; what is baked for its values has a group of its own.
"""
import hashlib
import math

import bpy

from .. import brdf
from ..brdf.parameters import COLOR, GEOMETRY, LOBE, RETROREFLECTION, SAMPLING
from ..shading import source
from ..version import VERSION
from . import osl, stand_in

MODEL_KEY, LUT_KEY, VERSION_KEY = "plausible_model", "plausible_lut", "plausible_version"  # of a group
SPANS_KEY = "plausible_spans"  # of a group: the exponents that the tables compiled into it are baked for
BSDF, STAND_IN = "BSDF", "Stand-in"  # outputs
_KINDS = {"float": "NodeSocketFloat", "int": "NodeSocketInt", "enum": "NodeSocketInt", "bool": "NodeSocketBool",
          "color": "NodeSocketColor", "vector": "NodeSocketVector"}
_SUBTYPES = {"rad": "ANGLE", "m": "DISTANCE"}
# Sockets of these sections stand by themselves, in this order; the others fold into panels below, some closed.
_OPEN, _PANELS = (LOBE, GEOMETRY), {RETROREFLECTION: True, COLOR: False, SAMPLING: True}


def add_node(tree, model, lut: str = source.COMPILED, parameters: dict | None = None):
    """Add the node of a model to a node tree; where the model is baked, for `parameters`.

    Its sockets have the parameters' defaults. Raises as `osl.compile_model`.
    """
    return add_compiled(tree, model, osl.compile_model(model, lut, parameters), lut)


def add_compiled(tree, model, bytecode: str, lut: str = source.COMPILED):
    """Add the node of a model whose shader is compiled already to a node tree."""
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = _shared(model, bytecode, lut) or _new_group(model, bytecode, lut)
    node.name = node.label = model.label
    node.width = 220.0
    return node


def model_of(node):
    """The model that a node is of, or None when it is not ours or of an unknown model."""
    tree = getattr(node, "node_tree", None)
    if tree is None or _script_in(tree) is None:
        return None
    return brdf.MODELS.get(tree.get(MODEL_KEY))


def script_of(node):
    """The Script node inside a node of ours."""
    return _script_in(node.node_tree)


def _script_in(tree):
    return next((n for n in tree.nodes if n.bl_idname == "ShaderNodeScript"), None)


def sockets(node) -> dict:
    """{parameter id: socket that holds its value} of a node of ours.

    A text has its socket on the Script node, as groups have none of that kind before Blender 5.
    """
    outside = {socket.identifier: socket for socket in node.inputs}
    found = {inside.identifier: _holder(inside, outside) for inside in script_of(node).inputs}
    return {name: holder for name, holder in found.items() if holder is not None}


def socket(node, name: str):
    """The one of `sockets` for a parameter, by id, or None: panels ask for each at every redraw."""
    inside = next((s for s in script_of(node).inputs if s.identifier == name), None)
    return None if inside is None else _holder(inside, {s.identifier: s for s in node.inputs})


def _holder(inside, outside):
    """The socket that feeds one of the Script node's, of those `outside`, by identifier; itself where none does."""
    return outside.get(inside.links[0].from_socket.identifier) if inside.is_linked else inside


def lut_of(node) -> str:
    """How a node reads its tables, see `source.assemble`."""
    return node.node_tree.get(LUT_KEY, source.COMPILED)


def load(node, parameters: dict | None = None):
    """Put freshly compiled bytecode into a node, for `parameters` where its model is baked; sockets and links stay.

    A group that other nodes use, too, is left to them, and the node gets a copy. Raises as `osl.compile_model`.
    """
    model = model_of(node)
    bytecode = osl.compile_model(model, lut_of(node), parameters)
    if script_of(node).bytecode != bytecode:
        if model.baked:
            own(node)
        osl.fill(script_of(node), bytecode)
    if model.tables:
        node.node_tree[SPANS_KEY] = source.spans(model)


def own(node):
    """Have a node use its group alone: what belongs to other nodes or to another file is copied."""
    tree = node.node_tree
    if tree.users - tree.use_fake_user > 1 or not tree.is_editable:
        node.node_tree = tree.copy()


def _shared(model, bytecode, lut):
    """A group of this file that holds the bytecode already, and has all its sockets: users may edit what they have.

    What is baked and what names files is not shared.
    """
    if model.baked or lut == source.FILE:
        return None
    digest = hashlib.md5(bytecode.encode()).hexdigest()
    labels = {p.label for p in model.parameters if p.kind in _KINDS}
    for tree in bpy.data.node_groups:
        if tree.get(MODEL_KEY) == model.id and tree.get(VERSION_KEY) == VERSION and tree.library is None:
            script, held = _script_in(tree), {item.name for item in tree.interface.items_tree}
            if script is not None and script.bytecode_hash == digest and labels <= held:
                return tree
    return None


def _new_group(model, bytecode, lut):
    tree = bpy.data.node_groups.new(model.label, "ShaderNodeTree")
    tree[MODEL_KEY], tree[LUT_KEY], tree[VERSION_KEY] = model.id, lut, VERSION
    tree[SPANS_KEY] = source.spans(model)
    if hasattr(tree, "description"):
        tree.description = model.description
    script = osl.add_script_node(tree, model, bytecode, lut)
    entry, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    entry.location, script.location, end.location = (-900.0, 0.0), (0.0, 300.0), (500.0, 0.0)
    identifiers = _declare(tree.interface, model)
    outputs = {s.identifier: s for s in entry.outputs}
    given = {name: outputs[identifier] for name, identifier in identifiers.items()}
    for inside in script.inputs:
        if inside.identifier in given:
            tree.links.new(given[inside.identifier], inside)
    tree.links.new(script.outputs[BSDF], end.inputs[BSDF])
    tree.links.new(stand_in.build(tree, model, given), end.inputs[STAND_IN])
    return tree


def _declare(interface, model) -> dict:
    """Make the group's sockets; {parameter id: identifier of its socket}."""
    bsdf = interface.new_socket(BSDF, in_out="OUTPUT", socket_type="NodeSocketShader")
    bsdf.description = "For an output whose target is Cycles or All"
    other = interface.new_socket(STAND_IN, in_out="OUTPUT", socket_type="NodeSocketShader")
    other.description = "What looks alike in EEVEE, for an output whose target is EEVEE"
    held = [p for p in model.parameters if p.kind in _KINDS]
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
    # Only reflectances are colours to look at; a refractive index is three numbers with a range.
    triple = parameter.kind == "color" and parameter.maximum > 1.0
    kind = "NodeSocketVector" if triple else _KINDS[parameter.kind]
    socket = interface.new_socket(parameter.label, in_out="INPUT", socket_type=kind, parent=panel)
    socket.description = parameter.help + "".join(f"; {i}: {item[1]}" for i, item in enumerate(parameter.items))
    if kind == "NodeSocketFloat":
        socket.subtype = subtype(parameter)
    if kind in ("NodeSocketFloat", "NodeSocketInt", "NodeSocketVector") and math.isfinite(parameter.maximum):
        whole = int if kind == "NodeSocketInt" else float
        socket.min_value, socket.max_value = whole(parameter.minimum), whole(parameter.maximum)
    socket.default_value = osl.stored(socket, parameter.default)
    # A normal of zeros means the surface's own; it is linked or nothing.
    socket.hide_value = parameter.kind == "vector"
    return socket.identifier


def subtype(parameter) -> str:
    """How Blender shows the number of a parameter: with a unit, as a part of a range, or as it is."""
    if parameter.unit in _SUBTYPES:
        return _SUBTYPES[parameter.unit]
    bounded = not parameter.logarithmic and math.isfinite(parameter.maximum)
    return "FACTOR" if bounded else "NONE"
