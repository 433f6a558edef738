"""The efficiency of a material's render, 1 / (relative variance x seconds), side by side with other materials.

Twice the samples halve the variance and double the time, so the efficiency does not depend on the number of samples.
The ratio of two efficiencies is the ratio of the times for the same noise. Pixels are filtered as usual: pixels that
see a single point would favor closures that have no noise there.
"""
import contextlib
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...measure import standards
from ...measure.scene import BALL, SUN_ENERGY, MeasureError, MeasuringScene, require_blender

FURNACE, SKY, AREA, SUN, FULL = "furnace", "hdri", "area", "sun", "room"
SCENES = (FURNACE, SKY, AREA, SUN, FULL)
LAMP_DIRECTION = (0.36, 0.48, 0.8)
LAMP_SIZE, LAMP_DISTANCE = 0.5, 3.5  # meters; the sphere's radius is 1
FLOOR = 0.5  # reflectance of the room's floor
BOUNCES = 4  # in the room


@dataclass(frozen=True)
class Candidate:
    """A material to measure. `osl` is off for Cycles' own nodes, which usually run in SVM."""

    title: str
    material: object
    osl: bool = True


@dataclass(frozen=True)
class Efficiency:
    """The measurement of one material: `spp` samples in `seconds` gave a picture of `relative_variance`."""

    title: str
    relative_variance: float
    seconds: float
    spp: int

    @property
    def value(self) -> float:
        """1 / (relative variance x seconds), infinite without noise."""
        cost = self.relative_variance * self.seconds
        return 1.0 / cost if cost > 0.0 else math.inf

    def compared_with(self, other) -> float | None:
        """This efficiency over the `other`'s; None where either has next to no noise, as a closure under a sun."""
        if min(self.relative_variance, other.relative_variance) * self.spp < 1e-9:
            return None
        return self.value / other.value


def hdri_of_blender() -> str:
    """Path of an HDRI that comes with Blender. Raises MeasureError where it is missing."""
    bpy = require_blender()
    path = Path(bpy.utils.resource_path("LOCAL")) / "datafiles" / "studiolights" / "world" / "courtyard.exr"
    if not path.is_file():
        raise MeasureError(f"this Blender lacks the HDRI {path.name}: name another")
    return str(path)


def measure(candidates, scene: str, effort, resolution=64, hdri=None) -> list:
    """Efficiencies of `candidates` (Candidate) on a sphere in one of SCENES, in the same order.

    The materials take turns, so that a slower machine slows all of them. Times are processor times, summed over
    threads, so that other programs count little. The median time of a render of one sample is subtracted, so that
    loading the scene and compiling the shader do not count. All candidates take the number of samples that the first
    renders in `effort.seconds`. Raises ValueError for an unknown scene or fewer than two repeats.
    """
    if scene not in SCENES:
        raise ValueError(f"no scene {scene!r}; there are {', '.join(SCENES)}")
    if effort.repeats < 2:
        raise ValueError(f"repeats: {effort.repeats} is too few to tell a variance")
    with contextlib.ExitStack() as stack:
        stages = [stack.enter_context(_lit(candidate, scene, resolution, hdri)) for candidate in candidates]
        for stage in stages:
            stage.render(1)  # compiles the shader and loads the geometry
        spp = _samples_for(stages[0], effort.seconds)
        pictures, long, short = [[] for _ in stages], [[] for _ in stages], [[] for _ in stages]
        for seed in range(effort.repeats):
            for i, stage in enumerate(stages):
                stage.render(1)  # Blender keeps one scene loaded: this render loads it again
                short[i].append(timed(stage, 1, seed)[0])
                elapsed, picture = timed(stage, spp, seed)
                long[i].append(elapsed)
                pictures[i].append(picture)
    # The full scene fills the picture, the sphere a part of it.
    seen = np.ones((resolution, resolution), dtype=bool) if scene == FULL else _covered(resolution)
    return [Efficiency(c.title, _relative_variance(np.array(p)[:, seen]), max(np.median(a) - np.median(b), 1e-6), spp)
            for c, p, a, b in zip(candidates, pictures, long, short, strict=True)]


@contextlib.contextmanager
def _lit(candidate, scene, resolution, hdri):
    """A measuring scene with the candidate on a sphere, lit as in one of SCENES."""
    with MeasuringScene(candidate.material, BALL, resolution) as stage:
        stage.scene.cycles.shading_system = candidate.osl
        if scene == FURNACE:
            stage.sky(1.0)
        if scene in (SKY, FULL):
            stage.sky(1.0, hdri or hdri_of_blender())
        if scene in (AREA, FULL):
            stage.shine("AREA", LAMP_DIRECTION, energy=100.0, size=LAMP_SIZE, distance=LAMP_DISTANCE)
        if scene == SUN:
            stage.shine("SUN", LAMP_DIRECTION, energy=SUN_ENERGY, angle=0.0)
        if scene == FULL:
            stage.floor(standards.native("DIFFUSE", reflectance=FLOOR))
            stage.bounces(BOUNCES)
            stage.look_from((0.0, -0.8, 0.6), 4.0)
        else:
            stage.look_from((0.0, 0.0, 1.0), 2.0)
        yield stage


def timed(stage, samples, seed=0):
    """(processor seconds, picture) of a render of a `MeasuringScene`."""
    start = time.process_time()
    picture = stage.render(samples, seed)
    return time.process_time() - start, picture


def _samples_for(stage, seconds):
    """The number of samples that take `seconds`; doubles the samples until their time is measurable."""
    empty = min(timed(stage, 1, seed)[0] for seed in range(2))
    samples = 16
    while True:
        elapsed = timed(stage, samples)[0] - empty
        if elapsed > 0.4 * seconds or samples >= 1 << 14:
            return max(int(samples * seconds / max(elapsed, 1e-3)), 4)
        samples *= 2


def _covered(resolution):
    """Mask (H, W) of the pixels that see the sphere, without its rim."""
    centers = 2.0 * ((np.arange(resolution) + 0.5) / resolution - 0.5)
    return centers[:, None] ** 2 + centers**2 < 0.99**2


def _relative_variance(pictures):
    """Variance between the pictures (seeds, P, 3), summed over all pixels, over the sum of the squared means."""
    return float(pictures.var(axis=0, ddof=1).sum() / (pictures.mean(axis=0) ** 2).sum())
