"""The furnace test of a material: a small render under a white sky, compared with its formula's albedo.

Another Blender process renders it in background mode, so the open scene, its render result and its undo stack stay.
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

SAMPLES = 256  # per pixel
_TICK = 0.1  # seconds between two looks at the test
# The Python script of the other Blender: the command `furnace`. Blender prints to stdout, so the report goes to a file.
_SCRIPT = """
import contextlib, os, sys
sys.path.insert(0, {root!r})
from addon import cli
with open({report!r}, "w", encoding="utf-8") as file, contextlib.redirect_stdout(file):
    code = cli.main({arguments!r})
sys.stderr.flush()
os._exit(code)
"""

job = None  # the running test, or the last one, or None
_previews = None  # Blender's collection of previews, with the picture of the test


class FurnaceJob:
    """A furnace test in a process of its own.

    `rows` are its results: dictionaries with angle_deg, measured, noise, and, where the material has a formula,
    reference and verdict. `verdict` is that of all rows, None without a formula. `error` is a message, "" without
    errors. `of` is (model, values) of the tested material. `done` and `total` count renders.
    """

    def __init__(self, material):
        self.name = material.name_full
        node = groups.find_node(material)
        self.of = groups.model_of(node), sockets.values(node)  # at the start, as they may change during the test
        self.rows, self.verdict, self.error, self.cancelled = [], None, "", False
        self.done, self.total = 0, 1
        # Write the material into a .blend of its own.
        self._folder = tempfile.TemporaryDirectory(prefix="plausible-")
        blend, self._report = (Path(self._folder.name) / name for name in ("material.blend", "report.json"))
        bpy.data.libraries.write(str(blend), {material}, path_remap="ABSOLUTE", fake_user=True)
        # Start the other Blender, and a thread that reads its stderr.
        arguments = ["furnace", "--blend", str(blend), "--material", material.name, "--samples", str(SAMPLES), "--json",
                     "--progress"]
        script = _SCRIPT.format(root=str(ROOT), report=str(self._report), arguments=arguments)
        self._process = subprocess.Popen(_blender(script), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                         stderr=subprocess.PIPE, text=True, encoding="utf-8", errors="replace")
        self._messages = []  # lines of stderr other than progress
        self._reader = threading.Thread(target=self._listen, name="Plausible BRDF furnace", daemon=True)
        self._reader.start()

    def _listen(self):
        """Read the other Blender's stderr: progress lines "furnace: render <done> of <total>", and messages."""
        for line in self._process.stderr:
            words = line.split()
            if line.startswith("furnace: render "):
                self.done, self.total = int(words[2]), int(words[4])
            else:
                self._messages.append(line.strip())

    @property
    def running(self):
        return self._process.poll() is None

    def cancel(self):
        """Kill the other Blender, if it still runs."""
        if self.running:
            self.cancelled = True
            self._process.kill()

    def finish(self):
        """Wait for the end, and read the results unless the test was canceled."""
        self._process.wait()
        self._reader.join()
        if not self.cancelled:
            self._read()
        self._folder.cleanup()

    def _read(self):
        """Read the report, or find the error message in the other Blender's output."""
        try:
            report = json.loads(self._report.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            errors = [line for line in self._messages if line.startswith("plausible furnace:")]
            self.error = (errors or self._messages or ["the other Blender ended without a word"])[-1]
            return
        self.rows, self.verdict = report["rows"], report["verdict"]
        if self.verdict is not None:
            _draw_picture(self)


def _blender(script):
    """The command line that runs a Python script in another process of this Blender, with factory settings."""
    if not bpy.app.binary_path:  # Blender is a Python module
        return [sys.executable, "-c", script]
    return [bpy.app.binary_path, "--background", "--factory-startup", "--python-expr", script]


def _draw_picture(test):
    """Draw the measured albedos over the formula's curve, into a preview. Does nothing in background mode."""
    global _previews
    if bpy.app.background:
        return
    views, measured, noise = (np.array([row[key] for row in test.rows]) for key in ("angle_deg", "measured", "noise"))
    pixels = picture.draw_furnace(quick.plot(*test.of), views, measured, noise)
    if _previews is None:
        _previews = bpy.utils.previews.new()
        _previews.new("furnace")
    _previews["furnace"].image_size = pixels.shape[1::-1]
    _previews["furnace"].image_pixels_float.foreach_set(pixels.ravel())


def stop():
    """Cancel a running test, and drop results and picture."""
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
        """Run the whole test before returning: for scripts and background mode."""
        return self._end() if self._start(context) else {"CANCELLED"}

    def cancel(self, context):
        """Remove the timer and the status text. Blender calls this, too, when it ends the operator."""
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
    """The progress of the test, for panel and status bar."""
    if not job.done:
        return tr("Furnace test, starting")
    return tr("Furnace test, render {done} of {total}", done=job.done, total=job.total)


_WRONG = "The furnace differs from the formula: at most {most:.4f} off, at {view:g}°"


def verdict_text(job) -> str:
    """The result of the test, in a sentence."""
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
    """Draw verdict, picture and numbers of the test `done`."""
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
    """The channels as text: one number if all round to about the same, else three."""
    is_gray = max(channels) - min(channels) < 5e-4
    return "  ".join(f"{value:.3f}" for value in (channels[:1] if is_gray else channels))


CLASSES = (PLAUSIBLE_OT_furnace_test, PLAUSIBLE_OT_cancel_furnace_test, *in_both_places((_FurnaceTest,)))
