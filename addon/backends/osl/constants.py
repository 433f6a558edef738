"""The numbers that Python and the shaders share. Each is in Python once, and becomes a macro of OSL.

`SHARED` is the list. `definitions.py` declares the macros that depend on the model, such as the length of a table.
"""
from typing import NamedTuple

import numpy as np

from ...forms import bells, closures
from ...forms.albedo import tables
from ...forms.rows import layout, lobe_rows
from ...models import fresnel, parameters

# The numbers before a set's rows.
ROW_HEAD = ("stretch of rings along x", "along y", "brightness")
# The numbers of a row's facet.
ROW_FACET = ("slope x", "slope y", "width x", "width y", "red", "green", "blue")


class Constant(NamedTuple):
    """A number, and its meaning, which becomes a comment of the header."""

    value: float
    comment: str


SHARED = {
    # Inputs: addon/models/parameters.py, addon/models/fresnel.py.
    "MIN_EXPONENT": Constant(parameters.MIN_EXPONENT, "least exponent of a lobe"),
    "MAX_EXPONENT": Constant(parameters.MAX_EXPONENT, "largest exponent of a lobe"),
    "LEAST_ROUGHNESS": Constant(parameters.LEAST_ROUGHNESS, "least roughness; smaller ones become this"),
    "BECKMANN_POWER": Constant(parameters.BECKMANN_POWER, "the exponent of a roughness is this / alpha^2 - this"),
    "FRESNEL_CONSTANT": Constant(fresnel.CONSTANT, "kinds of the color factor"),
    "FRESNEL_SCHLICK": Constant(fresnel.SCHLICK, ""),
    "FRESNEL_CONDUCTOR": Constant(fresnel.CONDUCTOR, ""),
    "LEAST_IOR": Constant(fresnel.LEAST_IOR, "least n of a conductor, which is a divisor"),
    # Albedo tables: addon/forms/albedo/tables.py.
    "TABLE_CHANNELS": Constant(tables.CHANNELS, "albedos, or radii, in a pixel"),
    "TABLE_SLACK": Constant(tables.SLACK, "part of an exponent by which it may lie beyond a table's end"),
    "TABLE_MARK": Constant(tables.MARK, "first number of a marker row"),
    "TABLE_FORMAT": Constant(tables.FORMAT, "last number of a marker row"),
    # Closures of Cycles: addon/forms/closures.py.
    "LEVELS": Constant(closures.LEVELS, "colors of a phong_ramp"),
    "SLOTS": Constant(closures.SLOTS, "numbers of a ramp in the table of base lobes: its levels, and one more"),
    "SHARPEST": Constant(closures.SHARPEST, "largest exponent of a crease's phong_ramp"),
    "LEANEST": Constant(closures.LEANEST, "largest lean of a facet times the lobe's width"),
    "NARROWEST_FACET": Constant(closures.NARROWEST_FACET, "least width: Cycles treats narrower facets as mirrors"),
    "LEAN_DOWN": Constant(closures.LEAN_DOWN,
                          "largest lean of a ramp's axis down, over the mirror direction's height"),
    "LEAN_MARGIN": Constant(closures.LEAN_MARGIN, "radians: that height counts from here"),
    "LEAN_UP": Constant(closures.LEAN_UP, "radians: largest lean up, this less than to the view's horizon"),
    "CREASE_LEAN": Constant(closures.CREASE_LEAN, "least lean of a crease's axis, in the lobe's widths"),
    "CREASE_COSINE": Constant(closures.CREASE_COSINE, "least cosine of that lean"),
    "VIEW_SLOPE_SHARE": Constant(closures.VIEW_SLOPE_SHARE, "share of the crease's slope in a view's coordinate"),
    "NEGATIVE_EDGE": Constant(closures.NEGATIVE_EDGE, "where a negative kernel ends, in parts of its radius"),
    "PHONG_PER_HALF": Constant(closures.PHONG_PER_HALF, "exponent of a Phong lobe over a half-vector lobe's"),
    "HALF_WIDTH": Constant(closures.HALF_WIDTH, "width of a half-vector lobe times the root of its exponent"),
    "GRAZING_WIDTH": Constant(closures.GRAZING_WIDTH, "cosine by which it is wider at grazing, in its widths"),
    # Bells on the disk: addon/forms/bells.py.
    "BELLS_PER_UNIT": Constant(bells.NODES, "nodes of the table of bells, without the first"),
    "BELL_KNOTS": Constant(bells.KNOTS, "intervals of equal parts of the bells' residual"),
    "STEEP_FROM": Constant(bells.STEEP_FROM, "first node with a row for steep lumps"),
    "RING_0": Constant(bells.FEW[0], "bells of each ring of a lump"),
    "RING_1": Constant(bells.FEW[1], ""),
    "STEEP_RING_0": Constant(bells.MANY[0], "bells of each ring of a steep lump"),
    "STEEP_RING_1": Constant(bells.MANY[1], ""),
    "STEEP_RING_2": Constant(bells.MANY[2], ""),
    "MOST_BELLS": Constant(1 + sum(bells.MANY), "bells of a steep lump, with the one in the middle"),
    # Lobe rows: addon/forms/rows.
    "W_STEEPEST": Constant(layout.STEEPEST, "angle of the last row's view, in radians"),
    "W_CROWDED": Constant(layout.CROWDED, "how much denser rows are towards grazing"),
    "W_FACETS": Constant(lobe_rows.FACETS, "base microfacets of a row"),
    "W_FACET": Constant(len(ROW_FACET), "numbers of each facet: " + ", ".join(ROW_FACET)),
    "W_HEAD": Constant(len(ROW_HEAD), "numbers before a set's rows: " + ", ".join(ROW_HEAD)),
}


def literal(value) -> str:
    """A number in OSL, which reads back as the same float, or as an int for a whole number."""
    if isinstance(value, (bool, int, np.integer)):
        return str(int(value))
    return repr(float(value))


def header() -> str:
    """`SHARED` as lines that define macros."""
    lines = [f"#define {name} {literal(value)}" + (f"  // {comment}" if comment else "")
             for name, (value, comment) in SHARED.items()]
    return "\n".join(lines) + "\n"
