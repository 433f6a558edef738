"""The panel, drawn into a recorder that knows what Blender's layouts accept; its properties; its notices."""
import itertools
import math
from types import SimpleNamespace

import pytest
from blender_help.materials import make
from blender_help.recorder import Recorder, context_for, drawn, operators, properties, shader_editor, texts

pytestmark = [pytest.mark.blender, pytest.mark.versions]

from addon import brdf
from addon.forms.albedo import tables

FRESNEL = {"constant": {"base_color"}, "schlick": {"base_color", "f90"}, "conductor": {"ior", "extinction"}}
COLOURS = set().union(*FRESNEL.values())


@pytest.mark.parametrize("model_id", brdf.MODELS)
@pytest.mark.parametrize("in_editor", [False, True])
def test_panel_shows_what_the_model_reads_and_nothing_else(bpy, no_weights, model_id, in_editor):
    model = brdf.MODELS[model_id]
    material = make(model_id)
    context = context_for(bpy, material, space=shader_editor(material) if in_editor else None)
    from addon.blender.ui.properties import NAMES

    shown = {p.id: NAMES[p] for p in model.parameters if p.kind != "vector"}
    for fresnel, rough, vary in itertools.product(FRESNEL, (False, True), (False, True)):
        material.plausible_brdf.fresnel_type = fresnel
        unread = COLOURS - FRESNEL[fresnel] if "fresnel_type" in shown else set()
        if "use_roughness" in shown:
            material.plausible_brdf.use_roughness = rough
            unread |= {"exponent" if rough else "roughness"}
        if "vary_exponents" in shown:
            material.plausible_brdf.vary_exponents = vary
            unread |= set() if vary else {"grazing_exponent", "retro_grazing_exponent"}
        expected = {name for key, name in shown.items() if key not in unread} | {"model"}
        assert set(properties(drawn(context))) == expected


def test_presets(bpy, no_weights):
    """Each is a valid choice of its model's parameters, and is put into any material of ours as it stands."""
    from addon.blender.material import groups, sockets
    from addon.library.presets import PRESETS

    assert len(PRESETS) >= 7
    material = make("pumped_blinn", exponent=3.0, base_color=(0.5, 0.25, 0.125))
    for name, preset in PRESETS.items():  # one upon another: nothing of the last is left
        with bpy.context.temp_override(material=material):
            assert bpy.ops.plausible.apply_preset(preset=name) == {"FINISHED"}
        node = groups.find_node(material)
        model = groups.model_of(node)
        assert model.id == preset.model
        expected = model.resolve(preset.parameters)
        for key, value in sockets.values(node).items():
            assert value == pytest.approx(expected[key], rel=1e-6), (name, key)
    menus = [given["menu"] for kind, given in drawn(context_for(bpy, material)) if kind == "menu"]
    assert "PLAUSIBLE_MT_presets" in menus


def converted(bpy, material, model_id, capsys):
    """Convert a material; returns its node and the words of the report."""
    from addon.blender.material import groups

    with bpy.context.temp_override(material=material):
        assert bpy.ops.plausible.convert(model=model_id) == {"FINISHED"}
    printed = capsys.readouterr()
    return groups.find_node(material), printed.out + printed.err


