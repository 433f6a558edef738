"""The fallback backend: Principled BSDFs inside the group. It is coarse, and runs on any device and in any engine.

Where a model's program follows its sockets, nodes compute the Principled BSDF's inputs from the same sockets, so that
textures, drivers and keyframes take effect. For other models the inputs are fitted for fixed values.
"""
import json
from dataclasses import dataclass

from ...backends.nodes import fallback, principled_fit
from ...models.disk_model import DiskModel
from ...models.formula_model import FormulaModel
from ..host.translation import tr
from .node_builder import Nodes
from .protocol import MODEL_KEY, STAND_IN, Cure, Notice, Program, refuse_options, text_of

# Name of the Principled BSDF node.
NAME = STAND_IN
_PRINCIPLED = "ShaderNodeBsdfPrincipled"
# Custom property of a group: the fitted inputs, as JSON.
_PROGRAM_KEY = "plausible_fallback"
# Parameters that the formula does not read and the nodes do.
_OWN = {"shading_normal"}


@dataclass(frozen=True)
class PrincipledFit:
    """See `protocol.Backend`."""

    id = "principled"
    label = "Native Approximation"

    def with_options(self, **others) -> "PrincipledFit":
        """See `Backend`: it has none."""
        refuse_options(self, others)
        return self

    def as_kept(self, group) -> "PrincipledFit":
        """See `Backend`."""
        return self

    def keep_options(self, group):
        """See `Backend`."""

    def why_not(self, scene=None) -> tuple:
        """See `Backend`: no obstacles, it renders everywhere."""
        return ()

    def is_ready(self, scene) -> bool:
        """See `Backend`."""
        return True

    def prepare(self, scene) -> bool:
        """See `Backend`."""
        return False

    def notices(self, node, model, values) -> tuple:
        """See `Backend`: the difference from the model, in percent."""
        try:
            lobe, albedo = fallback.error(model, values)
        except ValueError:  # an image that cannot be read
            text = tr("Cycles renders the native approximation in place of the model")
        else:
            text = tr("Cycles renders the native approximation in place of the model. Its lobe differs by {lobe:.2g} "
                       "%, its albedo by {albedo:.2g} %", lobe=lobe, albedo=albedo)
        return (Notice(text, (Cure("plausible.switch_native", "Render the Model"),), "INFO"),)

    def parameters(self, model) -> tuple:
        """See `Backend`."""
        return tuple(p for p in model.parameters if p.evaluated or p.id in _OWN)

    def follows_sockets(self, model) -> bool:
        """See `Backend`."""
        return not isinstance(model, FormulaModel)

    def can_share(self, model) -> bool:
        """See `Backend`."""
        return self.follows_sockets(model)

    def check(self, model, values):
        """See `Backend`. All values are valid."""

    def program(self, model, values=None, ranges=None) -> Program:
        """See `Backend`. `ranges` is not used: a driven parameter enters with its socket's value."""
        if self.follows_sockets(model):
            return Program(self.id, model.id, "")
        evaluated = {p.id: p.default for p in model.parameters if p.evaluated} | (values or {})
        ((_, fitted),) = fallback.parts(model, evaluated)
        return Program(self.id, model.id, json.dumps({
            "Base Color": (*fitted.base_color, 1.0), "Metallic": fitted.metallic, "Roughness": fitted.roughness,
            "IOR": fitted.ior, "Specular IOR Level": fitted.specular, "Anisotropic": fitted.anisotropic,
            "Anisotropic Rotation": fitted.rotation}))

    def blank(self, model) -> Program:
        """See `Backend`: a rough white metal."""
        return Program(self.id, model.id, "{}")

    def is_cached(self, model, values, ranges) -> bool:
        """See `Backend`: a fit takes a fraction of a second."""
        return True

    def prefetch(self, model, values, ranges, tell):
        """See `Backend`: there is no slow part."""

    def error(self, model, values, ranges) -> tuple | None:
        """See `Backend`: none, as `notices` states the difference from the model."""
        return None

    def install(self, group, model, program, inputs):
        """See `Backend`."""
        nodes = Nodes(group)
        # One metallic node; a program with fitted inputs is complete with it.
        normal = nodes.normal(inputs["shading_normal"])
        node = nodes.principled(NAME, normal, metallic=1.0)
        self.update(group, program)
        if not self.follows_sockets(model):
            return node.outputs[0]
        exponent = (_lump_exponent if isinstance(model, DiskModel) else _lobe_exponent)(nodes, model, inputs)
        # A half-vector power m is nearly a microfacet lobe with m = 2/alpha² - 2 and alpha = roughness².
        roughness = nodes.math("POWER", nodes.math("DIVIDE", 2.0, nodes.math("ADD", exponent, 2.0)), 0.25)
        nodes.feed(node, "Roughness", nodes.math("MULTIPLY", roughness, principled_fit.ROUGHNESS_FACTORS[model.id]))
        # The color, and under it the diffuse part of models that have one.
        if "diffuse_color" in inputs:
            return _over_diffuse(nodes, inputs, node, normal)
        nodes.feed(node, "Base Color", _color(nodes, inputs))
        return node.outputs[0]

    def update(self, group, program):
        """See `Backend`."""
        group[_PROGRAM_KEY] = program.content
        node = group.nodes.get(NAME)
        if node is not None and node.bl_idname == _PRINCIPLED:  # a user may have put another node under this name
            for name, value in json.loads(program.content or "{}").items():
                node.inputs[name].default_value = value

    def output(self, group):
        """See `Backend`: the socket that is linked to the group's second output."""
        end = next((node for node in group.nodes if node.bl_idname == "NodeGroupOutput"), None)
        socket = end and end.inputs.get(STAND_IN)
        return socket.links[0].from_socket if socket and socket.is_linked else None

    def installed(self, group) -> Program | None:
        """See `Backend`."""
        if self.output(group) is None:
            return None
        return Program(self.id, text_of(group, MODEL_KEY), text_of(group, _PROGRAM_KEY))

    def unfed(self, group, fed_by) -> list:
        """See `Backend`: none, as the nodes work with any links."""
        return []


