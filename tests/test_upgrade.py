"""Files of earlier versions: their materials become this version's, and nothing that a user made is lost.

tests/data/version_0_1.blend was saved in Blender 4.2 with version 0.1.0: its shaders' bytecode is replaced by a line of
text. "Animated" is a pumped Phong with a keyframed light spread, a driver on its pumps and a node plugged into its
roughness, "Baked" a Ward, "Wrapped" a disk lump, and "Mine" a user's node group with a Blinn inside.

tests/data/version_0_2.blend was saved in Blender 4.2 with version 0.2.0, bytecode replaced likewise. "Live" is a pumped
Phong with keyframed pumps and a node plugged into its color, "Twin" another that shares its group, "Lump" a disk lump,
"Baked" a Ward, "Driven" a Blinn-Phong whose exponent a node drives over a range, "Picture" an NDF map, and "Native" and
"Native Baked" show their stand-ins, plugged in where the BSDF was.
"""
from pathlib import Path

import pytest
from blender_help.recorder import context_for, drawn, operators, texts

from addon.brdf import MODELS
from addon.version import VERSION, parts

pytestmark = [pytest.mark.blender, pytest.mark.versions]

OLD = Path(__file__).parent / "data" / "version_0_1.blend"
OLDER_GROUPS = Path(__file__).parent / "data" / "version_0_2.blend"


@pytest.fixture
def loaded(bpy):
    bpy.ops.wm.open_mainfile(filepath=str(OLD))
    yield bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)


def node_in(bpy, name):
    from addon.blender.material import groups

    return groups.find_node(bpy.data.materials[name])


def test_versions_compare_by_number():
    assert parts("0.10.0") > parts("0.9.3") > parts("0.2.0") and parts("unknown") == ()
    assert parts(VERSION) >= (0, 2, 0)


def test_values_and_links_stay(loaded):
    from addon.blender.material import groups, sockets

    node = node_in(loaded, "Animated")
    assert node.bl_idname == "ShaderNodeGroup" and groups.model_of(node).id == "pumped_phong"
    values = sockets.values(node)
    assert values["exponent"] == 50.0 and values["base_color"] == (0.5, 0.25, 0.125)
    held = sockets.by_id(node)
    assert held["samples"].default_value == 7
    assert held["roughness"].links[0].from_node.name == "Driver of roughness"
    assert sockets.values(node_in(loaded, "Wrapped"))["exponent"] == 12.0
    inside = next(n for n in loaded.data.node_groups["Mine"].nodes if groups.model_of(n))
    assert groups.model_of(inside).id == "blinn" and sockets.values(inside)["exponent"] == 33.0
    (link,) = inside.outputs["BSDF"].links
    assert link.to_node.bl_idname == "NodeGroupOutput"


def test_keyframes_and_drivers_follow(loaded):
    from addon.blender.material import sockets

    material = loaded.data.materials["Animated"]
    thing = loaded.data.objects.new("thing", loaded.data.meshes.new("thing"))
    thing.data.materials.append(material)
    loaded.context.scene.collection.objects.link(thing)
    held = sockets.by_id(node_in(loaded, "Animated"))
    for frame, spread, pumps in ((1, 0.5, 0.1), (11, 1.5, 1.1), (30, 1.5, 3.0)):
        loaded.context.scene.frame_set(frame)
        assert held["light_spread"].default_value == pytest.approx(spread)
        assert held["pumps"].default_value == pytest.approx(pumps)


def test_another_model_keeps_keyframes(bpy):
    """Of what both have; those of what the other lacks wait under its name, and move nothing meanwhile."""
    from addon import create_material
    from addon.blender.material import groups, materials, sockets

    material = create_material("pumped_phong", exponent=7.0)
    thing = bpy.data.objects.new("thing", bpy.data.meshes.new("thing"))
    thing.data.materials.append(material)
    bpy.context.scene.collection.objects.link(thing)
    before = sockets.by_id(groups.find_node(material))
    for name, value in (("samples", 2), ("samples", 8), ("pumps", 3.0)):
        before[name].default_value = value
        before[name].keyframe_insert("default_value", frame=value)
    for model_id in ("phong", "pumped_phong"):
        materials.change_model(material, model_id)
        after = sockets.by_id(groups.find_node(material))
        for frame in (2, 8):
            bpy.context.scene.frame_set(frame)
            assert after["samples"].default_value == frame and after["exponent"].default_value == 7.0
    after["pumps"].default_value = 0.5
    bpy.context.scene.frame_set(3)
    assert after["pumps"].default_value == 3.0


def test_the_shader_is_this_versions(loaded):
    from addon.blender.backend import osl
    from addon.blender.material import upgrade

    for name, model in (("Animated", "pumped_phong"), ("Wrapped", "disk_scaling")):
        node = node_in(loaded, name)
        assert osl.script_of(node).bytecode == osl.Osl().program(MODELS[model]).content
        assert upgrade.version_of(node) == VERSION
    # Baking takes seconds, and a file is not to open slowly: its own weights serve until they are baked anew.
    assert osl.script_of(node_in(loaded, "Baked")).bytecode == "bytecode of an older version of ward"
    assert not upgrade.outdated()


