"""Bells: the Beckmann microfacets that make up most of a lump on the halfway vector disk.

On the disk, in units of the lump's radii, a lump is (n+1)/pi (1 - r^2)^n, and a microfacet closure is nearly a normal
distribution, a bell (see osl/include/disk_estimator.h). One bell in the middle and rings of others, staggered, come
near the lump and stay below it, as bells cannot take light away. Their shares, radii and widths depend on the exponent
alone: they are tabulated over v = 1/(n+1), with lengths in units of the lump's standard deviation 1 / sqrt(2 (n+2)).

Two rings do for most lumps. Those of small exponents end steeply: they have a second table, of three rings. What these
leave lies near the edge, and the table says where.
"""
import json

import numpy as np

from ..models import disk
from .albedo import tables
from .files import replace_text

FILE = "bells.json"
NODES = 20  # of v from 0 to 1, besides the first
FEW, MANY = (6, 6), (6, 12, 18)  # bells of each ring
STEEP_FROM = 4  # node from which there is a row of the second table
KNOTS = 8  # intervals of r^2 with equal parts of what is left
OVER = 25.0  # what more it counts to be above the lump than below
WIDEST = 0.62  # bells are no wider: wide ones follow the disk's map badly where it bends
NARROWEST = 0.15
FIRST = (0.2, 0.6, 0.5, 1.0, 0.6, 0.3, 1.8, 0.6)  # where the search begins
FIRST_OF_MANY = (0.03, 0.5, 0.3, 0.65, 0.41, 0.35, 1.3, 0.35, 0.18, 1.8, 0.25)


def bells(parameters, x, y, deviation):
    """Sum of the bells at points, all of one shape.

    `parameters`: share and width of the middle bell, then share, radius and width of each ring; a ring's share is that
    of its bells together. Lengths are in units of `deviation`.
    """
    middle, width, *rings = parameters
    total = middle * _bell(x, y, width * deviation)
    counts = FEW if len(rings) == 3 * len(FEW) else MANY
    for i, count in enumerate(counts):
        share, radius, ring_width = rings[3 * i : 3 * i + 3]
        for k in range(count):
            phi = 2.0 * np.pi * (k + 0.5 * (i % 2)) / count
            total = total + share / count * _bell(x - radius * deviation * np.cos(phi),
                                                  y - radius * deviation * np.sin(phi), ring_width * deviation)
    return total


def _bell(x, y, width):
    return np.exp(-0.5 * (x * x + y * y) / width**2) / (2.0 * np.pi * width**2)


def deviation_of(exponent):
    """Standard deviation of a lump along either axis, in parts of its radius."""
    return 1.0 / np.sqrt(2.0 * (exponent + 2.0))


def points(exponent, rings=102, turns=5):
    """(x, y, area) of points over the lump and a little beyond, in a sector that symmetry repeats.

    Of lumps that reach so far, two thirds of the rings lie inside the edge.
    """
    deviation = deviation_of(exponent)
    edge = min(1.5, 5.0 * deviation)
    r, phi = np.meshgrid((np.arange(rings) + 0.5) / rings * edge, (np.arange(turns) + 0.5) / turns * np.pi / 6.0,
                         indexing="ij")
    return r * np.cos(phi), r * np.sin(phi), r * (edge / rings) * 2.0 * np.pi / turns


def _remainder(parameters, exponent, x, y):
    lump = disk.Lump(np.zeros(2), np.ones(2), exponent).density(np.stack([x, y], axis=-1))
    return lump - bells(parameters, x, y, deviation_of(exponent))


def residual_and_excess(parameters, exponent):
    """(volume of the lump that the bells leave, volume by which they are above it)."""
    x, y, area = points(exponent)
    remainder = _remainder(parameters, exponent, x, y)
    return (np.maximum(remainder, 0.0) * area).sum(), (np.maximum(-remainder, 0.0) * area).sum()


def knots(parameters, exponent, rings=600):
    """KNOTS + 1 values of r^2 from 0 to 1, between any two of which lies an equal part of what the bells leave."""
    r = (np.arange(rings) + 0.5) / rings
    phi = (np.arange(16) + 0.5) / 16 * np.pi / 6.0
    left = np.maximum(_remainder(parameters, exponent, np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi))), 0.0)
    done = np.concatenate([[0.0], np.cumsum(left.sum(axis=1) * r)])
    found = np.interp(np.arange(KNOTS + 1) / KNOTS, done / done[-1], np.linspace(0.0, 1.0, rings + 1) ** 2)
    found[[0, -1]] = 0.0, 1.0
    return found


def _fit_node(exponent, starts):
    from scipy.optimize import minimize

    def cost(parameters):
        left, over = residual_and_excess(parameters, exponent)
        widths = np.array(parameters)[[1, *range(4, len(parameters), 3)]]
        shares = np.array(parameters)[[0, *range(2, len(parameters), 3)]]
        outside = np.maximum(widths - WIDEST, 0.0) ** 2 + np.maximum(NARROWEST - widths, 0.0) ** 2
        return left + OVER * over + 100.0 * (outside.sum() + np.maximum(-shares, 0.0).sum())

    best = None
    for start in starts:
        for _ in range(2):
            found = minimize(cost, start, method="Nelder-Mead",
                             options={"maxiter": 2500, "maxfev": 2500, "xatol": 1e-4, "fatol": 1e-6, "adaptive": True})
            start = found.x
        if best is None or found.fun < best.fun:
            best = found
    return best.x


def _rounded(numbers):
    return [float(f"{x:.4g}") for x in numbers]


def fit():
    """Fit every node and write the file, a generator that yields (nodes done, nodes in all). Needs SciPy."""
    total = 2 * (NODES + 1) - STEEP_FROM
    few, many, of_few, of_many = [], [], FIRST, FIRST_OF_MANY
    for i in range(NODES + 1):
        exponent = NODES / max(i, 1e-3) - 1.0
        of_few = _fit_node(exponent, (of_few, FIRST))
        few.append(_rounded(of_few))
        yield len(few) + len(many), total
        if i >= STEEP_FROM:
            of_many = _fit_node(exponent, (of_many, FIRST_OF_MANY))
            row = _rounded(of_many)
            many.append(row + _rounded(knots(row, exponent)))
            yield len(few) + len(many), total
    document = {"about": "bells near a lump over 1/(n+1); see addon/forms/bells.py", "table": few, "steep": many}
    replace_text(tables.folder() / FILE, json.dumps(document, separators=(",", ":")) + "\n")