def test_convert_keeps_the_width_of_the_lobe(bpy, no_weights, capsys):
    from addon.blender.material import groups, sockets
    from addon.fitting import match

    material = make("pumped_phong", exponent=50.0, pumps=2.0, base_color=(0.5, 0.25, 0.125), samples=7)
    tree = material.node_tree
    colour, normal = tree.nodes.new("ShaderNodeRGB"), tree.nodes.new("ShaderNodeNormalMap")
    pumps = tree.nodes.new("ShaderNodeValue")
    node = groups.find_node(material)
    for source, name in ((colour, "base_color"), (normal, "shading_normal"), (pumps, "pumps")):
        tree.links.new(source.outputs[0], sockets.socket_of(node, brdf.MODELS["pumped_phong"].parameter(name)))
    node, words = converted(bpy, material, "disk_scaling", capsys)
    model = groups.model_of(node)
    assert model.id == "disk_scaling" == material.plausible_brdf.model
    values = sockets.values(node)
    # Phong's half of (R·L)^n at normal incidence, and of a lump by the scaling projection: angles of the half vector.
    beta = 0.5 * math.acos(0.5 ** (1.0 / 50.0))
    lump = (1.0 - math.tan(beta) ** 2) ** values["exponent"] / (math.cos(2.0 * beta) * math.cos(beta) ** 4)
    assert lump == pytest.approx(0.5, rel=1e-4)
    assert values["f90"] == values["base_color"] == (0.5, 0.25, 0.125)
    assert sockets.get_value(node, model.parameter("samples")) == 7
    linked = {p.id: sockets.socket_of(node, p).links[0].from_node.name for p in model.parameters
              if sockets.socket_of(node, p).is_linked}
    assert linked == {"base_color": colour.name, "shading_normal": normal.name}
    assert "half-angle 4.76°" in words and "has no Pumps, Controlled" in words and "Links are lost of Pumps" in words
    assert match.half_angles(model, match.complete(model, values))[0] == pytest.approx(beta, rel=1e-5)


def test_convert_bakes_once_and_holds_at_the_end_of_a_range(bpy, monkeypatch, no_weights, capsys):
    from addon.blender.material import baked_state, sockets
    from addon.forms.rows import row_bake

    baked, few = [], row_bake.bake(None, None)
    monkeypatch.setattr(row_bake, "bake", lambda model, parameters: baked.append((model.id, parameters)) or few)
    node, words = converted(bpy, make("blinn", exponent=50.0), "cook_torrance", capsys)
    ((model_id, parameters),) = baked
    assert model_id == "cook_torrance" and not baked_state.is_stale(node)
    assert parameters["roughness"] == pytest.approx(sockets.values(node)["roughness"], rel=1e-6)
    assert "Warning" not in words and "Slope m 0.18" in words
    node, words = converted(bpy, make("blinn", exponent=4.0), "reciprocal_disk", capsys)
    assert sockets.values(node)["exponent"] == 1.0
    assert "Warning" in words and "Exponent ends before the width of Blinn, 32.8°" in words


def test_the_error_of_baked_weights_is_shown_while_they_hold(bpy, no_weights):
    from addon.blender.material import groups, sockets

    def words(material):
        return texts(drawn(context_for(bpy, material)))

    material = make("ward")
    assert "within 1.2 %, their light within 0.1 %" in words(material)
    assert "Baked:" not in words(make("phong"))
    sockets.socket_of(groups.find_node(material), brdf.MODELS["ward"].parameter("roughness_u")).default_value = 0.4
    assert "The weights are for other values" in words(material) and "Baked:" not in words(material)


def test_convert_can_be_undone(bpy, no_weights):
    material = make("blinn", exponent=50.0)
    name = material.name
    bpy.ops.ed.undo_push(message="before")
    with bpy.context.temp_override(material=material):
        assert bpy.ops.plausible.convert("EXEC_DEFAULT", True, model="ward") == {"FINISHED"}
    assert material.plausible_brdf.model == "ward"
    bpy.ops.ed.undo()
    group = bpy.data.materials[name].plausible_brdf
    assert group.model == "blinn" and group.exponent == 50.0


def test_convert_is_offered_for_every_other_model(bpy, no_weights):
    from addon.blender.ui.operators.convert import PLAUSIBLE_MT_convert

    context = context_for(bpy, make("blinn"))
    assert "PLAUSIBLE_MT_convert" in [given["menu"] for kind, given in drawn(context) if kind == "menu"]
    log = []
    PLAUSIBLE_MT_convert.draw(SimpleNamespace(layout=Recorder(log)), context)
    assert [given["text"] for _, given in log] == [m.label for m in brdf.MODELS.values() if m.id != "blinn"]
    with pytest.raises(RuntimeError, match="no lobe to match"), bpy.context.temp_override(
            material=make("weighted_lobes", weight_1=0.0, weight_2=0.0, weight_3=0.0)):
        bpy.ops.plausible.convert(model="blinn")


