"""The node of a model: a group with the registry's parameters for sockets, whole in itself.

Inside are the Script node that renders in Cycles, with its bytecode, and a stand-in for other engines. Models that read
tables share one group among all their nodes; what is baked for its values has a group of its own.
"""
import math
from pathlib import Path

import bpy

from .. import brdf
from ..brdf.parameters import COLOR, GEOMETRY, LOBE, RETROREFLECTION, SAMPLING
from ..shading import source
from ..version import VERSION
from . import osl, stand_in

MODEL_KEY, LUT_KEY, VERSION_KEY = "plausible_model", "plausible_lut", "plausible_version"  # of a group
SPANS_KEY = "plausible_spans"  # of a group: the exponents that the tables compiled into it are baked for
RANGES_KEY = "plausible_ranges"  # of a group: {parameter: [least, most]} that driven ones stay within, as JSON
MOVED_KEY = "plausible_moved"  # of a node: where its shader went before the native approximation took its place
BSDF, STAND_IN = "BSDF", "Stand-in"  # outputs
_KINDS = {"float": "NodeSocketFloat", "int": "NodeSocketInt", "enum": "NodeSocketInt", "bool": "NodeSocketBool",
          "color": "NodeSocketColor", "vector": "NodeSocketVector"}
_SUBTYPES = {"rad": "ANGLE", "m": "DISTANCE"}
# Types of sockets that can hold a parameter's value: whoever edits a group may give a socket another.
_TYPES = {"float": {"VALUE"}, "int": {"INT"}, "enum": {"INT"}, "bool": {"BOOLEAN", "INT"}, "color": {"RGBA", "VECTOR"},
          "vector": {"VECTOR"}, "image": {"STRING"}}
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
    return None if tree is None or _script_in(tree) is None else named_model(tree)


def named_model(thing):
    """The model that a group, or a Script node of a version before groups, says it is of; None where it names none."""
    return brdf.MODELS.get(text_of(thing, MODEL_KEY))


def text_of(thing, key: str) -> str:
    """A custom property as text, "" where there is none: users may write there what they like."""
    value = thing.get(key)
    return value if isinstance(value, str) else ""


def script_of(node):
    """The Script node inside a node of ours."""
    return _script_in(node.node_tree)


def has_bytecode(node) -> bool:
    """Whether a node of ours has a shader that Cycles can read, as far as its beginning tells."""
    return script_of(node).mode == "INTERNAL" and script_of(node).bytecode.startswith("OpenShadingLanguage")


def _script_in(tree):
    return next((n for n in tree.nodes if n.bl_idname == "ShaderNodeScript"), None)


def sockets(node) -> dict:
    """{parameter id: socket that holds its value} of a node of ours.

    A text has its socket on the Script node, as groups have none of that kind before Blender 5. In a group that was
    edited a parameter may have no socket, or one that cannot hold its value, which counts for none.
    """
    outside = {socket.identifier: socket for socket in node.inputs}
    found = {inside.identifier: _holder(inside, outside) for inside in script_of(node).inputs}
    return fitting(model_of(node), found)


def fitting(model, found: dict) -> dict:
    """Those of the sockets `found`, by parameter id, that can hold their parameters' values."""
    declared = {p.id: p for p in model.parameters}
    return {name: socket for name, socket in found.items() if socket is not None and _fits(socket, declared.get(name))}


def _fits(socket, parameter):
    """Whether a socket can hold a parameter's value; the path of a table is no parameter."""
    return socket.type in (_TYPES[parameter.kind] if parameter else {"STRING"})


def socket(node, parameter):
    """The one of `sockets` for a parameter, or None: panels ask for each at every redraw."""
    inside = next((s for s in script_of(node).inputs if s.identifier == parameter.id), None)
    found = None if inside is None else _holder(inside, {s.identifier: s for s in node.inputs})
    return found if found is not None and _fits(found, parameter) else None


def _holder(inside, outside):
    """The socket that feeds one of the Script node's, of those `outside`, by identifier; itself where none does."""
    return outside.get(_entry_of(inside)) if inside.is_linked else inside


def _entry_of(inside):
    """The identifier of the group's socket that feeds one inside; None where something else does."""
    link = inside.links[0] if inside.is_linked else None
    return link.from_socket.identifier if link and link.from_node.bl_idname == "NodeGroupInput" else None


def lut_of(thing) -> str:
    """How a group, or a Script node before groups, reads its tables, see `source.assemble`."""
    return source.FILE if text_of(thing, LUT_KEY) == source.FILE else source.COMPILED


def table_files(node) -> dict:
    """{table: path} of the files that a node's shader reads its tables from; {} of one that has them compiled in."""
    modes = {f"table_{source.mode_of(source.tables.TABLES[name])}": name for name in model_of(node).tables}
    return {modes[s.identifier]: Path(bpy.path.abspath(s.default_value)) for s in script_of(node).inputs
            if s.identifier in modes and s.type == "STRING"}


def spans_of(node) -> dict:
    """{table: (least, largest) exponent} that the tables compiled into a node are baked for, as far as it is known."""
    known = node.node_tree.get(SPANS_KEY)
    pairs = {name: pair_of(span) for name, span in known.items()} if hasattr(known, "items") else {}
    return {name: pair for name, pair in pairs.items() if pair is not None}


def pair_of(value):
    """Two numbers out of a custom property; None where it holds something else."""
    numbers = tuple(value) if hasattr(value, "__len__") else ()
    return numbers if len(numbers) == 2 and all(isinstance(n, int | float) for n in numbers) else None


def lacking(tree) -> list:
    """Labels of a group's outputs that are gone or fed by nothing."""
    fed = {socket.name for node in tree.nodes if node.bl_idname == "NodeGroupOutput" for socket in node.inputs
           if socket.is_linked and socket.type == "SHADER"}
    return [name for name in (BSDF, STAND_IN) if name not in fed]


def load(node, parameters: dict | None = None, driven: dict | None = None):
    """Put freshly compiled bytecode into a node; sockets and links stay.

    Where its model is baked it is so for `parameters`, and for the ranges of those `driven`.

    A group that other nodes use, too, is left to them, and the node gets a copy. Raises as `osl.compile_model`.
    """
    model = model_of(node)
    bytecode = osl.compile_model(model, lut_of(node.node_tree), parameters, driven)
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
    """A group of this file that holds the bytecode already, and is as it was made: users may edit what they have.

    What is baked and what names files is not shared.
    """
    if model.baked or lut == source.FILE:
        return None
    for tree in bpy.data.node_groups:
        if named_model(tree) == model and text_of(tree, VERSION_KEY) == VERSION and tree.library is None:
            script = _script_in(tree)
            if script is not None and script.bytecode == bytecode and _is_untouched(tree, script, model):
                return tree
    return None


def _is_untouched(tree, script, model):
    """Whether each of the group's sockets is there, of its type, and feeds its parameter, and its outputs are fed."""
    entries = {item.identifier: item.socket_type for item in tree.interface.items_tree if item.item_type == "SOCKET"}
    feeds = {inside.identifier: entries.get(_entry_of(inside)) for inside in script.inputs}
    right = all(feeds.get(p.id) == _kind(p) for p in model.parameters if p.kind in _KINDS)
    return right and not lacking(tree)


def _kind(parameter):
    """The type of a parameter's socket. Only reflectances are colours to look at; an index is three numbers."""
    triple = parameter.kind == "color" and parameter.maximum > 1.0
    return "NodeSocketVector" if triple else _KINDS[parameter.kind]


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
    kind = _kind(parameter)
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
