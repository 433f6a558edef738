"""Materials: made, given values, turned into another model or a preset, and rendered by another backend."""
import bpy

from ... import brdf
from ...backends.nodes import fallback
from ...fitting import match
from .. import backend as backends
from . import baked_state, driven, groups, row_jobs
from .groups import find_node, model_of
from .sockets import by_id, carried, is_linked, require, values, write

CYCLES_OUTPUT, STAND_IN_OUTPUT = "Cycles Output", "EEVEE Output"


def create_material(model_id: str, name: str | None = None, lut: str = "compiled", backend: str = "osl", **parameters):
    """A new material that renders `model_id` in Cycles as it stands, also after save, move and reload.

    `parameters` are the model's own, by identifier (see `brdf.MODELS[model_id].parameters`). `backend` is "osl", which
    is exact and needs Open Shading Language switched on in the scene (see `backend.Backend.prepare`), or "principled",
    which is coarse and runs anywhere. `lut`, of OSL, is "compiled" (the albedo tables travel in the material) or "file"
    (they are read from their image files).

    Raises ValueError for an unknown model, backend or parameter and for a value out of range, brdf.TableError when an
    albedo table is missing, stale, damaged or not baked for this exponent, OslError when this Blender has no OSL.
    """
    model = brdf.find_model(model_id)
    resolved = model.resolve(parameters)
    renderer = backends.chosen(backend, **({"lut": lut} if backend == "osl" else {}))
    renderer.check(model, resolved)
    # Before anything is made: a failure leaves no half material behind.
    program = renderer.program(model, parameters)
    material = bpy.data.materials.new(name or model.label)
    if material.node_tree is None:  # 5.x materials are born with one, and warn when asked for it
        material.use_nodes = True
    material.node_tree.nodes.clear()
    node = _build_tree(material.node_tree, model, renderer, program)
    if "roughness" in parameters and any(p.id == "use_roughness" for p in model.parameters):
        parameters = {"use_roughness": True, **parameters}
    for parameter in renderer.parameters(model):
        if parameter.id in parameters:
            write(node, parameter, parameters[parameter.id])
    baked_state.record(node)
    update_viewport(material)
    return material


def _build_tree(tree, model, renderer, program):
    node = groups.add_program(tree, model, renderer, program)
    node.location = (-260.0, 300.0)
    for name, target, output, height in ((CYCLES_OUTPUT, "CYCLES", backends.BSDF, 300.0),
                                         (STAND_IN_OUTPUT, "EEVEE", backends.STAND_IN, 100.0)):
        end = tree.nodes.new("ShaderNodeOutputMaterial")
        end.name = end.label = name
        end.target, end.location = target, (40.0, height)
        tree.links.new(node.outputs[output], end.inputs["Surface"])
    return node


def set_value(node, parameter, value):
    """Write a parameter's socket: see `set_values`."""
    set_values(node, {parameter: value})


def set_values(node, new: dict):
    """Write sockets, {parameter: value}, and bring viewport and weights up to date.

    Weights are baked at once in background mode; in a window when values have rested for a moment, as dragging a slider
    writes many. Raises ValueError for a value out of range or a socket that is gone, before anything is written.
    """
    new = {parameter: parameter.check(value) for parameter, value in new.items()}
    require(node, new)
    for parameter, value in new.items():
        write(node, parameter, value)
    material = groups.material_of(node)
    if material is not None:
        update_viewport(material)
    row_jobs.where_stale(node)


def set_range(node, parameter, least: float, most: float):
    """Choose what a parameter is baked over where it is driven; the weights follow as in `set_values`.

    Raises ValueError for a range that is none.
    """
    driven.set_range(node, parameter, least, most)
    row_jobs.where_stale(node)


def update_viewport(material):
    """Give the solid view the look that comes nearest to a material's model."""
    node = find_node(material)
    if node is None:
        return
    try:
        colour, roughness, metallic = fallback.look(model_of(node), values(node))
    except ValueError as error:  # an image that cannot be read: all stays as it was
        print(f"Plausible BRDF: {material.name}: {error}")
        return
    look = (*colour, 1.0, metallic, roughness)
    now = (*material.diffuse_color, material.metallic, material.roughness)
    if any(abs(a - b) > 1e-6 for a, b in zip(look, now, strict=True)):  # writing wakes whoever watches materials
        material.diffuse_color = look[:4]
        material.metallic, material.roughness = metallic, roughness


def change_model(material, model_id: str, given: dict | None = None):
    """Turn a material into another model; the values and links of the parameters that both have stay.

    `given` are values, by id, to put in place of the old ones.
    """
    old, model = _node_of(material), brdf.find_model(model_id)
    before = by_id(old)
    # What is baked is baked once, for the values that the node is going to have, or over ranges of what drives it.
    wanted = carried(model, before) if given is None else given
    new = baked_state.take_over(old, before, model, wanted)
    for key, value in (given or {}).items():
        write(new, model.parameter(key), value)
    row_jobs.settle(new)
    update_viewport(material)


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
    return [p.label for p in model_of(node).parameters if is_linked(node, p) and p.id not in there]


def _node_of(material):
    """The node of ours. Raises ValueError where there is none."""
    node = find_node(material)
    if node is None:
        raise ValueError(f"{material.name!r} has no Plausible BRDF node")
    return node


def apply_preset(material, preset):
    """Turn a material into a `brdf.presets.Preset`: its model, and every parameter that the formula takes."""
    given = {p.id: preset.parameters.get(p.id, p.default) for p in brdf.MODELS[preset.model].parameters if p.evaluated}
    node = find_node(material)
    if node is None or model_of(node).id != preset.model:
        change_model(material, preset.model, given)
    else:
        set_values(node, {model_of(node).parameter(key): value for key, value in given.items()})


def switch_backend(node, backend):
    """Have another backend render a node; values, links and keyframes stay.

    A program that has to be made for the node's values is made at once where that takes no time, else as in
    `set_values`. Raises as `groups.switch_backend`.
    """
    groups.switch_backend(node, backend)
    if baked_state.is_stale(node) and backend.is_cached(model_of(node), *baked_state.target(node)):
        baked_state.bake(node)
    row_jobs.where_stale(node)