def test_a_lump_that_is_shrunk_is_told(bpy):
    for parameters, told in (({"radius_u": 1.0}, True), ({"radius_u": 0.1, "radius_v": 0.05}, False)):
        log = drawn(context_for(bpy, make("disk_scaling", **parameters)))
        assert ("stays on the disk" in texts(log)) == told


def test_linked_socket_shows_its_source_and_no_slider(bpy):
    from addon.blender.material import groups, sockets

    material = make("pumped_phong")
    node = groups.find_node(material)
    source = material.node_tree.nodes.new("ShaderNodeTexNoise")
    source.label = "Scratches"
    for name in ("pumps", "shading_normal", "use_roughness"):
        target = sockets.socket_of(node, brdf.MODELS["pumped_phong"].parameter(name))
        material.node_tree.links.new(source.outputs[0], target)
    log = drawn(context_for(bpy, material))
    assert not {"pumps", "shading_normal", "use_roughness"} & set(properties(log))
    assert {"exponent", "roughness"} <= set(properties(log)), "a linked switch may choose either"
    assert sum(given.get("text") == "Scratches" and given.get("icon") == "LINKED" for _, given in log) == 3


@pytest.mark.parametrize("model_id", brdf.MODELS)
def test_properties_are_declared_by_the_registry(bpy, no_weights, model_id):
    from addon.blender.ui.properties import NAMES

    group = make(model_id).plausible_brdf
    for parameter in brdf.MODELS[model_id].parameters:
        declared = group.bl_rna.properties[NAMES[parameter]]
        assert (declared.name, declared.description) == (parameter.label, parameter.help)
        if parameter.kind == "enum":
            assert [item.identifier for item in declared.enum_items] == [item[0] for item in parameter.items]
        elif parameter.kind != "bool" and math.isfinite(parameter.maximum):
            # Blender's are of single precision.
            bounds = pytest.approx((parameter.minimum, parameter.maximum), rel=1e-6)
            assert (declared.hard_min, declared.hard_max) == bounds
            assert declared.hard_min <= declared.soft_min < declared.soft_max <= declared.hard_max


def test_values_live_in_the_sockets_only(bpy):
    from addon.blender.material import groups, materials, sockets

    material = make("pumped_blinn", exponent=35.0)
    model, node, group = brdf.MODELS["pumped_blinn"], groups.find_node(material), material.plausible_brdf
    written = {"exponent": 50.0, "pumps": 2.5, "control": False, "samples": 7, "fresnel_type": "conductor",
               "base_color": (0.25, 0.5, 0.75), "ior": (0.5, 1.5, 12.0)}
    assert group.exponent == 35.0
    for name, value in written.items():
        setattr(group, name, value)
        shown = getattr(group, name)
        assert (tuple(shown) if isinstance(value, tuple) else shown) == value
        held = sockets.get_value(node, model.parameter(name))
        assert held == model.parameter(name).check(value)
    materials.set_value(node, model.parameter("exponent"), 12.0)
    assert group.exponent == 12.0
    # 5.0 and later keep what properties store apart from what users store.
    stored = group.bl_system_properties_get() if hasattr(group, "bl_system_properties_get") else group
    assert not (stored and list(stored.keys())), "nothing may be stored a second time"


def test_properties_hold_to_the_range(bpy):
    group = make("pumped_phong").plausible_brdf
    group.exponent, group.pumps, group.samples = 1e9, -3.0, 99
    assert (group.exponent, group.pumps, group.samples) == (100000.0, 0.0, 8)


def test_a_path_is_written_whole(bpy, no_weights, tmp_path):
    """What a file browser gives is relative to the .blend, and other commands know nothing of that."""
    from addon.blender.material import groups, sockets

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    material = make("ndf_map")
    material.plausible_brdf.image = "//maps/star.png"
    whole = str(tmp_path / "maps" / "star.png")
    assert material.plausible_brdf.image == sockets.values(groups.find_node(material))["image"] == whole
    material.plausible_brdf.image = ""
    assert material.plausible_brdf.image == ""


