"""The furnace test of the panel: another Blender renders the material, and this one's scene stays as it is."""
import numpy as np
import pytest

from addon import create_material
from addon.brdf import MODELS

pytestmark = [pytest.mark.blender, pytest.mark.versions]


@pytest.fixture
def job(bpy):
    """Runs the test on a material; returns the job."""
    from addon.blender.ui import furnace_test

    def run(material):
        with bpy.context.temp_override(material=material):
            assert bpy.ops.plausible.furnace_test() == {"FINISHED"}
        return furnace_test.job

    yield run
    furnace_test.stop()


def test_it_measures_what_the_formula_says(bpy, job):
    from addon.blender.ui import furnace_test

    colour = (0.9, 0.5, 0.25)
    before = (len(bpy.data.scenes), len(bpy.data.materials), bpy.context.scene.frame_current)
    done = job(create_material("pumped_blinn", "möbel / 2", exponent=30.0, base_color=colour))
    assert (len(bpy.data.scenes), len(bpy.data.materials) - 1, bpy.context.scene.frame_current) == before
    assert done.verdict == "ok" and (done.done, done.total) == (len(done.rows), len(done.rows))
    for row in done.rows:
        albedo = MODELS["pumped_blinn"].albedo([np.cos(np.radians(row["angle_deg"]))], exponent=30.0, base_color=colour)
        np.testing.assert_allclose(row["reference"], albedo[0], rtol=1e-5)
        np.testing.assert_allclose(row["measured"], albedo[0], atol=0.01)
    assert "agrees with the formula" in furnace_test.verdict_text(done)


def test_a_wrong_shader_is_found_out(bpy, job):
    """The shader of another model, put in behind the back of the node that says what the formula is."""
    from addon.blender.backend import osl
    from addon.blender.material import groups
    from addon.blender.ui import furnace_test

    material = create_material("pumped_phong", exponent=30.0)
    script = osl.script_of(groups.find_node(material))
    osl.fill(script, osl.Osl().program(MODELS["phong"]).content)  # it lacks the sockets of pumps
    done = job(material)
    assert done.verdict == "FAILED" and "differs from the formula" in furnace_test.verdict_text(done)


def test_what_is_plugged_in_has_no_formula(bpy, job):
    from addon.blender.material import groups, sockets
    from addon.blender.ui import furnace_test

    material = create_material("phong")
    value = material.node_tree.nodes.new("ShaderNodeValue")
    value.outputs[0].default_value = 30.0
    material.node_tree.links.new(value.outputs[0], sockets.by_id(groups.find_node(material))["exponent"])
    done = job(material)
    assert done.verdict is None and "no formula" in furnace_test.verdict_text(done) and len(done.rows) > 3


def test_it_can_be_cancelled(bpy):
    from addon.blender.ui import furnace_test

    furnace_test.job = furnace_test.FurnaceJob(create_material("phong"))
    assert furnace_test.job.running and not bpy.ops.plausible.furnace_test.poll()
    assert bpy.ops.plausible.cancel_furnace_test() == {"FINISHED"}
    furnace_test.job.finish()
    assert furnace_test.job.cancelled and not furnace_test.job.rows
    furnace_test.stop()
    assert furnace_test.job is None


def test_a_blender_that_fails_is_told_in_words(bpy, monkeypatch):
    from addon.blender.ui import furnace_test

    monkeypatch.setattr(furnace_test, "_SCRIPT", "import sys; sys.exit('this Blender has no heart')")
    with pytest.raises(RuntimeError, match="this Blender has no heart"), bpy.context.temp_override(
            material=create_material("phong")):
        bpy.ops.plausible.furnace_test()
