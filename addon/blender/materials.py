"""Materials: a Script node for Cycles, a Principled stand-in for EEVEE, and the viewport colour for Workbench."""
import json

import bpy

from .. import brdf
from ..baking import weights_error
from ..fitting import match
from ..shading import source
from . import osl

BAKED_KEY = "plausible_baked"  # the values that the weights of a baked model were made for
ERROR_KEY = "plausible_baked_error"  # of these weights: largest errors of the lobe and of the albedo up to 80 degrees
PAUSE = 0.3  # seconds that a value rests before its weights are baked
CYCLES_OUTPUT, STAND_IN, STAND_IN_OUTPUT = "Cycles Output", "Stand-in for EEVEE", "EEVEE Output"


def create_material(model_id: str, name: str | None = None, lut: str = source.COMPILED, **parameters):
    """A new material that renders `model_id` in Cycles as it stands, also after save, move and reload.

    `parameters` are the model's own, by socket identifier (see `brdf.MODELS[model_id].parameters`); `lut` is
    "compiled" (the albedo tables travel in the material) or "file" (they are read from their image files).
    OSL must be switched on in the scene that renders it: see `use_osl`.

    Raises ValueError for an unknown model or parameter and for a value out of range, brdf.TableError when an albedo
    table is missing, stale or damaged, osl.OslError when this Blender has no OSL.
    """
    model = brdf.find_model(model_id)
    model.resolve(parameters)
    osl.compile_model(model, lut, parameters)  # before anything is made: a failure leaves no half material behind
    material = bpy.data.materials.new(name or model.label)
    if material.node_tree is None:  # 5.x materials are born with one, and warn when asked for it
        material.use_nodes = True
    material.node_tree.nodes.clear()
    node = _build_tree(material.node_tree, model, lut, parameters)
    if "roughness" in parameters and any(p.id == "use_roughness" for p in model.parameters):
        parameters = {"use_roughness": True, **parameters}
    for key, value in parameters.items():
        _write(node, model.parameter(key), value)
    _note_values(node)
    update_stand_in(material)
    return material


def _build_tree(tree, model, lut, parameters):
    node = osl.add_script_node(tree, model, lut, parameters)
    node.location = (-260.0, 300.0)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.name = output.label = CYCLES_OUTPUT
    output.target, output.location = "CYCLES", (40.0, 300.0)
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    stand_in = tree.nodes.new("ShaderNodeBsdfPrincipled")
    stand_in.name = stand_in.label = STAND_IN
    stand_in.location = (-260.0, -180.0)
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    other.name = other.label = STAND_IN_OUTPUT
    other.target, other.location = "EEVEE", (40.0, -180.0)
    tree.links.new(stand_in.outputs["BSDF"], other.inputs["Surface"])
    return node


def script_node(material):
    """The Script node of ours in a material, or None."""
    if material is None or material.node_tree is None:
        return None
    for node in material.node_tree.nodes:
        if model_of(node) is not None:
            return node
    return None


def model_of(node):
    """The model that a node carries, or None when it is not ours or of an unknown model."""
    if node.bl_idname != "ShaderNodeScript":
        return None
    return brdf.MODELS.get(node.get(osl.MODEL_KEY))


def socket_of(node, parameter):
    """The socket of a parameter, or None where the node lacks it."""
    return next((s for s in node.inputs if s.identifier == parameter.id), None)


def get_value(node, parameter):
    """Value of a parameter as its socket holds it: a number, or a tuple of three."""
    value = socket_of(node, parameter).default_value
    return tuple(value)[:3] if parameter.kind in ("color", "vector") else value


def set_value(node, parameter, value):
    """Write a parameter's socket: see `set_values`."""
    set_values(node, {parameter: value})


def set_values(node, new: dict):
    """Write sockets, {parameter: value}, and bring stand-in and weights up to date.

    Weights are baked at once in background mode; in a window when values have rested for a moment, as dragging a slider
    writes many. Raises ValueError for a value out of range.
    """
    for parameter, value in new.items():
        _write(node, parameter, value)
    material = next((m for m in bpy.data.materials if m.node_tree == node.id_data), None)
    if material is not None:  # inside a group there is no one stand-in
        update_stand_in(material)
    if not is_stale(node):
        return
    if bpy.app.background or material is None:
        bake_weights(node)
    else:
        _bake_soon(material.name_full)


def is_stale(node) -> bool:
    """Whether a node's weights are for other values than its sockets hold, or for an image that has changed since.

    An image that is gone has not changed: the weights are all that is left of it.
    """
    if not model_of(node).baked:
        return False
    *then, files = json.loads(node.get(BAKED_KEY, "[null, {}]"))
    *now, files_now = json.loads(_values_text(node))
    return then != now or any(files.get(name, stamp) != stamp for name, stamp in files_now.items() if stamp)


def baked_error(node):
    """Largest errors (of the lobe, of the albedo) of a node's weights up to 80 degrees; None where none are known."""
    return tuple(node[ERROR_KEY]) if ERROR_KEY in node else None


def driven(node) -> list:
    """Labels of parameters that a link drives although the node's weights are for one value of each."""
    model = model_of(node)
    return [p.label for p in model.parameters if model.baked and p.evaluated and socket_of(node, p).is_linked]


def bake_weights(node):
    """Bake a node's weights for the values of its sockets. Raises ValueError, osl.OslError as `create_material`."""
    osl.load(node, model_of(node), node.get(osl.LUT_KEY, source.COMPILED), values(node))
    _note_values(node)


