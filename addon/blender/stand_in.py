"""What stands in for a model in other engines: Principled nodes inside the model's group.

Where a model's parameters can be driven by links, nodes compute the stand-in from the same sockets, so that textures,
drivers and keyframes show; what is baked for its values has a stand-in for these values (`write`).
"""
import json
from functools import lru_cache

import numpy as np

from .. import brdf
from ..brdf.disk_model import DiskModel
from ..brdf.registry import Model
from ..fitting import principled
from ..fitting.principled_bsdf import Inputs

NAME = "Stand-in"
_PRINCIPLED = "ShaderNodeBsdfPrincipled"


def build(tree, model, given: dict):
    """Make the stand-in of `model` out of the group's inputs, {parameter id: socket}; returns its shader socket."""
    nodes = _Nodes(tree)
    normal = nodes.normal(given["shading_normal"])
    node = nodes.principled(NAME, normal, metallic=1.0)
    if model.baked:
        return node.outputs[0]
    exponent = _lump_exponent(nodes, model, given) if isinstance(model, DiskModel) else _exponent(nodes, model, given)
    # A half-vector power of m looks like a microfacet lobe with m = 2/alpha² - 2 and alpha = roughness², nearly.
    roughness = nodes.math("POWER", nodes.math("DIVIDE", 2.0, nodes.math("ADD", exponent, 2.0)), 0.25)
    nodes.feed(node, "Roughness", nodes.math("MULTIPLY", roughness, principled.ROUGHNESS_FACTORS[model.id]))
    if "diffuse_color" not in given:
        nodes.feed(node, "Base Color", _colour(nodes, given))
        return node.outputs[0]
    return _over_diffuse(nodes, given, node, normal)


def write(node, model: Model, values: dict):
    """Set the stand-in inside the node of a baked model to what looks like `values`.

    Raises ValueError for an image that cannot be read.
    """
    inside = node.node_tree.nodes.get(NAME)
    (_, fitted), = parts(model, values)
    if inside is not None and inside.bl_idname == _PRINCIPLED:  # not one that a user made
        for name, value in {"Base Color": (*fitted.base_color, 1.0), "Metallic": fitted.metallic,
                            "Roughness": fitted.roughness, "IOR": fitted.ior, "Specular IOR Level": fitted.specular,
                            "Anisotropic": fitted.anisotropic, "Anisotropic Rotation": fitted.rotation}.items():
            inside.inputs[name].default_value = value


def look(model: Model, values: dict):
    """(colour, roughness, metallic) of what looks like a model with `values`. Raises as `write`."""
    shown = parts(model, values)
    most = max(shown, key=lambda part: part[0](np.ones(1))[0])[1]
    return most.base_color, most.roughness, most.metallic


def parts(model: Model, values: dict) -> list:
    """What the nodes of a model with `values` amount to: [(share, inputs)], see `principled.errors`.

    The last few are kept. Raises as `write`.
    """
    return _parts(model, json.dumps(values, sort_keys=True), _stamps(model, values))


def error(model: Model, values: dict) -> tuple:
    """What the stand-in errs by, (of the lobe, of the albedo) in % of the model's light. Raises as `write`."""
    return _error(model, json.dumps(values, sort_keys=True), _stamps(model, values))


def _stamps(model, values):
    return tuple(p.stamp(values[p.id]) for p in model.parameters if p.id in values)


@lru_cache(maxsize=64)
def _parts(model, text, _):
    values = model.resolve({key: tuple(value) if isinstance(value, list) else value
                            for key, value in json.loads(text).items()})
    if model.baked:
        return [(np.ones_like, principled.fit(model, _evaluated(model, values)))]
    colour, exponent, _ = model.stand_in(values)
    if "diffuse_color" in values:
        colour = np.asarray(values["base_color"])
    colour = np.clip(colour, 0.0, 1.0)
    roughness = brdf.roughness_of_exponent(exponent) * principled.ROUGHNESS_FACTORS[model.id]
    if "diffuse_color" not in values:
        return [(np.ones_like, Inputs(tuple(colour.tolist()), 1.0, roughness))]
    brightest = float(colour.max())

    def factor(mu):
        return brightest + (1.0 - brightest) * (1.0 - mu) ** 5

    lobe = Inputs(tuple((colour / max(brightest, 1e-6)).tolist()), 1.0, roughness)
    body = Inputs(tuple(values["diffuse_color"]), 0.0, 1.0, specular=0.0)
    return [(factor, lobe), (lambda mu: 1.0 - factor(mu), body)]


@lru_cache(maxsize=64)
def _error(model, text, stamps):
    return principled.errors(model, json.loads(text), _parts(model, text, stamps))


def _evaluated(model, values):
    return {p.id: values[p.id] for p in model.parameters if p.evaluated}


def _exponent(nodes, model, given):
    """Exponent of the half-vector power that is as wide as the lobe, from its exponent or its roughness."""
    alpha = nodes.math("POWER", nodes.math("MAXIMUM", given["roughness"], 1e-2), 2.0)
    by_roughness = nodes.math("SUBTRACT", nodes.math("DIVIDE", 2.0, nodes.math("MULTIPLY", alpha, alpha)), 2.0)
    chosen = nodes.blend(given["use_roughness"], given["exponent"], nodes.math("MAXIMUM", by_roughness, 1.0))
    return nodes.math("MULTIPLY", chosen, float(model.lobe.half_vector_exponent(1.0)))


