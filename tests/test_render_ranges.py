"""What Cycles renders of baked models whose parameters are driven: by links, textures, keyframes, over ranges.

As in test_render_weights.py the truth is NumPy, at the value that drives. Halfway between two steps what is expected is
the mean of both, off by what the panel states; bounds are those of weights that are baked for one value, and that.
"""
import bpy
import numpy as np
import pytest
from blender_help.materials import node_of, sockets_of
from optics.directions import cosines, rgb
from optics.furnace import FURNACE_BOUND, SIGMAS, albedo_of
from optics.plane import LEANING, is_striped, picture_of, plane
from optics.sun import TOTAL_BOUND, TOTAL_NOISE, Sun

from addon import brdf, create_material
from addon.blender.backend import osl
from addon.blender.material import baked_state, materials
from addon.blender.material import driven as driven_parameters

pytestmark = pytest.mark.blender

ANGLES = (1.0, 45.0, 70.0, 82.0)


def driver_of(material, name, value):
    """Link a node that gives `value` to a parameter; returns its output."""
    kind = "ShaderNodeValue" if isinstance(value, int | float) else "ShaderNodeCombineXYZ"
    node, tree = material.node_tree.nodes.new(kind), material.node_tree
    socket = sockets_of(material)[name]
    if kind == "ShaderNodeValue":
        node.outputs[0].default_value = value
    else:
        for entry, number in zip(node.inputs, value, strict=True):
            entry.default_value = number
    tree.links.new(node.outputs[0], socket)
    return node.outputs[0]


def driven(model, values, ranges=None, **given):
    """A material whose parameters `values` are driven, by links, baked over `ranges` or the usual ones."""
    material = create_material(model, **given)
    for name, value in values.items():
        driver_of(material, name, value)
        if ranges and name in ranges:
            driven_parameters.set_range(node_of(material), brdf.MODELS[model].parameter(name), *ranges[name])
    assert baked_state.is_stale(node_of(material))
    baked_state.bake(node_of(material))
    assert not baked_state.is_stale(node_of(material))
    return material


# Values at steps, halfway between, at the ends of ranges, and of colours that differ from channel to channel.
ORANGE = (0.9, 0.4, 0.05)
CASES = [
    ("ward", {"roughness_u": 0.11, "base_color": ORANGE}, {"roughness_u": (0.1, 0.13)},
     {"roughness_v": 0.12}, 2.5e-3),  # of other numbers of steps
    # An exponent between steps is in the test after this one.
    ("blinn_fresnel", {"base_color": ORANGE, "diffuse_color": (0.0, 0.3, 0.1)}, None,
     {"exponent": 57.0, "fresnel_type": "schlick"}, 2.5e-3),
    ("he_torrance", {"sigma": 0.028}, {"sigma": (0.02, 0.04)}, {}, 6e-3),  # the most of it is its mirror spike
    ("blinn_fresnel", {"fresnel_type": 2}, None, {"base_color": (0.9, 0.5, 0.3), "exponent": 57.0}, 0.0),
    ("blinn_fresnel", {"ior": (0.3, 1.2, 2.1)}, {"ior": (0.1, 2.5)}, {"fresnel_type": "conductor"}, 8e-3),
]


@pytest.mark.versions_by_shader
@pytest.mark.parametrize("model, values, ranges, given, between", CASES, ids=lambda each: str(each)[:60])
def test_furnace(model, values, ranges, given, between):
    material = driven(model, values, ranges, **given)
    measured, noise = albedo_of(material, ANGLES)
    reference = rgb(brdf.MODELS[model].albedo(cosines(ANGLES), **values, **given))
    bound = np.maximum(FURNACE_BOUND + between, LEANING)[:, None]
    assert noise.max() <= FURNACE_BOUND
    assert (np.abs(measured - reference) <= bound + SIGMAS * noise).all(), np.round(measured - reference, 4)
    stated = baked_state.baked_error(node_of(material))
    assert between <= stated[1] + FURNACE_BOUND, "more is allowed here than the panel admits"


@pytest.mark.parametrize("exponent", [40.0, 48.0])
def test_sphere_under_a_sun(exponent):
    """The shape of the lobe, at both ends of a range and between two steps in it."""
    given = {"base_color": (0.9, 0.9, 0.2)}
    material = driven("blinn_fresnel", {"exponent": exponent, **given}, {"exponent": (40.0, 80.0)})
    report = Sun(material, lambda view, light: brdf.MODELS["blinn_fresnel"].evaluate(
        view, light, exponent=exponent, **given), (0.0, 40.0, 65.0), 32)
    stated = baked_state.baked_error(node_of(material))
    bound = 0.012 + (stated[0] if 40.0 < exponent < 80.0 else 0.0)
    assert report.l1().max() <= bound, report
    total = TOTAL_BOUND + (stated[1] if 40.0 < exponent < 80.0 else 0.0)
    assert (np.abs(report.total()) <= total + SIGMAS * report.noise()).all(), report
    assert report.noise().max() <= TOTAL_NOISE


def test_beyond_a_range_the_nearest_counts():
    below = driven("blinn_original", {"exponent": 5.0}, {"exponent": (20.0, 40.0)})
    at, _ = albedo_of(create_material("blinn_original", exponent=20.0), [40.0])
    found, noise = albedo_of(below, [40.0])
    assert np.abs(found - at).max() <= 2e-3 + SIGMAS * noise.max()