def test_the_stand_in_takes_over(loaded):
    tree = loaded.data.materials["Animated"].node_tree
    links = tree.get_output_node("EEVEE").inputs["Surface"].links
    assert links[0].from_node == node_in(loaded, "Animated") and links[0].from_socket.name == "Stand-in"
    assert not [n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled"]


def test_it_is_told(loaded, capsys):
    material = loaded.data.materials["Wrapped"]
    words = texts(drawn(context_for(loaded, material)))
    assert f"Upgraded to {VERSION}: Animated, Baked, Mine, Wrapped" in words and "until you save" in words
    loaded.ops.wm.read_factory_settings(use_empty=True)
    from addon.blender.material import upgrade

    assert upgrade.told == ""


def test_what_is_appended_later_has_a_button(bpy):
    from addon.blender.material import groups, sockets

    with bpy.data.libraries.load(str(OLD)) as (_, wanted):
        wanted.materials = ["Wrapped"]
    (material,) = wanted.materials
    log = drawn(context_for(bpy, material))
    assert "earlier version" in texts(log) and "plausible.upgrade" in operators(log)
    assert bpy.ops.plausible.upgrade() == {"FINISHED"}
    assert sockets.values(groups.find_node(material))["exponent"] == 12.0
    assert "plausible.upgrade" not in operators(drawn(context_for(bpy, material)))


def test_what_is_linked_is_left_alone(bpy):
    from addon.blender.material import upgrade

    with bpy.data.libraries.load(str(OLD), link=True) as (_, wanted):
        wanted.materials = ["Wrapped"]
    assert upgrade.upgrade_all() == ""
    assert any(n.bl_idname == "ShaderNodeScript" for n in wanted.materials[0].node_tree.nodes)


def test_one_that_cannot_be_upgraded_stays(bpy, monkeypatch):
    from addon.blender.material import groups, upgrade

    def broken(tree, model, *_):
        raise OSError("the table is gone")

    monkeypatch.setattr(groups, "add_node", broken)
    bpy.ops.wm.open_mainfile(filepath=str(OLD))
    assert "Not upgraded: " in upgrade.told and "Wrapped: the table is gone" in upgrade.told
    old = next(n for n in bpy.data.materials["Wrapped"].node_tree.nodes if n.bl_idname == "ShaderNodeScript")
    assert old.bytecode == "bytecode of an older version of disk_scaling"
    bpy.ops.wm.read_factory_settings(use_empty=True)


def test_a_newer_version_is_told(bpy):
    from addon import create_material
    from addon.blender.material import groups, upgrade
    from addon.blender.ui import notices

    material = create_material("disk_scaling")
    node = groups.find_node(material)
    node.node_tree[groups.VERSION_KEY] = "99.0.0"
    assert not upgrade.is_outdated(node) and upgrade.upgrade_all() == ""
    assert "Made by version 99.0.0" in " ".join(n.text for n in notices.notices(context_for(bpy, material), node))


# Version 0.2: groups that only OSL rendered

@pytest.fixture
def groups_loaded(bpy):
    bpy.ops.wm.open_mainfile(filepath=str(OLDER_GROUPS))
    yield bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)


def test_groups_keep_values_links_and_keyframes(groups_loaded):
    from addon.blender import backend
    from addon.blender.material import groups, sockets, upgrade

    assert not upgrade.outdated()
    live, twin = node_in(groups_loaded, "Live"), node_in(groups_loaded, "Twin")
    held = sockets.by_id(live)
    assert sockets.values(live)["exponent"] == 50.0 and held["samples"].default_value == 7
    assert held["base_color"].links[0].from_node.name == "Painter"
    assert sockets.values(twin)["exponent"] == 12.0 and live.node_tree == twin.node_tree
    thing = groups_loaded.data.objects.new("thing", groups_loaded.data.meshes.new("thing"))
    thing.data.materials.append(groups_loaded.data.materials["Live"])
    groups_loaded.context.scene.collection.objects.link(thing)
    for frame, pumps in ((1, 0.5), (11, 2.5)):
        groups_loaded.context.scene.frame_set(frame)
        assert held["pumps"].default_value == pytest.approx(pumps)
    for name in ("Live", "Lump", "Baked", "Driven", "Picture"):
        node = node_in(groups_loaded, name)
        assert groups.backend_of(node) == backend.DEFAULT and not groups.lacking(node.node_tree)


def test_rows_of_version_0_2_go_on(groups_loaded):
    """A bake takes seconds: a node renders by the program that it had, for the values that it was made for."""
    from addon.blender.backend import osl
    from addon.blender.material import baked_state, driven, sockets

    for name, model in (("Baked", "ward"), ("Driven", "blinn_fresnel"), ("Picture", "ndf_map")):
        node = node_in(groups_loaded, name)
        assert f"an older version's shader of {model}" in osl.script_of(node).bytecode
        assert baked_state.baked_error(node) is not None
    assert driven.ranges(node_in(groups_loaded, "Driven")) == {"exponent": (10.0, 40.0)}
    assert not any(baked_state.is_stale(node_in(groups_loaded, name)) for name in ("Baked", "Driven"))
    assert sockets.values(node_in(groups_loaded, "Picture"))["image"] == "/nowhere/star.exr"


@pytest.mark.parametrize("name", ["Native", "Native Baked"])
def test_a_stand_in_that_was_plugged_in_is_a_backend_now(groups_loaded, name):
    from addon.blender import backend
    from addon.blender.material import baked_state, groups

    material, node = groups_loaded.data.materials[name], node_in(groups_loaded, name)
    assert groups.backend_of(node) == backend.FALLBACK and not baked_state.is_stale(node)
    (link,) = material.node_tree.get_output_node("CYCLES").inputs["Surface"].links
    assert link.from_node == node and link.from_socket.name == "BSDF"
    log = drawn(context_for(groups_loaded, material, osl=False))
    assert "native approximation" in texts(log) and "plausible.switch_native" in operators(log)
