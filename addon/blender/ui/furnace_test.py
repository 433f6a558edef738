"""The furnace test of a material: rendered small under a white sky, beside what its formula says.

Another Blender renders it, without a window: the scene that is open, its render result and its undo stay as they are.
"""
import json
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import bpy
import bpy.utils.previews
import numpy as np

from ...plots import picture, quick
from ...resources import ROOT
from ..host.redraw import redraw
from ..host.translation import tr
from ..material import groups, sockets
from .operators.common import OnMaterial, material_of, plausible_node, renders_here
from .panels import Face, draw_text, in_both_places

SAMPLES = 256
_TICK = 0.1
# What the other Blender runs: the command line's furnace, whose report goes into a file as Blender prints, too.
_SCRIPT = """
import contextlib, os, sys
sys.path.insert(0, {root!r})
from addon import cli
with open({report!r}, "w", encoding="utf-8") as file, contextlib.redirect_stdout(file):
    code = cli.main({arguments!r})
sys.stderr.flush()
os._exit(code)
"""

job = None  # the test that runs, or the last one
_previews = None  # its picture


class FurnaceJob:
    """A furnace test in a process of its own. `rows` are its results, {angle_deg, measured, noise, and, where the
    material has a formula, reference and verdict}; `error` tells what went wrong."""

    def __init__(self, material):
        self.name = material.name_full
        node = groups.find_node(material)
        self.of = groups.model_of(node), sockets.values(node)  # what is tested, which may change meanwhile
        self.rows, self.verdict, self.error, self.cancelled = [], None, "", False
        self.done, self.total = 0, 1
        self._folder = tempfile.TemporaryDirectory(prefix="plausible-")
        blend, self._report = (Path(self._folder.name) / name for name in ("material.blend", "report.json"))
        bpy.data.libraries.write(str(blend), {material}, path_remap="ABSOLUTE", fake_user=True)
        arguments = ["furnace", "--blend", str(blend), "--material", material.name, "--samples", str(SAMPLES), "--json",
                     "--progress"]
        script = _SCRIPT.format(root=str(ROOT), report=str(self._report), arguments=arguments)
        self._process = subprocess.Popen(_blender(script), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                         stderr=subprocess.PIPE, text=True, encoding="utf-8", errors="replace")
        self._said = []
        self._reader = threading.Thread(target=self._listen, name="Plausible BRDF furnace", daemon=True)
        self._reader.start()

    def _listen(self):
        for line in self._process.stderr:
            words = line.split()
            if line.startswith("furnace: render "):
                self.done, self.total = int(words[2]), int(words[4])
            else:
                self._said.append(line.strip())

    @property
    def running(self):
        return self._process.poll() is None

    def cancel(self):
        """End the other Blender."""
        if self.running:
            self.cancelled = True
            self._process.kill()

    def finish(self):
        """Wait for the end, and read the results."""
        self._process.wait()
        self._reader.join()
        if not self.cancelled:
            self._read()
        self._folder.cleanup()

    def _read(self):
        try:
            report = json.loads(self._report.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            told = [line for line in self._said if line.startswith("plausible furnace:")]
            self.error = (told or self._said or ["the other Blender ended without a word"])[-1]
            return
        self.rows, self.verdict = report["rows"], report["verdict"]
        if self.verdict is not None:
            _show(self)


def _blender(script):
    """The command that runs a Python script in another Blender of this kind, with factory settings."""
    if not bpy.app.binary_path:  # Blender as a Python module
        return [sys.executable, "-c", script]
    return [bpy.app.binary_path, "--background", "--factory-startup", "--python-expr", script]


def _show(done):
    """Draw what was measured over the formula's curve."""
    global _previews
    if bpy.app.background:  # where nobody sees it
        return
    views, measured, noise = (np.array([row[key] for row in done.rows]) for key in ("angle_deg", "measured", "noise"))
    pixels = picture.draw_furnace(quick.plot(*done.of), views, measured, noise)
    if _previews is None:
        _previews = bpy.utils.previews.new()
        _previews.new("furnace")
    _previews["furnace"].image_size = pixels.shape[1::-1]
    _previews["furnace"].image_pixels_float.foreach_set(pixels.ravel())


def stop():
    """End the test that runs, and forget results and picture."""
    global job, _previews
    if job is not None and job.running:
        job.cancel()
        job.finish()
    job = None
    if _previews is not None:
        bpy.utils.previews.remove(_previews)
        _previews = None


class PLAUSIBLE_OT_furnace_test(OnMaterial, bpy.types.Operator):
    """Render the material small under a white sky, in another Blender, and compare its albedo with the formula"""

    bl_idname = "plausible.furnace_test"
    bl_label = "Furnace Test"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        if job is not None and job.running:
            cls.poll_message_set("A test is running")
            return False
        node = plausible_node(material_of(context))[0]
        return super().poll(context) and renders_here(cls, groups.backend_of(node))

    def invoke(self, context, event):
        if not self._start(context):
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS" and job is not None:
            job.cancel()
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if job is not None and job.running:
            context.workspace.status_text_set(f"{progress_text(job)}   Esc: cancel")
            redraw()
            return {"PASS_THROUGH"}
        self.cancel(context)
        return self._end()

    def execute(self, context):
        """To the end before returning: for scripts and background mode."""
        return self._end() if self._start(context) else {"CANCELLED"}

    def cancel(self, context):
        """The timer and the words in the status bar go, also where Blender ends the operator."""
        context.window_manager.event_timer_remove(self._timer)
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        redraw()

    def _start(self, context):
        global job
        stop()
        try:
            job = FurnaceJob(material_of(context))
        except (RuntimeError, OSError) as error:
            self.report({"ERROR"}, f"The furnace test cannot start: {error}")
            return False
        return True

    def _end(self):
        if job is None:
            return {"CANCELLED"}
        job.finish()
        if job.cancelled:
            self.report({"WARNING"}, "The furnace test is cancelled")
            return {"CANCELLED"}
        if job.error:
            self.report({"ERROR"}, job.error)
            return {"CANCELLED"}
        self.report({"INFO"}, verdict_text(job))
        return {"FINISHED"}


class PLAUSIBLE_OT_cancel_furnace_test(bpy.types.Operator):
    """End the furnace test"""

    bl_idname = "plausible.cancel_furnace_test"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context):
        return job is not None and job.running

    def execute(self, context):
        job.cancel()
        return {"FINISHED"}


