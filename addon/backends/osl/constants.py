"""The numbers that Python and the shaders share: each stands once, in Python, and is written out as a macro of OSL.

`SHARED` is the list. What is put in per model, such as the length of a table, is declared in `definitions.py`.
"""
from typing import NamedTuple

import numpy as np

from ...forms import bells, closures
from ...forms.albedo import tables
from ...forms.rows import layout, lobe_rows
from ...models import fresnel, parameters

# What `source` writes before a set's rows, and of each facet.
ROW_HEAD = ("stretch of rings along x", "along y", "brightness")
ROW_FACET = ("slope x", "slope y", "width x", "width y", "red", "green", "blue")


class Constant(NamedTuple):
    """A number, and what it is, as a comment of the header says it."""

    value: float
    comment: str


SHARED = {
    # Inputs: addon/models/parameters.py, addon/models/fresnel.py.
    "MIN_EXPONENT": Constant(parameters.MIN_EXPONENT, "exponents of lobes go from here"),
    "MAX_EXPONENT": Constant(parameters.MAX_EXPONENT, "to here"),
    "LEAST_ROUGHNESS": Constant(parameters.LEAST_ROUGHNESS, "smaller roughnesses are taken for it"),
    "BECKMANN_POWER": Constant(parameters.BECKMANN_POWER, "this / alpha^2 - this is the exponent of a roughness"),
    "FRESNEL_CONSTANT": Constant(fresnel.CONSTANT, "kinds of the colour factor"),
    "FRESNEL_SCHLICK": Constant(fresnel.SCHLICK, ""),
    "FRESNEL_CONDUCTOR": Constant(fresnel.CONDUCTOR, ""),
    "LEAST_IOR": Constant(fresnel.LEAST_IOR, "n of a conductor, which is divided by"),
    # Albedo tables: addon/forms/albedo/tables.py.
    "TABLE_CHANNELS": Constant(tables.CHANNELS, "albedos, or radii, in a pixel"),
    "TABLE_SLACK": Constant(tables.SLACK, "part of an exponent by which it may be beyond a table's end"),
    "TABLE_MARK": Constant(tables.MARK, "first number of a marker row"),
    "TABLE_FORMAT": Constant(tables.FORMAT, "last number of a marker row"),
    # Closures of Cycles: addon/forms/closures.py.
    "LEVELS": Constant(closures.LEVELS, "colours of a phong_ramp"),
    "SLOTS": Constant(closures.SLOTS, "numbers of a ramp in the table of base lobes: its levels, and one more"),
    "SHARPEST": Constant(closures.SHARPEST, "exponent of a crease's phong_ramp"),
    "LEANEST": Constant(closures.LEANEST, "lean of a facet times the lobe's width"),
    "NARROWEST_FACET": Constant(closures.NARROWEST_FACET, "width: Cycles takes narrower facets for mirrors"),
    "LEAN_DOWN": Constant(closures.LEAN_DOWN, "a ramp's axis leans down by no more of the mirror direction's height"),
    "LEAN_MARGIN": Constant(closures.LEAN_MARGIN, "radians: that counts from here"),
    "LEAN_UP": Constant(closures.LEAN_UP, "radians: up, by this less than to the horizon on the view's side"),
    "CREASE_LEAN": Constant(closures.CREASE_LEAN, "least lean of a crease's axis, in the lobe's widths"),
    "CREASE_COSINE": Constant(closures.CREASE_COSINE, "least cosine of that lean"),
    "VIEW_SLOPE_SHARE": Constant(closures.VIEW_SLOPE_SHARE, "of the slope at the crease in a view's coordinate"),
    "NEGATIVE_EDGE": Constant(closures.NEGATIVE_EDGE, "where a negative kernel ends, in parts of its radius"),
    "PHONG_PER_HALF": Constant(closures.PHONG_PER_HALF, "exponent of the Phong lobe that is as wide, in parts"),
    "HALF_WIDTH": Constant(closures.HALF_WIDTH, "width of a half-vector lobe, times the root of its exponent"),
    "GRAZING_WIDTH": Constant(closures.GRAZING_WIDTH, "by which it stays wider at grazing"),
    # Bells on the disk: addon/forms/bells.py.
    "BELLS_PER_UNIT": Constant(bells.NODES, "nodes of the table of bells, besides the first"),
    "BELL_KNOTS": Constant(bells.KNOTS, "intervals of equal parts of what the bells leave"),
    "STEEP_FROM": Constant(bells.STEEP_FROM, "node from which there is a row for steep lumps"),
    "RING_0": Constant(bells.FEW[0], "bells of a lump's rings,"),
    "RING_1": Constant(bells.FEW[1], ""),
    "STEEP_RING_0": Constant(bells.MANY[0], "and of a steep one's"),
    "STEEP_RING_1": Constant(bells.MANY[1], ""),
    "STEEP_RING_2": Constant(bells.MANY[2], ""),
    "MOST_BELLS": Constant(1 + sum(bells.MANY), "of a lump: those, and one in the middle"),
    # Lobe rows: addon/forms/rows.
    "W_STEEPEST": Constant(layout.STEEPEST, "angle of the last row's view"),
    "W_CROWDED": Constant(layout.CROWDED, "how much denser rows are towards grazing"),
    "W_FACETS": Constant(lobe_rows.FACETS, "base microfacets of a row"),
    "W_FACET": Constant(len(ROW_FACET), "numbers of each: " + ", ".join(ROW_FACET)),
    "W_HEAD": Constant(len(ROW_HEAD), "numbers before a set's rows: " + ", ".join(ROW_HEAD)),
}


def literal(value) -> str:
    """A number as OSL reads it: to the same float, and a whole number as an int."""
    if isinstance(value, (bool, int, np.integer)):
        return str(int(value))
    return repr(float(value))


def header() -> str:
    """The text of `SHARED` as macros."""
    lines = [f"#define {name} {literal(value)}" + (f"  // {comment}" if comment else "")
             for name, (value, comment) in SHARED.items()]
    return "\n".join(lines) + "\n"