def test_choosing_a_model_keeps_what_both_have(bpy):
    material = make("pumped_phong", exponent=77.0, base_color=(0.5, 0.25, 0.125))
    material.plausible_brdf.model = "blinn"
    assert material.plausible_brdf.model == "blinn"
    assert material.plausible_brdf.exponent == 77.0
    assert tuple(material.plausible_brdf.base_color) == (0.5, 0.25, 0.125)
    assert "pumps" not in properties(drawn(context_for(bpy, material)))


def test_other_materials_get_an_offer_and_the_other_engines_no_panel(bpy):
    plain = bpy.data.materials.new("plain")
    assert operators(drawn(context_for(bpy, plain))) == ["plausible.new_material"]
    assert operators(drawn(context_for(bpy, None))) == ["plausible.new_material"]
    assert drawn(context_for(bpy, plain, engine="BLENDER_WORKBENCH")) == []


def test_every_obstacle_is_named_and_has_a_cure(bpy, monkeypatch, tmp_path):
    from addon.blender.backend import osl

    material = make("pumped_phong")
    log = drawn(context_for(bpy, material))
    assert "Open Shading Language is on" in texts(log) and "plausible.use_osl" not in operators(log)
    log = drawn(context_for(bpy, material, osl=False))
    assert "render black" in texts(log) and "plausible.use_osl" in operators(log)
    log = drawn(context_for(bpy, material, engine="BLENDER_WORKBENCH"))
    assert "stand-in" in texts(log) and "wm.context_set_enum" in operators(log)
    monkeypatch.setattr(osl, "supports_osl", lambda scene: scene.cycles.device == "CPU")
    log = drawn(context_for(bpy, material, device="GPU"))
    assert "needs OptiX" in texts(log) and "wm.context_set_enum" in operators(log)
    monkeypatch.setattr(osl, "supports_osl", lambda scene: True)
    log = drawn(context_for(bpy, material, device="GPU"))
    assert "more room than Cycles has" in texts(log) and "wm.context_set_enum" in operators(log)
    tables.use_folder(tmp_path)
    log = drawn(context_for(bpy, material))
    assert "phong_plain.exr" in texts(log).replace(" ", "") and "is missing" in texts(log)
    assert "plausible.choose_bake" in operators(log)
    monkeypatch.setattr(osl, "unavailable", lambda: "no shading language here")
    log = drawn(context_for(bpy, material))
    assert "no shading language here" in texts(log) and "wm.url_open" in operators(log)
    assert not bpy.ops.plausible.new_material.poll()


def test_metal_sets_what_the_model_has(bpy):
    from addon.library.metals import METALS

    material = make("phong", fresnel_type="schlick")
    with bpy.context.temp_override(material=material):
        assert bpy.ops.plausible.set_metal(metal="gold") == {"FINISHED"}
    group = material.plausible_brdf
    assert tuple(group.base_color) == pytest.approx(METALS["gold"].f0)
    assert tuple(group.ior) == pytest.approx(METALS["gold"].ior)
    assert tuple(group.extinction) == pytest.approx(METALS["gold"].extinction)
    assert group.fresnel_type == "schlick"


def test_menu_and_preferences_draw(bpy):
    from addon.blender.ui.operators.metals import PLAUSIBLE_MT_metals
    from addon.blender.ui.preferences import PlausiblePreferences
    from addon.library.metals import METALS

    log = []
    PLAUSIBLE_MT_metals.draw(SimpleNamespace(layout=Recorder(log)), None)
    assert [given["text"] for _, given in log] == [metal.label for metal in METALS.values()]
    log = []
    preferences = SimpleNamespace(layout=Recorder(log), bl_rna=PlausiblePreferences.bl_rna, lut_folder="", samples=4,
                                  light_spread=1.0, cache_limit=200)
    PlausiblePreferences.draw(preferences, context_for(bpy))
    assert properties(log) == ["lut_folder", "samples", "light_spread", "cache_limit"]
    assert "Blinn controlled: Standard, 192 × 264, exponents 1 to 100000, within 0.089 %" in texts(log)
    assert str(tables.folder()).replace(" ", "") in texts(log).replace(" ", "")


