"""Weights of baked models, made in the background when a material's values have rested: the window stays usable."""
import threading

import bpy

from ...forms.rows import error as rows_error
from ...forms.rows import grid
from ..host.redraw import redraw
from . import baked_state, driven, groups

REST = 0.3  # seconds that values rest before their weights are baked
_TICK = 0.1  # seconds between two looks at a bake
_jobs = {}  # material name -> _Job
_given_up = {}  # material name -> (what its program was to be made for, see `baked_state.target`; why it was not)


def soon(material):
    """Bake a material's weights when its values have rested for a moment; a bake for older values is dropped."""
    name = material.name_full
    _given_up.pop(name, None)
    if name not in _jobs:
        _jobs[name] = _Job(name)
        _jobs[name].start()
    _jobs[name].rest()


def follow(material, node):
    """`soon`, where a material's node is stale, unless a bake for what it holds was cancelled or failed before."""
    if baked_state.is_stale(node) and _given_up.get(material.name_full, (None,))[0] != baked_state.target(node):
        soon(material)


def where_stale(node):
    """Bake a node's weights where they are for other values: soon, or at once where nothing is done later.

    Raises as `baked_state.bake`.
    """
    if not baked_state.is_stale(node):
        return
    material = groups.material_of(node)
    if bpy.app.background or material is None:
        baked_state.bake(node)
    else:
        soon(material)


def settle(node):
    """Note what a node that `baked_state.take_over` made is baked for, or bake it over the ranges of what drives it."""
    if not driven.ranges(node):
        baked_state.record(node)
    where_stale(node)


def is_running(material) -> bool:
    """Whether weights are being made for a material, or wait for its values to rest."""
    return material.name_full in _jobs


def progress(material) -> tuple:
    """(done, total) sets of weights of a material's bake; (0, 1) before it begins."""
    job = _jobs.get(material.name_full)
    return job.work.progress if job and job.work else (0, 1)


def problem(material, node) -> str | None:
    """Why a material's weights could not be made for what its node holds, where that was tried."""
    wanted, reason = _given_up.get(material.name_full, (None, None))
    return reason if reason and wanted == baked_state.target(node) else None


def cancel(material):
    """Drop a material's bake: its weights stay as they are, until its values change again."""
    job = _jobs.get(material.name_full)
    if job is not None:
        job.drop()
        _given_up[job.name] = baked_state.target(groups.find_node(material)), None


def stop():
    """Drop all bakes; what a thread still computes is thrown away."""
    for job in list(_jobs.values()):
        job.drop()
    _given_up.clear()


class _Dropped(Exception):
    """The bake is not wanted any longer."""


class _Job:
    """One material's bake. The thread never touches bpy; `look` runs in Blender's main loop until all is done."""

    def __init__(self, name):
        self.name, self.rested, self.work = name, False, None
        self.timer = self.look  # Blender knows a timer by the object

    def start(self):
        """Begin to look, also on when another file is opened, as that has materials of its own."""
        bpy.app.timers.register(self.timer, first_interval=REST, persistent=True)

    def rest(self):
        """Values have changed: wait for them to rest once more."""
        self.rested = False

    def drop(self):
        """End without a result."""
        if bpy.app.timers.is_registered(self.timer):
            bpy.app.timers.unregister(self.timer)
        self._end()

    def look(self):
        """Seconds until the next look; None when there is nothing left to do, or it cannot be done: that is told."""
        if _jobs.get(self.name) is not self:
            return None
        try:
            return self._look()
        except (RuntimeError, ValueError, OSError) as error:  # as where a file of the extension is gone
            return self._fail(error)

    def _look(self):
        node = groups.find_node(next((m for m in bpy.data.materials if m.name_full == self.name), None))
        if node is None or not baked_state.is_stale(node):
            return self._end()
        if not self.rested:
            self.rested = True
            return REST
        wanted = baked_state.target(node)
        if self.work is not None and self.work.is_alive():
            self.work.dropped = self.work.wanted != wanted
            redraw()
            return _TICK
        if groups.backend_of(node).is_cached(groups.model_of(node), *wanted):
            baked_state.bake(node)
            return self._end()
        if self.work is None or self.work.wanted != wanted or isinstance(self.work.error, _Dropped):
            self.work = _Work(groups.model_of(node), wanted)
            self.work.start()
            return _TICK
        if self.work.error is not None:  # the weights stay stale, which the panel shows
            return self._fail(self.work.error, wanted)
        baked_state.bake(node, self.work.largest)  # at once: the thread's weights are kept
        return self._end()

    def _fail(self, error, wanted=None):
        if wanted is not None:
            _given_up[self.name] = wanted, str(error)
        print(f"Plausible BRDF: {self.name}: {error}")
        return self._end()

    def _end(self):
        if self.work is not None:
            self.work.dropped = True
        _jobs.pop(self.name, None)
        redraw()
        return None


class _Work(threading.Thread):
    """Bakes the weights of a model for (values, ranges of the driven), and measures their error."""

    def __init__(self, model, wanted):
        super().__init__(name="Plausible BRDF weights", daemon=True)
        self.model, self.wanted = model, wanted
        self.largest, self.error = None, None
        self.progress, self.dropped = (0, 1), False

    def run(self):
        try:
            grid.bake(self.model, *self.wanted, tell=self._tell)
            self.largest = rows_error.largest(self.model, *self.wanted)
        except Exception as error:  # a thread has no caller: `look` tells
            self.error = error

    def _tell(self, *progress):
        self.progress = progress
        if self.dropped:
            raise _Dropped("the bake was dropped")
