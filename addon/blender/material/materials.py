"""Operations on materials: create, set values, convert to another model or preset, switch the backend."""
import bpy

from ... import brdf
from ...backends.nodes import fallback
from ...fitting import match
from .. import backend as backends
from . import baked_state, driven, groups, row_jobs
from .groups import find_node, model_of
from .sockets import by_id, carried, is_linked, require, values, write

# Names of the two material output nodes.
CYCLES_OUTPUT, STAND_IN_OUTPUT = "Cycles Output", "EEVEE Output"


def create_material(model_id: str, name: str | None = None, lut: str = "compiled", backend: str = "osl", **parameters):
    """A new material that renders the model `model_id` in Cycles. It still does after saving, moving and reloading.

    `parameters` are values of the model's parameters, by id (see `brdf.MODELS[model_id].parameters`). `backend` is
    "osl", which is exact and needs Open Shading Language switched on in the scene (see `backend.Backend.prepare`), or
    "principled", which is coarse and runs anywhere. `lut` is an option of "osl": "compiled" (the albedo tables are
    stored in the material) or "file" (the shader reads them from their image files).

    Raises ValueError for an unknown model, backend, option or parameter, or a value out of range, brdf.TableError if
    an albedo table is missing, outdated, damaged or not baked for the exponent, OslError if this Blender has no OSL.
    """
    # Check the values for this model and backend.
    model = brdf.find_model(model_id)
    resolved = model.resolve(parameters)
    renderer = backends.chosen(backend, **({} if lut == "compiled" else {"lut": lut}))
    renderer.check(model, resolved)
    # The program comes first, so that a failure leaves no incomplete material.
    program = renderer.program(model, parameters)
    material = bpy.data.materials.new(name or model.label)
    if material.node_tree is None:  # Blender 5 makes the tree at once, and warns of `use_nodes`
        material.use_nodes = True
    material.node_tree.nodes.clear()
    node = _build_tree(material.node_tree, model, renderer, program)
    # Write the sockets. A roughness implies that the width comes from it.
    if "roughness" in parameters and any(p.id == "use_roughness" for p in model.parameters):
        parameters = {"use_roughness": True, **parameters}
    for parameter in renderer.parameters(model):
        if parameter.id in parameters:
            write(node, parameter, parameters[parameter.id])
    baked_state.record(node)
    update_viewport(material)
    return material


def _build_tree(tree, model, renderer, program):
    """Fill an empty material tree: the node, and the outputs for Cycles and for EEVEE. Returns the node."""
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
    """Write sockets, {parameter: value}, and update the viewport look and the lobe rows.

    In background mode lobe rows are baked at once. In a window the bake waits for a pause of `row_jobs.REST` seconds in
    the changes, as dragging a slider writes many values. Raises ValueError for a value out of range and for a missing
    socket, before any write.
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
    """Set the range of a driven parameter. The lobe rows are baked anew as in `set_values`.

    Raises ValueError for an invalid range.
    """
    driven.set_range(node, parameter, least, most)
    row_jobs.where_stale(node)


def update_viewport(material):
    """Set a material's color, metallic and roughness for the solid viewport to the nearest look of its model."""
    node = find_node(material)
    if node is None:
        return
    try:
        color, roughness, metallic = fallback.look(model_of(node), values(node))
    except ValueError as error:  # an image that cannot be read: the look stays as it is
        print(f"Plausible BRDF: {material.name}: {error}")
        return
    look = (*color, 1.0, metallic, roughness)
    now = (*material.diffuse_color, material.metallic, material.roughness)
    # Equal values are not written, as each write triggers the handlers that watch materials.
    if any(abs(a - b) > 1e-6 for a, b in zip(look, now, strict=True)):
        material.diffuse_color = look[:4]
        material.metallic, material.roughness = metallic, roughness


def change_model(material, model_id: str, given: dict | None = None):
    """Change a material's model. The values and links of parameters that both models have stay.

    `given` are values, by parameter id, that replace the old ones. Raises ValueError for an unknown model and for a
    material without a Plausible node.
    """
    old, model = _node_of(material), brdf.find_model(model_id)
    before = by_id(old)
    # Lobe rows are baked once: for the final values, or over the ranges of driven parameters.
    final = carried(model, before) if given is None else given
    new = baked_state.take_over(old, before, model, final)
    for key, value in (given or {}).items():
        write(new, model.parameter(key), value)
    row_jobs.settle(new)
    update_viewport(material)


def convert(material, model_id: str):
    """Change a material's model and keep the width of its lobe. Returns the `match.Match`.

    Links stay as in `change_model`. Lobe rows are baked for the new values. Raises ValueError where no lobe can be
    matched.
    """
    node = _node_of(material)
    matched = match.match(model_of(node).id, values(node), model_id, hold=True)
    change_model(material, model_id, matched.parameters)
    return matched


def unplugged(material, model_id: str) -> list:
    """Labels of the linked parameters that the model `model_id` lacks."""
    node, target_ids = _node_of(material), {p.id for p in brdf.MODELS[model_id].parameters}
    return [p.label for p in model_of(node).parameters if is_linked(node, p) and p.id not in target_ids]


def _node_of(material):
    """The Plausible node of a material. Raises ValueError where there is none."""
    node = find_node(material)
    if node is None:
        raise ValueError(f"{material.name!r} has no Plausible BRDF node")
    return node


def apply_preset(material, preset):
    """Apply a `library.presets.Preset` to a material: its model, and all parameters of the formula.

    Parameters that the preset does not set get their defaults.
    """
    new = {p.id: preset.parameters.get(p.id, p.default) for p in brdf.MODELS[preset.model].parameters if p.evaluated}
    node = find_node(material)
    if node is None or model_of(node).id != preset.model:
        change_model(material, preset.model, new)
    else:
        set_values(node, {model_of(node).parameter(key): value for key, value in new.items()})


def switch_backend(node, backend):
    """Let `backend` render a node. Values, links and keyframes stay.

    A program for values is made at once if it is cached, else as in `set_values`. Raises as `groups.switch_backend`.
    """
    groups.switch_backend(node, backend)
    if baked_state.is_stale(node) and backend.is_cached(model_of(node), *baked_state.target(node)):
        baked_state.bake(node)
    row_jobs.where_stale(node)