def progress_text(job) -> str:
    """How far the test is, for panel and status bar."""
    if not job.done:
        return tr("Furnace test, starting")
    return tr("Furnace test, render {done} of {total}", done=job.done, total=job.total)


_WRONG = "The furnace differs from the formula: at most {most:.4f} off, at {view:g}°"


def verdict_text(job) -> str:
    """What the test found, in a sentence."""
    if job.verdict is None:
        return tr("Measured; there is no formula for a material with something plugged in or mixed")
    worst = max((abs(a - b), row["angle_deg"]) for row in job.rows
                for a, b in zip(row["measured"], row["reference"], strict=True))
    words = {"ok": "The furnace agrees with the formula: at most {most:.4f} off, at {view:g}°",
             "noisy": "Too noisy to tell: at most {most:.4f} off, at {view:g}°"}
    return tr(words.get(job.verdict, _WRONG), most=worst[0], view=worst[1])


class _FurnaceTest(Face):
    bl_label = "Furnace Test"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, material, node, model = self.begin(context)
        if job is not None and job.running:
            row = layout.row(align=True)
            row.progress(factor=job.done / job.total, text=progress_text(job))
            row.operator("plausible.cancel_furnace_test", text="", icon="X")
            return
        layout.operator("plausible.furnace_test", icon="LIGHT_HEMI")
        if job is not None and job.name == material.name_full and job.rows:
            draw_results(layout, context, job, (model, sockets.values(node)) == job.of)


def draw_results(layout, context, done, is_current):
    """Verdict, picture and numbers of a test."""
    if not is_current:
        draw_text(layout, context, "Measured for other values than now", "TIME")
    draw_text(layout, context, verdict_text(done), "CHECKMARK" if done.verdict in ("ok", None) else "ERROR")
    if _previews is not None and done.verdict is not None:
        row = layout.row()
        row.alignment = "CENTER"
        row.template_icon(icon_value=_previews["furnace"].icon_id, scale=9.0)
    column = layout.column(align=True)
    for result in done.rows:
        row = column.row()
        row.label(text=f"{result['angle_deg']:g}°")
        row.label(text=_numbers(result["measured"]))
        if done.verdict is not None:
            row.label(text=_numbers(result["reference"]))


def _numbers(channels):
    """One number where all channels are alike, else three."""
    alike = max(channels) - min(channels) < 5e-4
    return "  ".join(f"{value:.3f}" for value in (channels[:1] if alike else channels))


CLASSES = (PLAUSIBLE_OT_furnace_test, PLAUSIBLE_OT_cancel_furnace_test, *in_both_places((_FurnaceTest,)))
