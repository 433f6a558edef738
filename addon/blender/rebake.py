"""Weights of baked models, made in the background when a material's values have rested: the window stays usable."""
import threading

import bpy

from ..baking import weights, weights_error
from . import nodes, osl
from .areas import redraw

REST = 0.3  # seconds that values rest before their weights are baked
_TICK = 0.1  # seconds between two looks at a bake
_jobs = {}  # material name -> _Job


def soon(material):
    """Bake a material's weights when its values have rested for a moment; a bake for older values is dropped."""
    name = material.name_full
    if name not in _jobs:
        _jobs[name] = _Job(name)
        bpy.app.timers.register(_jobs[name].look, first_interval=REST)
    _jobs[name].rest()


def is_running(material) -> bool:
    """Whether weights are being made for a material, or wait for its values to rest."""
    return material.name_full in _jobs


def stop():
    """Drop all bakes; what a thread still computes is thrown away."""
    for job in _jobs.values():
        if bpy.app.timers.is_registered(job.look):
            bpy.app.timers.unregister(job.look)
    _jobs.clear()


class _Job:
    """One material's bake. The thread never touches bpy; `look` runs in Blender's main loop until all is done."""

    def __init__(self, name):
        self.name, self.rested, self.values, self.work = name, False, None, None

    def rest(self):
        """Values have changed: wait for them to rest once more."""
        self.rested = False

    def look(self):
        """Seconds until the next look; None when there is nothing left to do, or it cannot be done: that is told."""
        try:
            return self._look()
        except (RuntimeError, ValueError, OSError) as error:  # as where a file of the extension is gone
            print(f"Plausible BRDF: {self.name}: {error}")
            return self._end()

    def _look(self):
        node = nodes.find_node(next((m for m in bpy.data.materials if m.name_full == self.name), None))
        if node is None or not nodes.is_stale(node):
            return self._end()
        if not self.rested:
            self.rested = True
            return REST
        if self.work is not None and self.work.is_alive():
            return _TICK
        values = nodes.values(node)
        if osl.is_kept(nodes.model_of(node), values):
            nodes.bake_weights(node)
            return self._end()
        if self.work is None or self.work.values != values:
            self.work = _Work(nodes.model_of(node), values)
            self.work.start()
            return _TICK
        if self.work.error is not None:  # the weights stay stale, which the panel shows
            print(f"Plausible BRDF: {self.name}: {self.work.error}")
        else:
            nodes.bake_weights(node, self.work.largest)  # at once: the thread's weights are kept
        return self._end()

    def _end(self):
        _jobs.pop(self.name, None)
        redraw()
        return None


class _Work(threading.Thread):
    """Bakes the weights of a model for values, and measures their error."""

    def __init__(self, model, values):
        super().__init__(name="Plausible BRDF weights", daemon=True)
        self.model, self.values = model, values
        self.largest, self.error = None, None

    def run(self):
        try:
            weights.weights(self.model, self.values)
            self.largest = weights_error.error(self.model, self.values).largest()
        except Exception as error:  # a thread has no caller: `look` tells
            self.error = error
