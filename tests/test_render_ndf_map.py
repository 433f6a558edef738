"""What Cycles renders of highlights that are images: their light, their shape, and which side it is on.

As in test_render_weights.py the truth is NumPy, bounds are two-sided and widened by five standard errors.
"""
import bpy
import numpy as np
import pytest
from blender_help.materials import node_of, sockets_of
from optics.furnace import SIGMAS
from optics.images import letter, spot, written
from optics.plane import is_striped, picture_of

from addon import create_material, measure
from addon.blender.material import baked_state, materials, sockets
from addon.brdf import MODELS
from addon.forms.rows import row_bake
from addon.models.errors import ImageError

pytestmark = pytest.mark.blender

MODEL = MODELS["ndf_map"]
FURNACE = 0.006  # of all light
# Of the largest f N·L: cells blur edges, and the star's core most.
CORE, RAYS, STROKES = 0.13, 0.02, 0.1
# Before version 5 Blender makes facets that lean too bright, see test_render_weights.py.
LEANING = 0.0 if bpy.app.version >= (5, 0) else 0.04


def turned(v, degrees):
    """Vectors (N, 3) seen from axes that are turned about the normal."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.stack([c * v[:, 0] + s * v[:, 1], c * v[:, 1] - s * v[:, 0], v[:, 2]], axis=-1)


@pytest.fixture(scope="module")
def image_of_letter(tmp_path_factory):
    """Its path: one for all tests, so that it is baked once."""
    return written(tmp_path_factory.mktemp("maps"), letter())


def material_of(image, tangent):
    """A material whose tangent is `tangent` degrees from +x: an instrument's view has the azimuth -`tangent`."""
    material = create_material("ndf_map", image=image)
    vector = material.node_tree.nodes.new("ShaderNodeCombineXYZ")
    vector.inputs[0].default_value = np.cos(np.radians(tangent))
    vector.inputs[1].default_value = np.sin(np.radians(tangent))
    socket = sockets_of(material)["tangent"]
    material.node_tree.links.new(vector.outputs[0], socket)
    return material


def view_at(theta):
    return np.array([[np.sin(np.radians(theta)), 0.0, np.cos(np.radians(theta))]])


def held(image, theta, tangent, half, bound):
    """Furnace and goniometer against the formula, at half vectors over the points `half` (N, 2) of the image.

    `bound` (N,) or one for all is of the goniometer's error, in parts of the largest f N·L there.
    Returns what is measured there, f N·L in parts of the largest.
    """
    material, view = material_of(image, tangent), turned(view_at(theta), tangent)
    p = MODEL.resolve({"image": image})
    albedo, noise = measure.furnace(material, [theta], samples=256)
    error = albedo[0, 1] - MODEL.albedo_from(view[0], p)
    assert noise.max() <= 0.2 * FURNACE and abs(error) <= FURNACE + LEANING + SIGMAS * noise[0, 1], error
    half = np.array([(x, y, np.sqrt(1.0 - x * x - y * y)) for x, y in half])
    light = 2.0 * (half @ view[0])[:, None] * half - view
    found, noise = measure.goniometer(material, theta, turned(light, -tangent), samples=256)
    scale = light[:, 2]
    expected = MODEL.evaluate(view, light, image=image) * scale
    peak = expected.max()
    found, noise = found[:, 1] * scale / peak, noise[:, 1] * scale / peak
    assert noise.max() <= 0.3 * np.max(bound)
    np.testing.assert_array_less(np.abs(found - expected / peak), bound + LEANING + SIGMAS * noise)
    return found


STAR = [(0.0, 0.0), (0.1, 0.0), (0.05, 0.0866), (0.0866, 0.05), (-0.15, 0.0), (0.0, 0.1)]


def test_the_star():
    found = held("", 50.0, 20.0, STAR, np.array([CORE, *(len(STAR) - 1) * [RAYS]]))
    # Six points: the ray at 60 degrees, not what is between at 30.
    assert found[2] > 1.8 * found[3] and found[1] > 1.5 * found[5]


LETTER = [(-0.12, 0.0), (-0.12, 0.2), (-0.12, -0.2), (0.1, 0.25), (0.1, -0.25), (0.12, 0.0), (0.12, -0.2), (0.05, 0.0)]


@pytest.mark.parametrize("theta, tangent", [(10.0, 200.0), (45.0, 15.0), (45.0, 110.0)])
def test_a_letter_can_be_read(image_of_letter, theta, tangent):
    """The strokes of an F are there, and those that it would have upside down or from right to left are not."""
    found = held(image_of_letter, theta, tangent, LETTER, STROKES)
    assert found[[0, 1, 2, 3, 7]].min() > 0.4 and np.abs(found[[4, 6]]).max() < 0.1


@pytest.mark.versions
def test_an_image_that_changes(tmp_path, monkeypatch):
    """Painted over it makes the weights stale, gone it does not; one that is not there leaves the stand-in alone."""
    few = row_bake.bake(MODELS["blinn_original"], {"exponent": 50.0})
    monkeypatch.setattr(row_bake, "bake", lambda model, given: few)
    image = written(tmp_path, spot(32), "a map; \u00e4.exr")
    material = create_material("ndf_map", image=image)
    node = node_of(material)
    assert sockets.values(node)["image"] == image and not baked_state.is_stale(node)
    assert not is_striped(picture_of(material))  # the shader knows the path that it was baked for
    written(tmp_path, letter(48), "a map; \u00e4.exr")
    assert baked_state.is_stale(node)
    baked_state.bake(node)
    assert not baked_state.is_stale(node)
    (tmp_path / "a map; \u00e4.exr").unlink()
    assert not baked_state.is_stale(node)
    monkeypatch.undo()
    roughness = material.roughness
    with pytest.raises(ImageError, match=r"elsewhere\.exr"):
        materials.set_value(node, MODEL.parameter("image"), str(tmp_path / "elsewhere.exr"))
    assert baked_state.is_stale(node) and is_striped(picture_of(material)) and material.roughness == roughness