def _lobe_exponent(nodes, model, inputs):
    """Exponent of the half-vector power that is as wide as the lobe, from its exponent or its roughness.

    Roughness r gives the exponent 2/alpha² - 2 with alpha = r².
    """
    alpha = nodes.math("POWER", nodes.math("MAXIMUM", inputs["roughness"], 1e-2), 2.0)
    by_roughness = nodes.math("SUBTRACT", nodes.math("DIVIDE", 2.0, nodes.math("MULTIPLY", alpha, alpha)), 2.0)
    exponent = nodes.blend(inputs["use_roughness"], inputs["exponent"], nodes.math("MAXIMUM", by_roughness, 1.0))
    return nodes.math("MULTIPLY", exponent, float(model.lobe.half_vector_exponent(1.0)))


def _lump_exponent(nodes, model, inputs):
    """The half-vector power 2n/R² that is as wide at normal incidence as a lump of exponent n and radius R."""
    rule = model.lumps[0]
    radius = inputs[rule.radii[0]]
    for name in rule.radii[1:]:
        radius = nodes.math("MAXIMUM", radius, inputs[name])
    square = nodes.math("MULTIPLY", nodes.math("MINIMUM", radius, 1.0), radius)
    return nodes.math("DIVIDE", nodes.math("MULTIPLY", inputs[rule.exponent], 2.0), square)


def _color(nodes, inputs):
    """Reflectance at normal incidence: the color, or ((n-1)² + k²) / ((n+1)² + k²) for a conductor."""
    if "fresnel_type" not in inputs:
        return inputs["base_color"]
    n, k = inputs["ior"], inputs["extinction"]
    squares = nodes.vector("MULTIPLY", k, k)
    less, more = (nodes.vector("ADD", n, (side, side, side)) for side in (-1.0, 1.0))
    metal = nodes.vector("DIVIDE", nodes.vector("MULTIPLY_ADD", less, less, squares),
                         nodes.vector("MULTIPLY_ADD", more, more, squares))
    # The choice "conductor" is 2.
    return nodes.blend_vector(nodes.math("GREATER_THAN", inputs["fresnel_type"], 1.5), inputs["base_color"], metal)


def _over_diffuse(nodes, inputs, lobe, normal):
    """The shader (1-F) diffuse + F specular.

    F is Schlick's Fresnel factor of the brightest channel. The color of the specular lobe is scaled to a brightest
    channel of 1.
    """
    # Scale the lobe's color.
    channels = nodes.split(inputs["base_color"])
    brightest = nodes.math("MAXIMUM", nodes.math("MAXIMUM", channels[0], channels[1]), channels[2])
    inverse = nodes.math("DIVIDE", 1.0, nodes.math("MAXIMUM", brightest, 1e-6))
    nodes.feed(lobe, "Base Color", nodes.vector("SCALE", inputs["base_color"], scale=inverse))
    # Schlick's factor of the view. With a blend of 0.5 the output Facing is 1 - N·V.
    facing = nodes.new("ShaderNodeLayerWeight")
    facing.inputs["Blend"].default_value = 0.5
    nodes.link(normal, facing.inputs["Normal"])
    grazing = nodes.math("POWER", facing.outputs["Facing"], 5.0)
    factor = nodes.blend(grazing, brightest, 1.0)
    # The diffuse part, mixed with the lobe.
    diffuse = nodes.principled(f"{NAME}, Diffuse", normal, metallic=0.0)
    diffuse.inputs["Roughness"].default_value = 1.0
    diffuse.inputs["Specular IOR Level"].default_value = 0.0
    nodes.feed(diffuse, "Base Color", inputs["diffuse_color"])
    mix = nodes.new("ShaderNodeMixShader")
    for socket, source in zip(mix.inputs, (factor, diffuse.outputs[0], lobe.outputs[0]), strict=True):
        nodes.link(source, socket)
    return mix.outputs[0]
