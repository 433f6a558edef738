"""Benchmarks of rendering, baking and waiting: ratios that are measured side by side in one run.

Each part is a module with three functions: `measure(effort, progress)` returns a report for JSON, `lines(report)`
yields its lines of text, `draw(report)` returns a Matplotlib figure. Times are medians of processor time.
"""
from dataclasses import dataclass

PARTS = {
    "render": "noise and time of the models beside Cycles' own closures, in a furnace, under lamps, in a room",
    "scaling": "time by samples per hit, resolution and number of materials",
    "bake": "error of an albedo by time and memory, beside Monte Carlo with a Sobol sequence and a plain grid",
    "startup": "compiling a shader, and the time to a first pixel",
    "luts": "bytes of the albedo tables by their error",
    "interface": "what the panel computes while a slider is dragged",
}


@dataclass(frozen=True)
class Effort:
    """The length of a measurement: `seconds` for each render, `repeats` of each."""

    seconds: float
    repeats: int


QUICK, USUAL = Effort(0.15, 3), Effort(0.5, 5)
