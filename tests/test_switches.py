"""Switching between two states of a material and back."""
import numpy as np
import pytest
from blender_help.recorder import context_for, drawn, operators, texts

from addon import create_material
from addon.verify import room

pytestmark = [pytest.mark.blender, pytest.mark.versions]


def values_of(material):
    from addon.blender import nodes

    return nodes.values(nodes.find_node(material))


def press(bpy, name, material):
    with bpy.context.temp_override(material=material):
        return getattr(bpy.ops.plausible, name)()


def test_the_lobe_keeps_its_width(bpy):
    material = create_material("pumped_phong", exponent=126.0)
    press(bpy, "switch_width", material)
    now = values_of(material)
    # n = 2/alpha² - 2 with alpha = r²: 126 is alpha 1/8.
    assert now["use_roughness"] and now["roughness"] == pytest.approx(0.125**0.5, rel=1e-6)
    material.plausible_brdf.roughness = 0.5
    press(bpy, "switch_width", material)
    now = values_of(material)
    assert not now["use_roughness"] and now["exponent"] == pytest.approx(2.0 / 0.5**4 - 2.0, rel=1e-6)
    with pytest.raises(RuntimeError, match="Disk Lump has no roughness"):
        press(bpy, "switch_width", create_material("disk_scaling"))


def test_before_and_after_pumping(bpy):
    material = create_material("pumped_blinn", pumps=2.5)
    assert "Show before Pumping" in buttons(bpy, material)
    press(bpy, "compare_pumping", material)
    assert values_of(material)["pumps"] == 0.0 and "Show after Pumping" in buttons(bpy, material)
    press(bpy, "compare_pumping", material)
    assert values_of(material)["pumps"] == 2.5
    with pytest.raises(RuntimeError, match="Phong is not pumped"):
        press(bpy, "compare_pumping", create_material("phong"))


def buttons(bpy, material):
    return [given.get("text") for name, given in drawn(context_for(bpy, material)) if name == "operator"]


def picture(material, osl):
    with room.Room(material, room.PLANE, 8) as place:
        place.scene.cycles.shading_system = osl
        place.sky(1.0)
        place.look_from((0.5, 0.0, 0.75**0.5))
        return place.render(16)


def test_the_native_approximation_needs_no_osl(bpy):
    """It renders where the model is black, and back again the model renders to the bit as before."""
    material = create_material("pumped_phong", exponent=50.0, base_color=(0.9, 0.6, 0.3))
    model = picture(material, True)
    assert not picture(material, False).any()
    press(bpy, "switch_native", material)
    native = picture(material, False).mean(axis=(0, 1))
    np.testing.assert_allclose(native, (0.9, 0.6, 0.3), atol=0.08)  # less what single scattering loses, more Fresnel
    words = texts(drawn(context_for(bpy, material, osl=False)))
    assert "native approximation" in words and "render black" not in words
    press(bpy, "switch_native", material)
    assert np.array_equal(picture(material, True), model)


def test_the_native_approximation_goes_where_the_model_went(bpy):
    """Through mixes and into several outputs; what is plugged in meanwhile stays."""
    from addon.blender import nodes

    material = create_material("phong")
    tree, node = material.node_tree, nodes.find_node(material)
    mix, add = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeAddShader")
    output = tree.get_output_node("CYCLES")
    tree.links.new(node.outputs["BSDF"], mix.inputs[1])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    tree.links.new(node.outputs["BSDF"], add.inputs[0])

    def plugged():
        return {(link.to_node.name, link.to_socket.identifier): link.from_socket.name
                for output in node.outputs for link in output.links}

    before = plugged()
    assert sorted(before.values()) == ["BSDF", "BSDF", "Stand-in"]
    press(bpy, "switch_native", material)
    assert set(plugged().values()) == {"Stand-in"} and plugged().keys() == before.keys()
    other = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(other.outputs[0], add.inputs[0])
    press(bpy, "switch_native", material)
    del before[(add.name, add.inputs[0].identifier)]
    assert plugged() == before and add.inputs[0].links[0].from_node == other
    for link in list(node.outputs["BSDF"].links):
        tree.links.remove(link)
    with pytest.raises(RuntimeError, match="plugged into nothing"):
        press(bpy, "switch_native", material)


def test_a_device_without_osl_offers_it(bpy, monkeypatch):
    from addon.blender import osl

    monkeypatch.setattr(osl, "supports_osl", lambda scene: scene.cycles.device == "CPU")
    log = drawn(context_for(bpy, create_material("phong"), device="GPU"))
    assert {"plausible.switch_native", "wm.context_set_enum"} <= set(operators(log))
