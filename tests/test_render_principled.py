"""The formula of Blender's Principled BSDF, which stand-ins are fitted by, is what Cycles renders, within bounds.

The sun has no size, and the plane is seen by an orthographic camera, so that each pixel has one view and one light.
What is left over is Cycles' own: its tables of albedos have 16 or 32 nodes.
"""
import numpy as np
import pytest

from addon import measure
from addon.backends.nodes.principled_bsdf import Inputs, albedo, evaluate
from addon.models.geometry import view_at

pytestmark = [pytest.mark.blender, pytest.mark.versions]

METAL_BOUND, BODY_BOUND = 0.005, 0.005  # of f, beside 0.001 of the view's peak
ALBEDO_BOUND, ALBEDO_NOISE = 0.006, 0.001
GOLD, BLUE = (1.0, 0.784, 0.342), (0.1, 0.25, 0.6)
CASES = {
    "metal": Inputs(GOLD, 1.0, 0.45),
    "rough metal": Inputs(GOLD, 1.0, 0.85),
    "stretched metal": Inputs(GOLD, 1.0, 0.4, anisotropic=0.8, rotation=0.1),
    "body": Inputs(BLUE, 0.0, 0.4),
    "body of high index": Inputs(BLUE, 0.0, 0.6, ior=2.4),
    "mixed": Inputs(BLUE, 0.4, 0.5, ior=1.5, specular=0.8),
}


def material(inputs):
    """A Principled material with these inputs, its tangent along +x."""
    import bpy

    made = bpy.data.materials.new("Principled")
    if made.node_tree is None:
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node, output, tangent = (tree.nodes.new(f"ShaderNode{kind}") for kind in (
        "BsdfPrincipled", "OutputMaterial", "CombineXYZ"))
    tangent.inputs[0].default_value = 1.0
    for name, value in {"Base Color": (*inputs.base_color, 1.0), "Metallic": inputs.metallic,
                        "Roughness": inputs.roughness, "IOR": inputs.ior, "Specular IOR Level": inputs.specular,
                        "Anisotropic": inputs.anisotropic, "Anisotropic Rotation": inputs.rotation}.items():
        node.inputs[name].default_value = value
    tree.links.new(tangent.outputs[0], node.inputs["Tangent"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


@pytest.fixture(scope="module")
def bpy():
    return pytest.importorskip("bpy")


def lights(view):
    """Lights about the mirror direction, in the plane of incidence and off it, and one far away."""
    lean = np.radians([0.0, 12.0, -15.0, 0.0, 0.0, -40.0])
    aside = np.radians([0.0, 0.0, 0.0, 15.0, -30.0, 20.0])
    theta = np.clip(np.radians(view) + lean, -1.45, 1.45)
    return np.stack([-np.sin(theta) * np.cos(aside), np.sin(aside), np.cos(theta) * np.cos(aside)], axis=-1)


@pytest.mark.parametrize("name", CASES)
def test_formula_is_what_cycles_renders(bpy, name):
    inputs = CASES[name]
    made = material(inputs)
    for view in (10.0, 60.0, 78.0):
        towards = lights(view)
        measured = measure.goniometer(made, view, towards, samples=1, resolution=4)
        expected = evaluate(inputs, np.repeat(view_at(np.cos(np.radians([view]))), len(towards), axis=0), towards)
        allowed = (BODY_BOUND if inputs.metallic < 1.0 else METAL_BOUND) * expected + 1e-3 * expected.max()
        error = np.abs(measured.value - expected)
        assert (error <= allowed + 5.0 * measured.noise).all(), (view, (error / expected).max(axis=1).round(4))
    angles = np.array([0.0, 60.0])
    measured = measure.furnace(made, angles, samples=256, resolution=16)
    assert measured.noise.max() < ALBEDO_NOISE
    if not inputs.anisotropic:
        expected = albedo(inputs, np.cos(np.radians(angles)))
        assert np.abs(measured.value - expected).max() < ALBEDO_BOUND, (measured.value, expected)
    bpy.data.materials.remove(made)
