"""What happens to materials in a working life: duplicates, undo, overrides, keyframes, scenes, nodes edited by hand."""
import numpy as np
import pytest
from blender_help.recorder import context_for, drawn, properties, texts

from addon import create_material
from addon.brdf import MODELS
from addon.measure import scene

pytestmark = [pytest.mark.blender, pytest.mark.versions]


def node_in(material):
    from addon.blender.material import groups

    return groups.find_node(material)


def values_of(material):
    from addon.blender.material import sockets

    return sockets.values(node_in(material))


def set_value(material, name, value):
    from addon.blender.material import groups, materials

    node = node_in(material)
    materials.set_value(node, groups.model_of(node).parameter(name), value)


def bytecode_of(material):
    from addon.blender.backend import osl

    return osl.script_of(node_in(material)).bytecode


def test_a_duplicate_has_values_of_its_own(bpy):
    first = create_material("pumped_phong", exponent=7.0)
    second = first.copy()
    set_value(second, "exponent", 70.0)
    assert values_of(first)["exponent"] == 7.0 and values_of(second)["exponent"] == 70.0
    assert node_in(first).node_tree == node_in(second).node_tree, "the shader is held once"


def test_a_duplicate_of_what_is_baked_has_weights_of_its_own(bpy):
    from addon.blender.material import baked_state

    first = create_material("ward", roughness_u=0.4, roughness_v=0.4)
    second = first.copy()
    assert node_in(first).node_tree == node_in(second).node_tree
    before = bytecode_of(first)
    set_value(second, "roughness_u", 0.5)
    assert node_in(first).node_tree != node_in(second).node_tree
    assert bytecode_of(first) == before != bytecode_of(second)
    assert not baked_state.is_stale(node_in(first)) and not baked_state.is_stale(node_in(second))


def test_undo_and_redo(bpy):
    name = create_material("pumped_blinn", exponent=7.0).name
    bpy.ops.ed.undo_push(message="made")
    set_value(bpy.data.materials[name], "exponent", 70.0)
    bpy.ops.ed.undo_push(message="changed")
    bpy.ops.ed.undo()
    assert values_of(bpy.data.materials[name])["exponent"] == 7.0
    bpy.ops.ed.redo()
    assert values_of(bpy.data.materials[name])["exponent"] == 70.0


def test_undo_brings_weights_back(bpy):
    from addon.blender.material import baked_state

    name = create_material("blinn_fresnel", exponent=20.0).name
    before = bytecode_of(bpy.data.materials[name])
    bpy.ops.ed.undo_push(message="made")
    set_value(bpy.data.materials[name], "exponent", 30.0)
    bpy.ops.ed.undo_push(message="changed")
    assert bytecode_of(bpy.data.materials[name]) != before
    bpy.ops.ed.undo()
    material = bpy.data.materials[name]
    assert bytecode_of(material) == before and not baked_state.is_stale(node_in(material))


@pytest.fixture
def library(bpy, tmp_path):
    """A .blend with a material "Traveller", on an object."""
    material = create_material("pumped_phong", name="Traveller", exponent=12.0)
    thing = bpy.data.objects.new("Carrier", bpy.data.meshes.new("Carrier"))
    thing.data.materials.append(material)
    path = tmp_path / "library.blend"
    bpy.data.libraries.write(str(path), {thing}, fake_user=True)
    bpy.data.objects.remove(thing)
    bpy.data.materials.remove(material)
    for tree in list(bpy.data.node_groups):
        bpy.data.node_groups.remove(tree)
    return path


def linked(bpy, path):
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.materials = ["Traveller"]
    return wanted.materials[0]


def test_a_linked_material_is_shown_and_left_alone(bpy, library):
    material = linked(bpy, library)
    assert values_of(material)["exponent"] == 12.0
    drawn(context_for(bpy, material))
    assert bpy.ops.plausible.update_materials() == {"FINISHED"}
    with bpy.context.temp_override(material=material):
        assert not bpy.ops.plausible.switch_width.poll()


def test_a_new_material_does_not_use_a_linked_group(bpy, library):
    """The other file may go."""
    material = linked(bpy, library)
    assert node_in(create_material("pumped_phong")).node_tree.library is None
    assert node_in(material).node_tree.library is not None


def test_a_new_material_does_not_use_a_group_that_was_edited(bpy):
    """Plain materials of a model share one group, but not one that lost a socket or says that it is another model's."""
    first, second = node_in(create_material("phong")), node_in(create_material("phong"))
    assert first.node_tree == second.node_tree
    interface = first.node_tree.interface
    interface.remove(next(item for item in interface.items_tree if item.name == "Exponent"))
    third = node_in(create_material("phong", exponent=30.0))
    assert third.node_tree != first.node_tree and "Exponent" in third.inputs
    third.node_tree["plausible_model"] = "pumped_phong"
    assert node_in(create_material("phong")).node_tree not in (first.node_tree, third.node_tree)