def test_new_material_goes_to_the_active_slot(bpy):
    scene = bpy.context.scene
    thing = bpy.data.objects.new("thing", bpy.data.meshes.new("thing"))
    scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    scene.render.engine, scene.cycles.shading_system = "CYCLES", False
    assert bpy.ops.plausible.new_material() == {"FINISHED"}
    assert len(thing.material_slots) == 1 and thing.material_slots[0].material.plausible_brdf.model == "pumped_phong"
    assert scene.cycles.shading_system
    thing.data.materials.append(None)
    thing.active_material_index = 1
    assert bpy.ops.plausible.new_material(model="blinn") == {"FINISHED"}
    assert [slot.material.plausible_brdf.model for slot in thing.material_slots] == ["pumped_phong", "blinn"]
    bpy.data.objects.remove(thing)


@pytest.fixture
def one_table(tmp_path):
    """A folder with an old file in place of one table, in use for the test."""
    tables.use_folder(tmp_path)
    tables.TABLES["phong_plain"].path.write_bytes(b"an older table")
    yield tables.TABLES["phong_plain"].path
    tables.use_folder()


def test_cancelled_bake_leaves_the_old_table(bpy, one_table):
    from addon.blender.host import table_job

    table_job.job = table_job.BakeJob(["phong_plain"])
    table_job.job.start()
    while table_job.job.done < 2:
        assert table_job.job.running
    log = drawn(context_for(bpy, make_without_tables()))
    assert any(name == "progress" and 0.0 < given["factor"] < 1.0 for name, given in log)
    assert not bpy.ops.plausible.bake_luts.poll(), "one bake at a time"
    assert bpy.ops.plausible.cancel_bake() == {"FINISHED"}
    table_job.job.wait()
    assert table_job.job.cancelled and table_job.job.error is None
    assert one_table.read_bytes() == b"an older table" and list(one_table.parent.iterdir()) == [one_table]


def make_without_tables():
    """A material whose model reads tables, although there are none: its model is changed behind the scenes."""
    from addon.blender.backend import protocol
    from addon.blender.material import groups

    material = make("phong")
    groups.find_node(material).node_tree[protocol.MODEL_KEY] = "pumped_phong"
    return material


def test_bake_makes_the_shipped_table(bpy, one_table):
    import numpy as np

    from addon.blender.host import table_folder, table_job

    assert table_folder.problem(["phong_plain"])
    job = table_job.BakeJob(["phong_plain"])
    job.start()
    job.wait()
    assert job.error is None and not job.cancelled and job.share == 1.0
    assert table_folder.problem(["phong_plain"]) is None
    baked = tables.load(tables.TABLES["phong_plain"])
    tables.use_folder()
    np.testing.assert_allclose(baked, tables.load(tables.TABLES["phong_plain"]), rtol=1e-6)


def test_failed_bake_is_reported(bpy, monkeypatch, capsys):
    from addon.blender.host import table_job
    from addon.forms.albedo import bake

    def broken(names, workers, size):
        yield 1, 2, "phong_plain"
        raise OSError("the disk is full")

    monkeypatch.setattr(bake, "bake", broken)
    with pytest.raises(RuntimeError, match="the disk is full"):
        bpy.ops.plausible.bake_luts()
    assert isinstance(table_job.job.error, OSError)


def test_update_materials_compiles_anew(bpy):
    from addon.blender.backend import osl
    from addon.blender.material import groups

    material = make("pumped_phong", exponent=33.0)
    script = osl.script_of(groups.find_node(material))
    right, script.bytecode = script.bytecode, "stale"
    assert bpy.ops.plausible.update_materials() == {"FINISHED"}
    assert script.bytecode == right and material.plausible_brdf.exponent == 33.0