@pytest.mark.versions
def test_a_texture_is_followed_from_point_to_point():
    """Colour goes from black to white along x, in each pixel of a picture from above."""
    material = create_material("ward")
    tree = material.node_tree
    place, split = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeSeparateXYZ")
    ramp, mixed = tree.nodes.new("ShaderNodeMapRange"), tree.nodes.new("ShaderNodeCombineColor")
    ramp.inputs["From Min"].default_value, ramp.inputs["From Max"].default_value = -1.0, 1.0
    tree.links.new(place.outputs["Position"], split.inputs[0])
    tree.links.new(split.outputs["X"], ramp.inputs["Value"])
    tree.links.new(ramp.outputs[0], mixed.inputs["Red"])
    mixed.inputs["Green"].default_value = 0.5
    tree.links.new(mixed.outputs[0], sockets_of(material)["base_color"])
    assert is_striped(picture_of(material))
    baked_state.bake(node_of(material))
    pixels = plane(material, 0.0, samples=256).reshape(16, 16, 3)
    white = float(brdf.MODELS["ward"].albedo(cosines([0.5]))[0])
    red = pixels[..., 0].mean(axis=0)
    steps = np.diff(red)
    np.testing.assert_allclose(steps, steps.mean(), atol=6e-3)
    assert abs(steps.mean()) > 0.02 and (red.min() >= -2e-3) and red.max() <= white + 2e-3
    assert pixels[..., 1].mean() == pytest.approx(0.5 * white, abs=4e-3)
    assert np.abs(pixels[..., 2]).max() <= 1e-6


@pytest.mark.versions
def test_keyframes_are_followed():
    """Baked over what the keyframes reach; each frame shows its value, and none is for others."""
    material = create_material("phong_original", exponent=10.0)
    node, socket = node_of(material), sockets_of(material)["exponent"]
    for frame, value in ((1, 10.0), (11, 14.0)):
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)
    assert baked_state.is_stale(node)
    least, most = driven_parameters.range_of(node, brdf.MODELS["phong_original"].parameter("exponent"))
    assert (least, most) == (pytest.approx(10.0), pytest.approx(14.0))
    baked_state.bake(node)
    for frame, value in ((1, 10.0), (6, 12.0), (11, 14.0)):
        def at(place, frame=frame):
            for scene in (place.scene, bpy.context.scene):  # the one in the window tells what time it is
                scene.frame_set(frame)

        pixels = plane(material, 30.0, samples=256, arrange=at)
        albedo = float(brdf.MODELS["phong_original"].albedo(cosines([30.0]), exponent=value)[0])
        assert pixels.mean() == pytest.approx(albedo, abs=4e-3)
        assert not baked_state.is_stale(node)
    bpy.context.scene.frame_set(1)
    socket.default_value = 40.0
    socket.keyframe_insert("default_value", frame=21)
    assert baked_state.is_stale(node) and driven_parameters.ranges(node)["exponent"][1] == pytest.approx(40.0)
    for frame, value in ((200, 40.0), (201, 90.0), (202, 40.0), (900, 40.0)):  # a flash among long stretches
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)
    assert driven_parameters.ranges(node)["exponent"][1] == pytest.approx(90.0)


@pytest.mark.versions
def test_a_driver_is_followed():
    """The range of the first bake stays, though the socket's own value is another at every frame."""
    material = create_material("phong_original", exponent=10.0)
    node, socket = node_of(material), sockets_of(material)["exponent"]
    socket.driver_add("default_value").driver.expression = "10 + 2 * 3"
    least, most = driven_parameters.ranges(node)["exponent"]
    baked_state.bake(node)
    socket.default_value = 16.0
    assert driven_parameters.ranges(node)["exponent"] == (least, most) and not baked_state.is_stale(node)
    albedo = float(brdf.MODELS["phong_original"].albedo(cosines([30.0]), exponent=16.0)[0])
    assert plane(material, 30.0, samples=256).mean() == pytest.approx(albedo, abs=6e-3)


@pytest.mark.versions
def test_links_stay_live_when_the_model_changes():
    material = create_material("phong", exponent=30.0)
    driver_of(material, "base_color", (0.4, 0.4, 0.4))
    materials.change_model(material, "blinn_original")
    node = node_of(material)
    assert list(driven_parameters.ranges(node)) == ["base_color"] and not baked_state.is_stale(node)
    albedo = brdf.MODELS["blinn_original"].albedo(cosines([30.0]), exponent=30.0, base_color=0.4).mean()
    assert plane(material, 30.0, samples=256).mean() == pytest.approx(albedo, abs=4e-3)
    other = osl.script_of(node).bytecode
    materials.set_range(node, brdf.MODELS["blinn_original"].parameter("base_color"), 0.2, 0.6)
    assert not baked_state.is_stale(node) and osl.script_of(node).bytecode != other
    material.node_tree.links.remove(sockets_of(material)["base_color"].links[0])
    assert baked_state.is_stale(node)  # now the socket's own value counts, which no weights are for
    bpy.data.materials.remove(material)