def test_a_library_override_can_be_edited(bpy, library):
    material = linked(bpy, library).override_create()
    assert material is not None and values_of(material)["exponent"] == 12.0
    drawn(context_for(bpy, material))
    local = linked(bpy, library).copy()
    set_value(local, "exponent", 40.0)
    assert values_of(local)["exponent"] == 40.0 and values_of(linked(bpy, library))["exponent"] == 12.0


def test_two_scenes_have_switches_of_their_own(bpy):
    from addon.blender.backend import DEFAULT

    first, second = bpy.context.scene, bpy.data.scenes.new("second")
    first.render.engine = second.render.engine = "CYCLES"
    first.cycles.shading_system = second.cycles.shading_system = False
    assert DEFAULT.prepare(first) and not DEFAULT.prepare(first)
    assert first.cycles.shading_system and not second.cycles.shading_system
    bpy.data.scenes.remove(second)


def lit_plane(material):
    with scene.MeasuringScene(material, scene.PLANE, 8) as place:
        place.sky(1.0)
        place.look_from((np.sin(1.0), 0.0, np.cos(1.0)))
        return place.render(64).mean(axis=(0, 1))


def test_keyframes_render_as_their_values(bpy):
    from addon.blender.material import sockets

    material = create_material("pumped_phong", pumps=0.0)
    socket = sockets.by_id(node_in(material))["exponent"]
    for frame, exponent in ((1, 5.0), (3, 500.0)):
        socket.default_value = exponent
        socket.keyframe_insert("default_value", frame=frame)
    for frame, exponent in ((1, 5.0), (3, 500.0)):
        bpy.context.scene.frame_set(frame)  # another scene renders at the frame of the window's
        expected = MODELS["pumped_phong"].albedo(np.cos([1.0]), exponent=exponent, pumps=0.0)[0]
        assert lit_plane(material) == pytest.approx([expected] * 3, abs=0.005), frame


def test_a_link_drives_the_exponent(bpy):
    from addon.blender.material import sockets

    material = create_material("phong", exponent=5.0)
    value = material.node_tree.nodes.new("ShaderNodeValue")
    value.outputs[0].default_value = 500.0  # by its socket it would be 0.555
    material.node_tree.links.new(value.outputs[0], sockets.by_id(node_in(material))["exponent"])
    expected = MODELS["phong"].albedo(np.cos([1.0]), exponent=500.0)[0]
    assert lit_plane(material) == pytest.approx([expected] * 3, abs=0.005)


def test_keyframes_of_what_is_baked(bpy, no_weights):
    """They are baked over the range that is seen in them, or that is chosen; before that they are told."""
    from addon.blender.material import baked_state, driven, sockets

    material = create_material("blinn_fresnel", exponent=20.0)
    sockets.by_id(node_in(material))["exponent"].keyframe_insert("default_value", frame=1)
    assert "The weights are for other values" in texts(drawn(context_for(bpy, material)))
    assert tuple(material.plausible_brdf.cosine_microfacet_exponent_range) == (5.0, 80.0)  # one keyframe tells none
    material.plausible_brdf.cosine_microfacet_exponent_range = (30.0, 10.0)
    assert driven.ranges(node_in(material)) == {"exponent": (10.0, 30.0)}
    assert not baked_state.is_stale(node_in(material))
    assert "Baked over ranges of Exponent" in texts(drawn(context_for(bpy, material)))
    assert "cosine_microfacet_exponent_range" in properties(drawn(context_for(bpy, material)))
    material.plausible_brdf.model = "phong_original"  # a range goes on with the parameter
    assert driven.ranges(node_in(material)) == {"exponent": (10.0, 30.0)}
    assert not baked_state.is_stale(node_in(material))


def test_a_node_edited_by_hand(bpy):
    """A socket that was removed, a Script node that was deleted: no errors, and the rest goes on."""
    from addon.blender.material import repair

    material = create_material("pumped_phong", exponent=7.0)
    tree = node_in(material).node_tree
    item = next(i for i in tree.interface.items_tree if getattr(i, "name", "") == "Pumps")
    tree.interface.remove(item)
    assert values_of(material)["exponent"] == 7.0
    drawn(context_for(bpy, material))
    set_value(material, "exponent", 8.0)
    tree.nodes.remove(next(n for n in tree.nodes if n.bl_idname == "ShaderNodeScript"))
    assert repair.lost_shader(node_in(material))
    drawn(context_for(bpy, material))


def test_wild_sockets_are_held(bpy):
    from addon.blender.material import sockets

    material = create_material("pumped_phong")
    held = sockets.by_id(node_in(material))
    held["exponent"].default_value, held["pumps"].default_value = float("nan"), 1e9
    assert values_of(material)["exponent"] == MODELS["pumped_phong"].parameter("exponent").default
    assert values_of(material)["pumps"] == 4.0
    drawn(context_for(bpy, material))
