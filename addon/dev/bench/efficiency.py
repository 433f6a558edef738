"""How much picture a material gives for the time: 1 / (relative variance x seconds), side by side with others.

Twice the samples halve the variance and double the time, so the figure does not depend on how many were taken, and the
ratio of two materials' figures tells how much longer one has to render for the same noise. Pixels are filtered as
usual: one that sees a single point would flatter closures that have no noise there.
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
    """A material to measure. `osl` is off for nodes that are rendered as everyone renders them, by Cycles' own SVM."""

    title: str
    material: object
    osl: bool = True


@dataclass(frozen=True)
class Efficiency:
    """What was measured of one material: `spp` samples in `seconds` gave a picture of `relative_variance`."""

    title: str
    relative_variance: float
    seconds: float
    spp: int

    @property
    def value(self) -> float:
        """1 / (relative variance x seconds), infinite where there is no noise."""
        cost = self.relative_variance * self.seconds
        return 1.0 / cost if cost > 0.0 else math.inf

    def compared_with(self, other) -> float | None:
        """This efficiency over the `other`'s; None where either has no noise to speak of, as a closure under a sun."""
        if min(self.relative_variance, other.relative_variance) * self.spp < 1e-9:
            return None
        return self.value / other.value


def hdri_of_blender() -> str:
    """An HDRI that comes with Blender. Raises MeasureError where it is missing."""
    bpy = require_blender()
    path = Path(bpy.utils.resource_path("LOCAL")) / "datafiles" / "studiolights" / "world" / "courtyard.exr"
    if not path.is_file():
        raise MeasureError(f"this Blender lacks the HDRI {path.name}: name another")
    return str(path)


def measure(candidates, scene: str, effort, resolution=64, hdri=None) -> list:
    """Efficiencies of `candidates` (Candidate) on a sphere in one of SCENES, in the same order.

    The materials take turns, so that a machine that slows down slows all of them. The time is the processors', summed
    over threads, so that other programs count little; it is the median render's less that of a render of one sample, so
    that loading the scene and compiling the shader do not count. All take as many samples as the first of them renders
    in the seconds of `effort`.
    """
    if scene not in SCENES:
        raise ValueError(f"no scene {scene!r}; there are {', '.join(SCENES)}")
    if effort.repeats < 2:
        raise ValueError(f"repeats: {effort.repeats} is too few to tell a variance")
    with contextlib.ExitStack() as stack:
        places = [stack.enter_context(_lit(candidate, scene, resolution, hdri)) for candidate in candidates]
        for place in places:
            place.render(1)  # compiled, and its geometry loaded
        spp = _samples_for(places[0], effort.seconds)
        pictures, long, short = [[] for _ in places], [[] for _ in places], [[] for _ in places]
        for seed in range(effort.repeats):
            for i, place in enumerate(places):
                place.render(1)  # Blender keeps one scene ready: the one whose turn it is
                short[i].append(timed(place, 1, seed)[0])
                elapsed, picture = timed(place, spp, seed)
                long[i].append(elapsed)
                pictures[i].append(picture)
    seen = np.ones((resolution, resolution), dtype=bool) if scene == FULL else _covered(resolution)
    return [Efficiency(c.title, _relative_variance(np.array(p)[:, seen]), max(np.median(a) - np.median(b), 1e-6), spp)
            for c, p, a, b in zip(candidates, pictures, long, short, strict=True)]


@contextlib.contextmanager
def _lit(candidate, scene, resolution, hdri):
    with MeasuringScene(candidate.material, BALL, resolution) as place:
        place.scene.cycles.shading_system = candidate.osl
        if scene == FURNACE:
            place.sky(1.0)
        if scene in (SKY, FULL):
            place.sky(1.0, hdri or hdri_of_blender())
        if scene in (AREA, FULL):
            place.shine("AREA", LAMP_DIRECTION, energy=100.0, size=LAMP_SIZE, distance=LAMP_DISTANCE)
        if scene == SUN:
            place.shine("SUN", LAMP_DIRECTION, energy=SUN_ENERGY, angle=0.0)
        if scene == FULL:
            place.floor(standards.native("DIFFUSE", reflectance=FLOOR))
            place.bounces(BOUNCES)
            place.look_from((0.0, -0.8, 0.6), 4.0)
        else:
            place.look_from((0.0, 0.0, 1.0), 2.0)
        yield place


def timed(place, samples, seed=0):
    """(processor seconds, picture) of a render of a `MeasuringScene`."""
    start = time.process_time()
    picture = place.render(samples, seed)
    return time.process_time() - start, picture


def _samples_for(place, seconds):
    """How many samples take `seconds`, by doubling until the time can be told."""
    empty = min(timed(place, 1, seed)[0] for seed in range(2))
    samples = 16
    while True:
        elapsed = timed(place, samples)[0] - empty
        if elapsed > 0.4 * seconds or samples >= 1 << 14:
            return max(int(samples * seconds / max(elapsed, 1e-3)), 4)
        samples *= 2


def _covered(resolution):
    centers = 2.0 * ((np.arange(resolution) + 0.5) / resolution - 0.5)
    return centers[:, None] ** 2 + centers**2 < 0.99**2


def _relative_variance(pictures):
    """Variance between the pictures (seeds, P, 3), summed over all pixels, over the sum of the squared means."""
    return float(pictures.var(axis=0, ddof=1).sum() / (pictures.mean(axis=0) ** 2).sum())
