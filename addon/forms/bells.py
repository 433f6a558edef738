"""Bells: the Beckmann microfacets that together are most of a lump on the halfway vector disk.

On the disk, in units of the lump's radii, a lump is (n+1)/pi (1 - r^2)^n (Edwards et al. 2006, eq. 27), and a
microfacet closure is nearly a normal distribution, a bell (see osl/include/bells.h). The bells are one in the middle,
and staggered rings around it. Together they are near the lump and below it, as bells cannot take light away. Their
shares, radii and widths depend on the exponent alone. A table has them over v = 1/(n+1), with lengths in units of the
lump's standard deviation 1 / sqrt(2 (n+2)).

Two rings are enough for most lumps. Lumps of small exponents, steep lumps, end steeply: a second table has three rings
for them. Their residual, the lump minus the bells, lies near the edge, and the table has its distribution.
"""
import json

import numpy as np

from ..models import disk
from .albedo import tables
from .files import replace_text

FILE = "bells.json"
NODES = 20  # nodes of v from 0 to 1, without the first
FEW, MANY = (6, 6), (6, 12, 18)  # bells of each ring: of a lump, and of a steep one
STEEP_FROM = 4  # first node with a row in the second table
KNOTS = 8  # intervals of r^2 with equal parts of the residual
OVER = 25.0  # weight of the excess in the fit; that of the residual is 1
WIDEST = 0.62  # largest width of a bell: wide ones follow the disk's map badly where it bends
NARROWEST = 0.15  # least width of a bell
# Starts of the search, in the order of `bells`.
FIRST = (0.2, 0.6, 0.5, 1.0, 0.6, 0.3, 1.8, 0.6)
FIRST_OF_MANY = (0.03, 0.5, 0.3, 0.65, 0.41, 0.35, 1.3, 0.35, 0.18, 1.8, 0.25)


def bells(parameters, x, y, deviation):
    """Sum of the bells at the points `x`, `y`, arrays of one shape, in parts of the lump's radius.

    `parameters` are share and width of the middle bell, then share, radius and width of each ring. A ring's share is
    the sum of its bells' shares. Lengths are in units of `deviation`.
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
    """A normal distribution of volume 1 and standard deviation `width`."""
    return np.exp(-0.5 * (x * x + y * y) / width**2) / (2.0 * np.pi * width**2)


def deviation_of(exponent):
    """Standard deviation of a lump along either axis, in parts of its radius."""
    return 1.0 / np.sqrt(2.0 * (exponent + 2.0))


def points(exponent, rings=102, turns=5):
    """(x, y, area) of points over the lump and a little beyond, in a sector that symmetry repeats.

    For lumps that reach the edge, two thirds of the rings lie inside it. Areas count for the whole disk.
    """
    deviation = deviation_of(exponent)
    edge = min(1.5, 5.0 * deviation)
    r, phi = np.meshgrid((np.arange(rings) + 0.5) / rings * edge, (np.arange(turns) + 0.5) / turns * np.pi / 6.0,
                         indexing="ij")
    return r * np.cos(phi), r * np.sin(phi), r * (edge / rings) * 2.0 * np.pi / turns


def _remainder(parameters, exponent, x, y):
    """The lump minus the bells at points, of either sign."""
    lump = disk.Lump(np.zeros(2), np.ones(2), exponent).density(np.stack([x, y], axis=-1))
    return lump - bells(parameters, x, y, deviation_of(exponent))


def residual_and_excess(parameters, exponent):
    """(residual, excess): the volumes of the lump above the bells, and of the bells above the lump."""
    x, y, area = points(exponent)
    remainder = _remainder(parameters, exponent, x, y)
    return (np.maximum(remainder, 0.0) * area).sum(), (np.maximum(-remainder, 0.0) * area).sum()


def knots(parameters, exponent, rings=600):
    """KNOTS + 1 values of r^2 from 0 to 1. Between neighbors lies an equal part of the residual."""
    r = (np.arange(rings) + 0.5) / rings
    phi = (np.arange(16) + 0.5) / 16 * np.pi / 6.0
    # The residual of each ring, its cumulative sum, and that inverted.
    residual = np.maximum(_remainder(parameters, exponent, np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi))), 0.0)
    done = np.concatenate([[0.0], np.cumsum(residual.sum(axis=1) * r)])
    radii2 = np.interp(np.arange(KNOTS + 1) / KNOTS, done / done[-1], np.linspace(0.0, 1.0, rings + 1) ** 2)
    radii2[[0, -1]] = 0.0, 1.0
    return radii2


def _fit_node(exponent, starts):
    """The parameters of `bells` that fit the lump of an exponent best, found from each of `starts`."""
    from scipy.optimize import minimize

    def cost(parameters):
        residual, excess = residual_and_excess(parameters, exponent)
        widths = np.array(parameters)[[1, *range(4, len(parameters), 3)]]
        shares = np.array(parameters)[[0, *range(2, len(parameters), 3)]]
        outside = np.maximum(widths - WIDEST, 0.0) ** 2 + np.maximum(NARROWEST - widths, 0.0) ** 2
        return residual + OVER * excess + 100.0 * (outside.sum() + np.maximum(-shares, 0.0).sum())

    # Each search is repeated once from its own result.
    best = None
    for start in starts:
        for _ in range(2):
            result = minimize(cost, start, method="Nelder-Mead",
                              options={"maxiter": 2500, "maxfev": 2500, "xatol": 1e-4, "fatol": 1e-6, "adaptive": True})
            start = result.x
        if best is None or result.fun < best.fun:
            best = result
    return best.x


def _rounded(numbers):
    """Numbers to four digits, as the file has them."""
    return [float(f"{x:.4g}") for x in numbers]


def fit():
    """Fit every node and write the file, a generator that yields (nodes done, all nodes). Needs SciPy.

    Each fit starts from the node before, and from the constants. Raises OSError where the file cannot be written.
    """
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
