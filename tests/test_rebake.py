"""Weights that are baked beside: the job is looked at by hand, as timers do not run without a window."""
import threading
import time

import pytest
from blender_help.recorder import context_for, drawn, operators, texts

from addon import create_material

pytestmark = [pytest.mark.blender, pytest.mark.versions]


@pytest.fixture
def slow(no_weights, monkeypatch):
    """Weights that are made when `slow.set()` says so; each bake that begins is noted in `slow.begun`."""
    from addon.forms.rows import row_bake

    go, few = threading.Event(), row_bake.bake(None, None)
    go.begun = []

    def made(model, parameters, *_):
        go.begun.append(parameters)
        assert go.wait(20.0)
        return few

    monkeypatch.setattr(row_bake, "bake", made)
    return go


def looked_at(material, until, seconds=20.0):
    """Look at a material's job as the timer does, until something holds; returns whether it came to."""
    from addon.blender.material import row_jobs

    end = time.monotonic() + seconds
    while not until() and time.monotonic() < end:
        job = row_jobs._jobs.get(material.name_full)
        if job:
            job.look()
        time.sleep(0.01)
    return until()


def changed(material, value):
    """Write a socket behind our back, and have it baked soon."""
    from addon.blender.material import groups, row_jobs, sockets

    sockets.by_id(groups.find_node(material))["roughness"].default_value = value
    row_jobs.soon(material)
    return groups.find_node(material)


@pytest.fixture
def material(bpy, no_weights):
    return create_material("cook_torrance", roughness=0.2)


def test_values_that_rest_are_baked(material, slow):
    from addon.blender.material import baked_state, row_jobs

    node = changed(material, 0.3)
    assert baked_state.is_stale(node) and row_jobs.is_running(material)
    assert looked_at(material, lambda: slow.begun)
    slow.set()
    assert looked_at(material, lambda: not row_jobs.is_running(material))
    assert not baked_state.is_stale(node) and slow.begun[-1]["roughness"] == pytest.approx(0.3)


def test_older_values_are_dropped(material, slow):
    from addon.blender.material import baked_state, row_jobs

    node = changed(material, 0.3)
    assert looked_at(material, lambda: slow.begun)
    changed(material, 0.4)
    slow.set()
    assert looked_at(material, lambda: not row_jobs.is_running(material))
    assert not baked_state.is_stale(node) and slow.begun[-1]["roughness"] == pytest.approx(0.4)


def test_a_range_tells_its_progress_and_can_be_dropped_and_taken_up(bpy, material, slow):
    """Dropped by another value in the middle of its sets, and wanted again: it begins anew, and is no failure."""
    from addon.blender.material import baked_state, groups, row_jobs, sockets

    node = groups.find_node(material)
    tree = material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], sockets.by_id(node)["roughness"])
    row_jobs.soon(material)
    assert looked_at(material, lambda: slow.begun)
    done, total = row_jobs.progress(material)
    assert done == 0 and total > 2
    assert "plausible.cancel_weights" in operators(drawn(context_for(bpy, material)))
    work = row_jobs._jobs[material.name_full].work
    work.dropped = True
    slow.set()
    work.join()
    assert isinstance(work.error, row_jobs._Dropped) and len(slow.begun) == 1
    assert looked_at(material, lambda: not row_jobs.is_running(material))
    assert not baked_state.is_stale(node) and row_jobs.problem(material, node) is None


def test_cancel_leaves_the_weights_as_they_are(bpy, material, slow):
    from addon.blender.material import baked_state, row_jobs

    node = changed(material, 0.3)
    assert looked_at(material, lambda: slow.begun)
    job = row_jobs._jobs[material.name_full]
    assert bpy.app.timers.is_registered(job.timer)
    with bpy.context.temp_override(material=material):
        assert bpy.ops.plausible.cancel_weights() == {"FINISHED"}
    assert not bpy.app.timers.is_registered(job.timer) and job.look() is None and job.work.dropped
    slow.set()
    assert not row_jobs.is_running(material) and baked_state.is_stale(node)
    assert "The weights are for other values" in texts(drawn(context_for(bpy, material)))
    row_jobs.follow(material, node)  # as after any edit
    assert not row_jobs.is_running(material)
    changed(material, 0.35)
    assert row_jobs.is_running(material)


def test_what_cannot_be_baked_is_told_in_the_panel(bpy, material, slow, capsys):
    from addon.blender.material import baked_state, driven, groups, row_jobs, sockets

    slow.set()
    node = groups.find_node(material)
    tree = material.node_tree
    for name in ("roughness", "ior", "extinction"):
        value = tree.nodes.new("ShaderNodeValue")
        tree.links.new(value.outputs[0], sockets.by_id(node)[name])
    sockets.by_id(node)["fresnel_type"].default_value = 2
    assert len(driven.ranges(node)) == 3
    row_jobs.soon(material)
    assert looked_at(material, lambda: not row_jobs.is_running(material))
    words = texts(drawn(context_for(bpy, material)))
    assert "these are too many steps for one shader" in words and "Slope m" in words
    assert "too many steps" in capsys.readouterr().out
    row_jobs.follow(material, node)
    assert not row_jobs.is_running(material)  # it would fail again
    tree.links.remove(sockets.by_id(node)["ior"].links[0])
    tree.links.remove(sockets.by_id(node)["extinction"].links[0])
    row_jobs.soon(material)
    assert looked_at(material, lambda: not row_jobs.is_running(material)) and not baked_state.is_stale(node)