def _note_values(node):
    model = model_of(node)
    if model.baked:
        node[BAKED_KEY] = _values_text(node)
        node[ERROR_KEY] = weights_error.error(model, values(node)).largest()


def _values_text(node):
    given = values(node)
    stamps = {p.id: p.stamp(given[p.id]) for p in model_of(node).parameters if p.kind == "image"}
    return json.dumps([given, stamps])


_resting = {}  # material name -> the timer that waits for its values to rest


def _bake_soon(name):
    stop_waiting(name)

    def bake():
        _resting.pop(name, None)
        material = next((m for m in bpy.data.materials if m.name_full == name), None)
        node = script_node(material)
        if node is None or not is_stale(node):
            return
        try:
            bake_weights(node)
        except (RuntimeError, ValueError, OSError) as error:  # the weights stay stale, which the panel shows
            print(f"Plausible BRDF: {name}: {error}")

    _resting[name] = bake
    bpy.app.timers.register(bake, first_interval=PAUSE)


def stop_waiting(name: str | None = None):
    """Forget the bakes that wait for the values of a material, or of all, to rest."""
    for key in [name] if name else list(_resting):
        timer = _resting.pop(key, None)
        if timer is not None and bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)


def _write(node, parameter, value):
    value = parameter.check(value)
    socket_of(node, parameter).default_value = (*value, 1.0) if parameter.kind == "color" else value


def values(node) -> dict:
    """All values of a node that the formula takes, by parameter id, held to their ranges as the shader holds them.

    A socket takes any number in the node editor, so what it holds may be out of range.
    """
    return {p.id: p.clamp(get_value(node, p)) for p in model_of(node).parameters if p.evaluated}


def update_stand_in(material):
    """Give EEVEE's Principled stand-in and the viewport the look that comes nearest: a metal of this colour."""
    node = script_node(material)
    if node is None:
        return
    model = model_of(node)
    try:
        colour, exponent, metallic = model.stand_in(model.resolve(values(node)))
    except ValueError as error:  # an image that cannot be read: all stays as it was
        print(f"Plausible BRDF: {material.name}: {error}")
        return
    colour = [float(min(max(c, 0.0), 1.0)) for c in colour]
    # A half-vector power of n looks like a Beckmann lobe.
    roughness = brdf.roughness_of_exponent(exponent)
    principled = material.node_tree.nodes.get(STAND_IN)
    if principled is not None:
        principled.inputs["Base Color"].default_value = (*colour, 1.0)
        principled.inputs["Metallic"].default_value = metallic
        principled.inputs["Roughness"].default_value = roughness
    material.diffuse_color = (*colour, 1.0)
    material.metallic, material.roughness = metallic, roughness


def rebuild(material):
    """Compile a material's shader anew, with the tables of today; values and links stay."""
    bake_weights(_node_of(material))


def change_model(material, model_id: str, given: dict | None = None):
    """Turn a material into another model; the values and links of the parameters that both have stay.

    `given` are values, by id, to put in place of the old ones.
    """
    old = _node_of(material)
    tree, model = material.node_tree, brdf.find_model(model_id)
    both = [p for p in model.parameters if socket_of(old, p) is not None]
    kept = {p.id: p.clamp(get_value(old, p)) for p in both if p.evaluated}
    # What is baked is baked once, for the values that the node is going to have.
    new = osl.add_script_node(tree, model, old.get(osl.LUT_KEY, source.COMPILED), kept if given is None else given)
    new.location = old.location
    for parameter in both:
        source_socket = socket_of(old, parameter)
        socket_of(new, parameter).default_value = source_socket.default_value
        for link in list(source_socket.links):
            tree.links.new(link.from_socket, socket_of(new, parameter))
    for key, value in (given or {}).items():
        _write(new, model.parameter(key), value)
    for link in list(old.outputs["BSDF"].links):
        tree.links.new(new.outputs["BSDF"], link.to_socket)
    name = old.name
    tree.nodes.remove(old)
    new.name = name
    _note_values(new)
    update_stand_in(material)


def convert(material, model_id: str):
    """Turn a material into another model whose lobe is as wide as the old one's; returns the `match.Match`.

    Links stay as in `change_model`. What is baked is baked for the new values. Raises ValueError where there is no lobe
    to match.
    """
    node = _node_of(material)
    found = match.match(model_of(node).id, values(node), model_id, hold=True)
    change_model(material, model_id, found.parameters)
    return found


def unplugged(material, model_id: str) -> list:
    """Labels of the parameters with links that another model has no socket for."""
    node, there = _node_of(material), {p.id for p in brdf.MODELS[model_id].parameters}
    return [p.label for p in model_of(node).parameters if socket_of(node, p).is_linked and p.id not in there]


def _node_of(material):
    """The Script node of ours. Raises ValueError where there is none."""
    node = script_node(material)
    if node is None:
        raise ValueError(f"{material.name!r} has no Plausible BRDF node")
    return node


def apply_preset(material, preset):
    """Turn a material into a `brdf.presets.Preset`: its model, and every parameter that the formula takes."""
    given = {p.id: preset.parameters.get(p.id, p.default) for p in brdf.MODELS[preset.model].parameters if p.evaluated}
    node = script_node(material)
    if node is None or model_of(node).id != preset.model:
        change_model(material, preset.model, given)
    else:
        set_values(node, {model_of(node).parameter(key): value for key, value in given.items()})


def use_osl(scene) -> bool:
    """Switch Open Shading Language on in a scene; returns whether it had been off."""
    was_off = not scene.cycles.shading_system
    scene.cycles.shading_system = True
    return was_off
