"""The material to measure: of a model, or of a .blend file, with its formula where that is known."""
from dataclasses import dataclass, field
from pathlib import Path

from ..models import MODELS
from .scene import MeasureError, quiet, require_blender


@dataclass(frozen=True)
class Specimen:
    """A `material` (bpy.types.Material) with its `title`, `model` and `parameters`.

    `model` is None where the reflectance has no formula.
    """

    title: str
    material: object
    model: object = None
    parameters: dict = field(default_factory=dict)

    def albedo(self, cos_theta):
        """The formula's albedo, (N,) or (N, 3), at N·V = `cos_theta` (N,)."""
        return self.model.albedo(cos_theta, **self.parameters)

    def evaluate(self, view, light):
        """The formula's f(V, L) in 1/sr, (N,) or (N, 3), for unit vectors (N, 3)."""
        return self.model.evaluate(view, light, **self.parameters)


def settings(model, assignments) -> dict:
    """Parses parameters of `model` from texts like "exponent=50", "fresnel_type=schlick", "base_color=0.9,0.6,0.2".

    Returns {parameter id: value}. Raises ValueError that names the text and the allowed values.
    """
    values = {}
    for text in assignments:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise ValueError(f"{text!r} is not of the form PARAMETER=VALUE")
        if name in values:
            raise ValueError(f"{name} is set twice")
        values[name] = model.parameter(name).check(_parsed(value))
    return values


def _parsed(text):
    """The text's value: a number, a bool, a tuple of numbers, or the text itself (a choice's name)."""
    words = {"true": True, "false": False}
    if text.lower() in words:
        return words[text.lower()]
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        return text
    return numbers if len(numbers) > 1 else numbers[0]


def of_model(model_id: str, assignments=()) -> Specimen:
    """Makes a material of the model `model_id` with the `assignments` of `settings`.

    Raises ValueError for a wrong model or parameter, MeasureError where the shader does not compile.
    """
    if model_id not in MODELS:
        raise ValueError(f"no model {model_id!r}; there are {', '.join(MODELS)}")
    model = MODELS[model_id]
    parameters = settings(model, assignments)
    model.resolve(parameters)
    require_blender()
    from .. import create_material

    with quiet():
        try:
            material = create_material(model_id, **parameters)
        except RuntimeError as error:  # the shader does not compile
            raise MeasureError(str(error)) from error
    title = ", ".join([model.label] + [text.replace("=", " = ") for text in assignments])
    return Specimen(title, material, model, parameters)


def of_file(path, name: str) -> Specimen:
    """Opens the .blend file `path`, replacing the open file, and returns its material `name`.

    The specimen has a formula where the material is one of ours and no parameter is linked. Raises OSError where the
    file is missing or not a .blend, ValueError where the file lacks the name or the material has lost its shader, and
    MeasureError where Blender is missing.
    """
    path = Path(path)
    if not path.is_file():
        raise OSError(f"no file {path}")
    bpy = require_blender()
    with quiet():
        try:
            bpy.ops.wm.open_mainfile(filepath=str(path.resolve()), load_ui=False, use_scripts=False)
        except RuntimeError as error:
            raise OSError(f"{path} cannot be opened: {str(error).strip()}") from error
    material = bpy.data.materials.get(name)
    if material is None:
        names = ", ".join(repr(m.name) for m in bpy.data.materials) or "none"
        raise ValueError(f"{path} has no material {name!r}; there are {names}")
    _require_shaders(path, material)
    model, parameters = _formula(material)
    return Specimen(f"{name} ({path.name})", material, model, parameters)


def _require_shaders(path, material):
    """Raises ValueError where a node of ours has lost its shader: Blender may crash when it renders such a node."""
    from ..blender.material import repair

    lost = [node.name for node in material.node_tree.nodes if repair.lost_shader(node)] if material.node_tree else []
    if lost:
        raise ValueError(f"{path}: material {material.name!r}: the shader of {', '.join(lost)} is gone or damaged; "
                         "open the file in Blender and press Renew Node in the panel")


def _formula(material):
    """Model and parameters of a material whose surface is a node of ours alone; None and {} for other materials."""
    from ..blender.material import groups, sockets

    node = groups.find_node(material)
    output = material.node_tree and material.node_tree.get_output_node("CYCLES")
    if node is None or output is None or any(socket.is_linked for socket in node.inputs):
        return None, {}
    links = output.inputs["Surface"].links
    if not links or links[0].from_node != node:
        return None, {}
    return groups.model_of(node), sockets.values(node)
