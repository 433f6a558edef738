"""Background bakes of lobe rows, after a pause in the changes of a material's values. The window stays usable."""
import threading

import bpy

from ..host.redraw import redraw
from . import baked_state, driven, groups

REST = 0.3  # seconds without a change of values before their lobe rows are baked
_TICK = 0.1  # seconds between two looks at a bake
_jobs = {}  # full name of a material -> its _Job
# Bakes that failed or were canceled, by a material's full name: (`baked_state.target`, error message or None).
_not_retried = {}


def soon(material):
    """Bake a material's lobe rows after a pause of REST seconds. A running bake for older values is dropped."""
    name = material.name_full
    _not_retried.pop(name, None)
    if name not in _jobs:
        _jobs[name] = _Job(name)
        _jobs[name].start()
    _jobs[name].rest()


def follow(material, node):
    """As `soon` if the material's node is stale, unless a bake for the same values failed or was canceled before."""
    if baked_state.is_stale(node) and _not_retried.get(material.name_full, (None,))[0] != baked_state.target(node):
        soon(material)


def where_stale(node):
    """Bake a node's lobe rows if they are stale: as `soon`, or at once in background mode and inside a group.

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
    """Complete a node made by `baked_state.take_over`: record its values, or bake it over ranges if it is driven."""
    if not driven.ranges(node):
        baked_state.record(node)
    where_stale(node)


def is_running(material) -> bool:
    """Whether a bake of a material's lobe rows runs, or waits for a pause in the changes of its values."""
    return material.name_full in _jobs


def progress(material) -> tuple:
    """(done, total) nodes of the parameter grid in a material's bake; (0, 1) before it begins."""
    job = _jobs.get(material.name_full)
    return job.work.progress if job and job.work else (0, 1)


def problem(material, node) -> str | None:
    """The error of the bake for the present values of a material's node; None where no such bake failed."""
    target, reason = _not_retried.get(material.name_full, (None, None))
    return reason if reason and target == baked_state.target(node) else None


def cancel(material):
    """Cancel a material's bake. Its lobe rows stay as they are until its values change again."""
    job = _jobs.get(material.name_full)
    if job is not None:
        job.drop()
        _not_retried[job.name] = baked_state.target(groups.find_node(material)), None


def stop():
    """Drop all bakes, and the results of threads that still run."""
    for job in list(_jobs.values()):
        job.drop()
    _not_retried.clear()


class _Dropped(Exception):
    """Ends the thread of a bake that was dropped."""


class _Job:
    """The bake of one material: a thread, which never uses bpy, and the timer `look` in Blender's main loop."""

    def __init__(self, name):
        self.name = name
        self.rested = False  # whether the values have stayed the same for REST seconds
        self.work = None  # the latest _Work
        self.timer = self.look  # kept, as Blender identifies a timer by the function object

    def start(self):
        """Start the timer. It persists when another file is opened, where the job ends as its material is missing."""
        bpy.app.timers.register(self.timer, first_interval=REST, persistent=True)

    def rest(self):
        """Wait again for a pause, after a change of values."""
        self.rested = False

    def drop(self):
        """End the job without a result."""
        if bpy.app.timers.is_registered(self.timer):
            bpy.app.timers.unregister(self.timer)
        self._end()

    def look(self):
        """The timer: returns the seconds until the next call, or None at the end of the job. Prints errors."""
        if _jobs.get(self.name) is not self:
            return None
        try:
            return self._look()
        except (RuntimeError, ValueError, OSError) as error:  # for example a missing file of the extension
            return self._fail(error)

    def _look(self):
        """One step of the job; returns as `look`."""
        # End if the material is gone, or nothing is stale any more.
        node = groups.find_node(next((m for m in bpy.data.materials if m.name_full == self.name), None))
        if node is None or not baked_state.is_stale(node):
            return self._end()
        # Wait for a pause in the changes.
        if not self.rested:
            self.rested = True
            return REST
        # A running thread goes on, unless the values have changed since it started.
        target = baked_state.target(node)
        if self.work is not None and self.work.is_alive():
            self.work.dropped = self.work.target != target
            redraw()
            return _TICK
        # A cached program needs no thread.
        if groups.backend_of(node).is_cached(groups.model_of(node), *target):
            baked_state.bake(node)
            return self._end()
        # Start a thread if there is none for these values.
        if self.work is None or self.work.target != target or isinstance(self.work.error, _Dropped):
            self.work = _Work(groups.model_of(node), groups.backend_of(node), target)
            self.work.start()
            return _TICK
        # The thread has ended. After an error the rows stay stale, which the panel shows.
        if self.work.error is not None:
            return self._fail(self.work.error, target)
        # This is fast, as the backend keeps what the thread fetched.
        baked_state.bake(node, self.work.largest)
        return self._end()

    def _fail(self, error, target=None):
        """End the job with an error; it is remembered for `problem` if its `target` is known."""
        if target is not None:
            _not_retried[self.name] = target, str(error)
        print(f"Plausible BRDF: {self.name}: {error}")
        return self._end()

    def _end(self):
        if self.work is not None:
            self.work.dropped = True
        _jobs.pop(self.name, None)
        redraw()
        return None


class _Work(threading.Thread):
    """A thread that does the slow part of a program for `target`, see `baked_state.target`, and measures its error.

    `largest` is the program's error, see `baked_state.baked_error`; `error` the exception that ended the thread.
    """

    def __init__(self, model, backend, target):
        super().__init__(name="Plausible BRDF lobe rows", daemon=True)
        self.model, self.backend, self.target = model, backend, target
        self.largest, self.error = None, None
        self.progress = (0, 1)  # (done, total)
        self.dropped = False  # set by the main thread to end this one

    def run(self):
        try:
            self.backend.prefetch(self.model, *self.target, self._update_progress)
            self.largest = self.backend.error(self.model, *self.target)
        except Exception as error:  # a thread has no caller: `look` reports the error
            self.error = error

    def _update_progress(self, *progress):
        """Record (done, total). Raises _Dropped after the job was dropped."""
        self.progress = progress
        if self.dropped:
            raise _Dropped("the bake was dropped")
