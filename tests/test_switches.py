"""Switching between two states of a material and back, and between what renders it."""
import json

import numpy as np
import pytest
from blender_help.recorder import context_for, drawn, operators, texts

from addon import create_material
from addon.blender.backend import Program
from addon.blender.backend.principled import PrincipledFit
from addon.brdf import MODELS
from addon.forms.albedo import tables
from addon.measure import scene
from addon.models.channels import rgb

pytestmark = [pytest.mark.blender, pytest.mark.versions]


def values_of(material):
    from addon.blender.material import groups, sockets

    return sockets.values(groups.find_node(material))


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
    with scene.MeasuringScene(material, scene.PLANE, 8) as place:
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


def test_the_native_approximation_goes_where_the_model_goes(bpy):
    """Links stay as they are, through mixes and into several outputs; others that share the group keep the model."""
    from addon.blender import backend
    from addon.blender.material import groups

    material, other = create_material("phong"), create_material("phong")
    tree, node = material.node_tree, groups.find_node(material)
    assert node.node_tree == groups.find_node(other).node_tree
    mix, add = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(node.outputs["BSDF"], mix.inputs[1])
    tree.links.new(mix.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    tree.links.new(node.outputs["BSDF"], add.inputs[0])

    def plugged():
        return {(link.to_node.name, link.to_socket.identifier): link.from_socket.name
                for output in node.outputs for link in output.links}

    before = plugged()
    press(bpy, "switch_native", material)
    assert groups.backend_of(node) == backend.FALLBACK and plugged() == before
    assert groups.backend_of(groups.find_node(other)) == backend.DEFAULT
    press(bpy, "switch_native", material)
    assert groups.backend_of(node) == backend.DEFAULT and plugged() == before


def test_a_material_is_made_without_osl(bpy, monkeypatch):
    """Where the build has none: the fallback renders, is measured, and can be driven as the model can."""
    from addon.blender.backend import osl
    from addon.blender.material import groups

    monkeypatch.setattr(osl, "unavailable", lambda: "no shading language here")
    material = create_material("pumped_phong", backend="principled", exponent=50.0, samples=7)
    assert "samples" not in groups.socket_identifiers(groups.find_node(material).node_tree)
    assert picture(material, False).mean() > 0.8
    with pytest.raises(osl.OslError):
        create_material("pumped_phong")
    with pytest.raises(ValueError, match="backend: 'tape' is not one of osl, principled"):
        create_material("pumped_phong", backend="tape")
    with pytest.raises(ValueError, match="'principled' has no option lut"):
        create_material("pumped_phong", backend="principled", lut="file")


def test_a_backend_of_another_version_is_told(bpy):
    """Its nodes are neither called damaged nor baked anew."""
    from addon.blender import backend
    from addon.blender.material import groups, repair

    material = create_material("ward", backend="principled")
    node = groups.find_node(material)
    node.node_tree[backend.BACKEND_KEY] = "tape"
    assert not repair.lost_shader(node)
    log = drawn(context_for(bpy, material))
    assert "a backend that this version of the extension does not know: tape" in texts(log)
    assert "plausible.renew" in operators(log)


class Diffuse(PrincipledFit):
    """A third backend: a diffuse closure of the albedo at normal incidence, made for the values of all models."""

    id, label = "diffuse", "Diffuse"

    def notices(self, node, model, values):
        return ()

    def follows_sockets(self, model):
        return False

    def program(self, model, values=None, ranges=None):
        return Program(self.id, model.id, json.dumps(rgb(model.albedo([1.0], **(values or {})))[0].tolist()))

    def install(self, group, model, program, inputs):
        group.nodes.new("ShaderNodeBsdfDiffuse").name = self.label
        self.update(group, program)
        return self.output(group)

    def update(self, group, program):
        color = json.loads(program.content) if program.content else (0.0, 0.0, 0.0)
        group.nodes[self.label].inputs["Color"].default_value = (*(color or (0.0, 0.0, 0.0)), 1.0)
        group["diffuse_program"] = program.content

    def output(self, group):
        node = group.nodes.get(self.label)
        return node and node.outputs[0]

    def installed(self, group):
        return Program(self.id, group["plausible_model"], group["diffuse_program"]) if self.output(group) else None


@pytest.mark.parametrize("model", ["pumped_phong", "ward"])
def test_a_third_backend_needs_nothing_but_the_protocol(bpy, monkeypatch, no_weights, model):
    from addon.blender import backend
    from addon.blender.material import baked_state, groups, materials

    monkeypatch.setitem(backend.BACKENDS, "diffuse", Diffuse())
    material = create_material(model, backend="diffuse", base_color=(0.9, 0.5, 0.2))
    expected = rgb(MODELS[model].albedo([1.0], base_color=(0.9, 0.5, 0.2)))[0]
    np.testing.assert_allclose(picture(material, False).mean(axis=(0, 1)), expected, atol=2e-3)
    other = create_material(model, base_color=(0.9, 0.5, 0.2))
    node = groups.find_node(other)
    materials.switch_backend(node, backend.chosen("diffuse"))
    assert not baked_state.is_stale(node) and baked_state.baked_error(node) is None
    np.testing.assert_allclose(picture(other, False).mean(axis=(0, 1)), expected, atol=2e-3)
    materials.set_values(node, {MODELS[model].parameter("base_color"): (0.1, 0.2, 0.3)})
    shown = picture(other, False).mean(axis=(0, 1))
    np.testing.assert_allclose(shown, rgb(MODELS[model].albedo([1.0], base_color=(0.1, 0.2, 0.3)))[0], atol=2e-3)
    for name in ("principled", "osl"):
        materials.switch_backend(node, backend.chosen(name))
        assert not baked_state.is_stale(node) and groups.backend_of(node).id == name


@pytest.mark.parametrize("model, name, value", [
    ("ward", "roughness_u", 0.4), ("ndf_map", "base_color", (0.5, 0.2, 0.1))])
def test_the_fallback_of_a_baked_model_follows_its_values(bpy, no_weights, model, name, value):
    """Its program is made for values, too; back again the rows are those of the values meanwhile."""
    from addon.blender.material import baked_state, groups, materials

    material = create_material(model)
    node = groups.find_node(material)
    press(bpy, "switch_native", material)
    before = groups.backend_of(node).installed(node.node_tree)
    materials.set_value(node, MODELS[model].parameter(name), value)
    assert groups.backend_of(node).installed(node.node_tree) != before and not baked_state.is_stale(node)
    press(bpy, "switch_native", material)
    assert not baked_state.is_stale(node)
    assert material.plausible_brdf.model == model


def test_a_text_is_kept_by_a_backend_that_does_not_read_it(bpy, no_weights):
    """The path of an image has no socket on a group before Blender 5."""
    from addon.blender.material import groups, sockets

    material = create_material("ndf_map", backend="principled")
    node, image = groups.find_node(material), MODELS["ndf_map"].parameter("image")
    path = str(tables.PACKAGED / "ndf_star.exr")
    sockets.write(node, image, path)
    for _ in range(2):
        press(bpy, "switch_native", material)
        assert sockets.get_value(node, image) == path


def test_a_device_without_osl_offers_it(bpy, monkeypatch):
    from addon.blender.backend import osl

    monkeypatch.setattr(osl, "supports_osl", lambda scene: scene.cycles.device == "CPU")
    log = drawn(context_for(bpy, create_material("phong"), device="GPU"))
    assert {"plausible.switch_native", "wm.context_set_enum"} <= set(operators(log))
