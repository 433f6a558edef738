"""The sub-panel Energy: what it shows against the models' albedos, that drawing computes nothing, and what is left."""
import numpy as np
import pytest
from blender_help.materials import make
from blender_help.recorder import Recorder, context_for, shader_editor, texts

from addon import brdf
from addon.plots import picture, quick

pytestmark = [pytest.mark.blender, pytest.mark.versions]
VIEWS = (0.0, 60.0, 80.0)


@pytest.fixture
def bpy(registered):
    import bpy

    yield bpy
    for blocks in (bpy.data.materials, bpy.data.node_groups):
        for block in list(blocks):
            blocks.remove(block)


@pytest.fixture
def energy(bpy):
    from addon.blender.ui import energy

    return energy


def plausible_node(material):
    from addon.blender.ui.operators import common

    return common.plausible_node(material)


def drawn(energy, context):
    """What the panel of the context's place draws, as a list of (layout function, its arguments)."""
    log = []
    in_editor = context.space_data.type == "NODE_EDITOR"
    for cls in energy.CLASSES:
        if (cls.bl_space_type == "NODE_EDITOR") == in_editor and cls.poll(context):
            stand_in = type(cls.__name__, cls.__bases__[:-1], {})()
            stand_in.layout = Recorder(log)
            cls.draw(stand_in, context)
    return log


def icons(log):
    return [given for name, given in log if name == "template_icon"]


def pixels_of(shown):
    """The picture (256, 512, 4) that a material's previews hold."""
    side = picture.SIDE
    halves = [np.array(half.image_pixels_float[:]).reshape(side, side, 4) for half in shown.halves]
    return np.concatenate(halves, axis=1)


@pytest.mark.parametrize("in_editor", [False, True])
def test_numbers_and_picture_follow_the_values(bpy, energy, monkeypatch, in_editor):
    """Nothing is computed while drawing; a timer does it, and until then the old plot stays."""
    material = make("pumped_phong", exponent=50.0)
    context = context_for(bpy, material, space=shader_editor(material) if in_editor else None)
    with monkeypatch.context() as drawing:
        drawing.setattr(quick, "plot", lambda *_: pytest.fail("computed while drawing"))
        assert "Computing" in texts(drawn(energy, context))
    assert bpy.app.timers.is_registered(energy.make_wanted)
    for exponent in (50.0, 3.0):
        material.plausible_brdf.exponent = exponent
        drawn(energy, context)
        energy.make_wanted()
        log = drawn(energy, context)
        albedo = brdf.MODELS["pumped_phong"].albedo(np.cos(np.radians(VIEWS)), exponent=exponent)
        shown = [float(given["text"].split(":")[1]) for name, given in log
                 if name == "label" and given.get("text", "")[:3] in ("0°:", "60°", "80°")]
        assert shown == pytest.approx(albedo, abs=quick.TOLERANCE + 5e-4)
        assert len(icons(log)) == 2
        assert "gray before pumping" in texts(log)
        expected = picture.draw(quick.plot(brdf.MODELS["pumped_phong"], {"exponent": exponent}))
        held = pixels_of(energy._shown[material.name_full])
        assert np.abs(held - expected).max() < 1.0 / 255.0
    material.plausible_brdf.exponent = 7.0
    assert texts(drawn(energy, context)) == texts(log)
    assert energy._wanted[material.name_full][0] != energy._shown[material.name_full].key


def test_nothing_is_asked_for_twice(bpy, energy):
    material = make("blinn", exponent=8.0)
    context = context_for(bpy, material)
    drawn(energy, context)
    energy.make_wanted()
    drawn(energy, context)
    assert not energy._wanted
    assert "more light than it gets" in texts(drawn(energy, context))


def test_colours_have_three_numbers(bpy, energy):
    material = make("disk_scaling", base_color=(0.5, 0.25, 0.125), f90=(0.5, 0.25, 0.125))
    context = context_for(bpy, material)
    drawn(energy, context)
    energy.make_wanted()
    words = texts(drawn(energy, context))
    assert words.count("R 0.500") == words.count("G 0.250") == words.count("B 0.125") == 3
    assert "Seen along the tangent" in words and "more light" not in words


def test_several_materials(bpy, energy):
    """Each has its own plot; of many only those shown last are kept, in no more previews than these need."""
    many = [make("disk_scaling", name=f"M{i}", exponent=10.0 + i) for i in range(energy.KEPT + 3)]
    contexts = [context_for(bpy, material) for material in many]
    for context in contexts[:2]:
        drawn(energy, context)
    energy.make_wanted()
    first, second = (energy._shown[material.name_full] for material in many[:2])
    assert first.plot.lobes[0].peak < second.plot.lobes[0].peak
    assert {id(half) for half in first.halves}.isdisjoint(id(half) for half in second.halves)
    for context in contexts:
        drawn(energy, context)
        energy.make_wanted()
    assert len(energy._shown) == energy.KEPT and len(energy._previews) == 2 * energy.KEPT
    assert many[-1].name_full in energy._shown and many[2].name_full not in energy._shown


def test_links_are_named(bpy, energy):
    from addon.blender.material import sockets

    material = make("pumped_blinn")
    node = plausible_node(material)[0]
    noise = material.node_tree.nodes.new("ShaderNodeTexNoise")
    noise.label = "Scratches"
    socket = sockets.by_id(node)["exponent"]
    material.node_tree.links.new(noise.outputs[0], socket)
    words = texts(drawn(energy, context_for(bpy, material)))
    assert "Exponent is driven by Scratches: plotted for" in words and words.count("driven") == 1


def test_an_image_that_cannot_be_read(bpy, energy, no_weights, tmp_path):
    from addon.blender.material import sockets

    material = make("ndf_map")
    node = plausible_node(material)[0]
    sockets.by_id(node)["image"].default_value = str(tmp_path / "gone.exr")
    context = context_for(bpy, material)
    drawn(energy, context)
    energy.make_wanted()
    log = drawn(energy, context)
    assert "gone.exr" in texts(log) and not icons(log)
    assert not energy._wanted


@pytest.mark.parametrize("model_id", brdf.MODELS)
def test_every_model(bpy, energy, no_weights, model_id):
    material = make(model_id)
    before = {name: len(getattr(bpy.data, name)) for name in ("images", "textures", "brushes", "materials")}
    for width in (180, 400, 1500):
        context = context_for(bpy, material)
        context.region.width = width
        drawn(energy, context)
        energy.make_wanted()
        assert len(icons(drawn(energy, context))) == 2
    assert before == {name: len(getattr(bpy.data, name)) for name in before}


def test_nothing_is_left_behind():
    """Timer, previews and plots go with the add-on, also when it is switched on again."""
    import bpy

    import addon
    from addon.blender.ui import energy

    for _ in range(2):
        addon.register()
        material = make("blinn")
        drawn(energy, context_for(bpy, material))
        energy.make_wanted()
        material.plausible_brdf.exponent = 9.0
        drawn(energy, context_for(bpy, material))
        previews = energy._previews
        assert len(previews) == 2 and bpy.app.timers.is_registered(energy.make_wanted)
        addon.unregister()
        assert not bpy.app.timers.is_registered(energy.make_wanted)
        assert energy._previews is None and not energy._shown and not energy._wanted and not len(previews)
        assert not hasattr(bpy.types, "PLAUSIBLE_PT_energy") and not hasattr(bpy.types, "PLAUSIBLE_PT_node_energy")
        bpy.data.materials.remove(material)