def _lump_exponent(nodes, model, given):
    """A lump of n and radius R is as wide as a half-vector power of 2n/R² at normal incidence."""
    rule = model.lumps[0]
    radius = given[rule.radii[0]]
    for name in rule.radii[1:]:
        radius = nodes.math("MAXIMUM", radius, given[name])
    square = nodes.math("MULTIPLY", nodes.math("MINIMUM", radius, 1.0), radius)
    return nodes.math("DIVIDE", nodes.math("MULTIPLY", given[rule.exponent], 2.0), square)


def _colour(nodes, given):
    """Reflectance at normal incidence: the colour, or for a conductor ((n-1)² + k²) / ((n+1)² + k²)."""
    if "fresnel_type" not in given:
        return given["base_color"]
    n, k = given["ior"], given["extinction"]
    squares = nodes.vector("MULTIPLY", k, k)
    less, more = (nodes.vector("ADD", n, (side, side, side)) for side in (-1.0, 1.0))
    metal = nodes.vector("DIVIDE", nodes.vector("MULTIPLY_ADD", less, less, squares),
                         nodes.vector("MULTIPLY_ADD", more, more, squares))
    return nodes.blend_vector(nodes.math("GREATER_THAN", given["fresnel_type"], 1.5), given["base_color"], metal)


def _over_diffuse(nodes, given, lobe, normal):
    """(1-F) diffuse + F specular, F Schlick's factor of the brightest channel; the lobe has the others' proportions."""
    channels = nodes.split(given["base_color"])
    brightest = nodes.math("MAXIMUM", nodes.math("MAXIMUM", channels[0], channels[1]), channels[2])
    inverse = nodes.math("DIVIDE", 1.0, nodes.math("MAXIMUM", brightest, 1e-6))
    nodes.feed(lobe, "Base Color", nodes.vector("SCALE", given["base_color"], scale=inverse))
    facing = nodes.new("ShaderNodeLayerWeight")
    facing.inputs["Blend"].default_value = 0.5  # then it is 1 - N·V
    nodes.link(normal, facing.inputs["Normal"])
    grazing = nodes.math("POWER", facing.outputs["Facing"], 5.0)
    factor = nodes.blend(grazing, brightest, 1.0)
    diffuse = nodes.principled(f"{NAME}, Diffuse", normal, metallic=0.0)
    diffuse.inputs["Roughness"].default_value = 1.0
    diffuse.inputs["Specular IOR Level"].default_value = 0.0
    nodes.feed(diffuse, "Base Color", given["diffuse_color"])
    mix = nodes.new("ShaderNodeMixShader")
    for socket, source in zip(mix.inputs, (factor, diffuse.outputs[0], lobe.outputs[0]), strict=True):
        nodes.link(source, socket)
    return mix.outputs[0]


class _Nodes:
    """Makes nodes of arithmetic, whose inputs are sockets or numbers, one below another in the group's lower half."""

    def __init__(self, tree):
        self.tree, self.count = tree, 0

    def new(self, kind):
        node = self.tree.nodes.new(kind)
        column, row = divmod(self.count, 6)
        node.location = (-600.0 + 180.0 * column, -200.0 - 170.0 * row)
        node.hide = kind in ("ShaderNodeMath", "ShaderNodeVectorMath", "ShaderNodeMix")
        self.count += 1
        return node

    def link(self, source, socket):
        """Feed a socket from another, or set it to a number."""
        if isinstance(source, float | int | tuple):
            socket.default_value = source
        else:
            self.tree.links.new(source, socket)

    def feed(self, node, name, source):
        self.link(source, node.inputs[name])

    def math(self, operation, *inputs):
        node = self.new("ShaderNodeMath")
        node.operation = operation
        for socket, source in zip(node.inputs, inputs, strict=False):
            self.link(source, socket)
        return node.outputs[0]

    def vector(self, operation, *inputs, scale=None):
        node = self.new("ShaderNodeVectorMath")
        node.operation = operation
        for socket, source in zip(node.inputs, inputs, strict=False):
            self.link(source, socket)
        if scale is not None:
            self.feed(node, "Scale", scale)
        return node.outputs["Value" if operation == "LENGTH" else "Vector"]

    def blend(self, factor, low, high):
        """low + factor (high - low)."""
        return self._mix("FLOAT", factor, low, high)

    def blend_vector(self, factor, low, high):
        return self._mix("VECTOR", factor, low, high)

    def _mix(self, kind, factor, low, high):
        node = self.new("ShaderNodeMix")
        node.data_type = kind
        # A Mix node has the sockets of all its types; those of one type are enabled.
        used = [socket for socket in node.inputs if socket.enabled]
        for socket, source in zip(used, (factor, low, high), strict=True):
            self.link(source, socket)
        return next(socket for socket in node.outputs if socket.enabled)

    def split(self, colour):
        node = self.new("ShaderNodeSeparateColor")
        self.link(colour, node.inputs[0])
        return node.outputs

    def normal(self, given):
        """The surface's own normal where the one given is zero, as it is when nothing is plugged in."""
        is_given = self.math("GREATER_THAN", self.vector("LENGTH", given), 0.0)
        own = self.new("ShaderNodeNewGeometry").outputs["Normal"]
        return self.blend_vector(is_given, own, given)

    def principled(self, name, normal, metallic):
        node = self.new("ShaderNodeBsdfPrincipled")
        node.name = node.label = name
        node.location = (200.0, -300.0 if metallic else -700.0)
        node.inputs["Metallic"].default_value = metallic
        self.feed(node, "Normal", normal)
        return node
