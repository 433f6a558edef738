"""Reference materials for checking the instruments: their reflectance is known in closed form.

Each is one of Cycles' own closures. `evaluate(view, light)` is its f in 1/sr for unit vectors (N, 3).
"""
import hashlib
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..models.geometry import dot, half, mirror
from ..models.microfacet import beckmann_lambda
from .scene import MeasureError, quiet, require_blender

_OSL = """
surface standard(output closure color BSDF = 0)
{{
    {body}
}}
"""
_PHONG = "color ramp[8] = {{{white}}}; BSDF = phong_ramp(N, {exponent!r}, ramp);"
_ASHIKHMIN = 'BSDF = microfacet("ashikhmin_shirley", N, normalize(dPdu), {alpha!r}, {alpha!r}, 0.0, 0);'


@dataclass(frozen=True)
class Standard:
    """A closure with its `formula(view, light)`; `body` is the OSL statement that sets the closure."""

    id: str
    body: str
    formula: object

    def evaluate(self, view, light) -> np.ndarray:
        """f(V, L), (N,) in 1/sr, 0 below the horizon."""
        view, light = np.broadcast_arrays(np.atleast_2d(view), np.atleast_2d(light))
        above = (view[:, 2] > 0.0) & (light[:, 2] > 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(above, self.formula(view, light), 0.0)

    def material(self, factor: float = 1.0):
        """Makes a material of this closure times `factor`. Raises MeasureError where OSL is missing."""
        body = self.body if factor == 1.0 else f"{self.body} BSDF *= {float(factor)!r};"
        return material_of_source(_OSL.format(body=body), f"Standard {self.id}")


def diffuse() -> Standard:
    """Lambertian, albedo 1."""
    return Standard("diffuse", "BSDF = diffuse(N);", lambda view, light: np.full(len(view), 1.0 / np.pi))


def phong(exponent: float) -> Standard:
    """Reciprocal Phong (n+2)/(2pi) (R·L)^n, by `phong_ramp` of one white."""
    def formula(view, light):
        return (exponent + 2.0) / (2.0 * np.pi) * np.maximum(dot(mirror(view), light), 0.0) ** exponent

    return Standard("phong", _PHONG.format(white=", ".join(["color(1)"] * 8), exponent=float(exponent)), formula)


def ashikhmin_shirley(exponent: float) -> Standard:
    """Isotropic Ashikhmin-Shirley without Fresnel: (n+1)/(8pi) (N·H)^n / ((H·V) max(N·V, N·L))."""
    def formula(view, light):
        middle = half(view, light)
        lobe = (exponent + 1.0) / (8.0 * np.pi) * np.maximum(middle[:, 2], 0.0) ** exponent
        return lobe / (dot(middle, view) * np.maximum(view[:, 2], light[:, 2]))

    alpha = (2.0 / (exponent + 2.0)) ** 0.5
    return Standard("ashikhmin_shirley", _ASHIKHMIN.format(alpha=alpha), formula)


def microfacet(distribution: str, alpha: float) -> Standard:
    """Isotropic microfacets without Fresnel: D G / (4 (N·L)(N·V)), `distribution` "beckmann" or "ggx".

    G is Smith's, height-correlated (Walter et al. 2007, eq. 25, 33; Heitz 2014, eq. 99), Beckmann's by the usual fit.
    """
    def slope_lambda(cosine):
        tan = np.sqrt(np.maximum(1.0 / np.square(cosine) - 1.0, 1e-12))
        if distribution == "ggx":
            return 0.5 * (np.sqrt(1.0 + (alpha * tan) ** 2) - 1.0)
        return beckmann_lambda((alpha * tan) ** 2)

    def formula(view, light):
        cos2 = np.square(half(view, light)[:, 2])
        tan2 = (1.0 / cos2 - 1.0) / alpha**2
        density = np.exp(-tan2) if distribution == "beckmann" else 1.0 / (1.0 + tan2) ** 2
        density = density / (np.pi * alpha**2 * cos2**2)
        shadowing = 1.0 + slope_lambda(view[:, 2]) + slope_lambda(light[:, 2])
        return density / (4.0 * view[:, 2] * light[:, 2] * shadowing)

    return Standard(distribution, f'BSDF = microfacet("{distribution}", N, {alpha!r}, 0.0, 0);', formula)


def native(distribution: str, roughness: float = 0.0, reflectance: float = 1.0):
    """Makes a material of one of Cycles' own nodes: Diffuse for "DIFFUSE", else Glossy of `distribution`, as "GGX"."""
    material = _blank(f"Native {distribution.title()}")
    nodes = material.node_tree.nodes
    node = nodes.new("ShaderNodeBsdfDiffuse" if distribution == "DIFFUSE" else "ShaderNodeBsdfAnisotropic")
    node.inputs["Color"].default_value = (reflectance, reflectance, reflectance, 1.0)
    node.inputs["Roughness"].default_value = roughness
    if distribution != "DIFFUSE":
        node.distribution = distribution
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def material_of_source(source: str, name: str):
    """Makes a material whose surface is the OSL `source`, which has one output `BSDF`.

    The function fills the node itself: the wheels of bpy cannot query a shader for its sockets. Raises MeasureError
    where the source does not compile.
    """
    require_blender()
    import _cycles

    with tempfile.TemporaryDirectory() as folder, quiet():
        written, compiled = Path(folder, "shader.osl"), Path(folder, "shader.oso")
        written.write_text(source)
        if not _cycles.osl_compile(str(written), str(compiled)):
            raise MeasureError(f"{name}: the OSL source does not compile")
        bytecode = compiled.read_text()
    # A Script node with that bytecode and one socket is the material's surface.
    material = _blank(name)
    nodes = material.node_tree.nodes
    script, output = nodes.new("ShaderNodeScript"), nodes.new("ShaderNodeOutputMaterial")
    script.mode = "INTERNAL"
    script.bytecode = bytecode
    script.bytecode_hash = hashlib.md5(bytecode.encode(), usedforsecurity=False).hexdigest()
    socket = script.outputs.new("NodeSocketShader", "BSDF", identifier="BSDF")
    material.node_tree.links.new(socket, output.inputs["Surface"])
    return material


def _blank(name):
    """Makes a material whose node tree is empty."""
    material = require_blender().data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    material.node_tree.nodes.clear()
    return material
