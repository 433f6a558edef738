"""Bells: the Beckmann microfacets that make up most of a lump on the halfway vector disk.

On the disk, in units of the lump's radii, a lump is (n+1)/pi (1 - r^2)^n, and a microfacet closure is nearly a normal
distribution, a bell (see osl/include/disk_estimator.h). One bell in the middle and two rings of six, staggered, come
near the lump and stay below it, as bells cannot take light away. Their shares, radii and widths depend on the exponent
alone: they are tabulated over v = 1/(n+1), with lengths in units of the lump's standard deviation 1 / sqrt(2 (n+2)).
"""
import json

import numpy as np

from ..brdf import disk, tables
from .files import replace_text

FILE = "bells.json"
NODES = 20  # of v from 0 to 1, besides the first
RING = 6
OVER = 25.0  # what more it counts to be above the lump than below
WIDEST = 0.62  # bells are no wider: wide ones follow the disk's map badly where it bends
NARROWEST = 0.15
FIRST = (0.2, 0.6, 0.5, 1.0, 0.6, 0.3, 1.8, 0.6)  # where the search begins


def bells(parameters, x, y, deviation):
    """Sum of the bells at points, all of one shape.

    `parameters`: share and width of the middle bell, then share, radius and width of either ring; a ring's share is
    that of its six bells together. Lengths are in units of `deviation`.
    """
    middle, width, *rings = parameters
    total = middle * _bell(x, y, width * deviation)
    for i, (share, radius, ring_width) in enumerate((rings[:3], rings[3:])):
        for k in range(RING):
            phi = 2.0 * np.pi * (k + 0.5 * i) / RING
            total = total + share / RING * _bell(x - radius * deviation * np.cos(phi),
                                                 y - radius * deviation * np.sin(phi), ring_width * deviation)
    return total


def _bell(x, y, width):
    return np.exp(-0.5 * (x * x + y * y) / width**2) / (2.0 * np.pi * width**2)


def deviation_of(exponent):
    """Standard deviation of a lump along either axis, in parts of its radius."""
    return 1.0 / np.sqrt(2.0 * (exponent + 2.0))


def points(exponent, rings=100, turns=5):
    """(x, y, area) of points over the lump and a little beyond, in a sector that symmetry repeats."""
    deviation = deviation_of(exponent)
    edge = min(1.5, 5.0 * deviation)
    r, phi = np.meshgrid((np.arange(rings) + 0.5) / rings * edge, (np.arange(turns) + 0.5) / turns * np.pi / RING,
                         indexing="ij")
    return r * np.cos(phi), r * np.sin(phi), r * (edge / rings) * 2.0 * np.pi / turns


def left_and_over(parameters, exponent):
    """(volume of the lump that the bells leave, volume by which they are above it)."""
    x, y, area = points(exponent)
    lump = disk.Lump(np.zeros(2), np.ones(2), exponent).density(np.stack([x, y], axis=-1))
    remainder = lump - bells(parameters, x, y, deviation_of(exponent))
    return (np.maximum(remainder, 0.0) * area).sum(), (np.maximum(-remainder, 0.0) * area).sum()


def _fit_node(exponent, starts):
    from scipy.optimize import minimize

    def cost(parameters):
        left, over = left_and_over(parameters, exponent)
        widths = np.array(parameters)[[1, 4, 7]]
        outside = np.maximum(widths - WIDEST, 0.0) ** 2 + np.maximum(NARROWEST - widths, 0.0) ** 2
        negative = np.maximum(-np.array(parameters)[[0, 2, 5]], 0.0)
        return left + OVER * over + 100.0 * (outside.sum() + negative.sum())

    best = None
    for start in starts:
        for _ in range(2):
            found = minimize(cost, start, method="Nelder-Mead",
                             options={"maxiter": 2500, "maxfev": 2500, "xatol": 1e-4, "fatol": 1e-6, "adaptive": True})
            start = found.x
        if best is None or found.fun < best.fun:
            best = found
    return best.x


def fit():
    """Fit every node and write the file, a generator that yields (nodes done, nodes in all). Needs SciPy."""
    rows, previous = [], FIRST
    for i in range(NODES + 1):
        exponent = NODES / max(i, 1e-3) - 1.0
        previous = _fit_node(exponent, (previous, FIRST))
        rows.append([float(f"{x:.4g}") for x in previous])
        yield i + 1, NODES + 1
    document = {"about": "bells near a lump over 1/(n+1); see addon/baking/bells.py", "table": rows}
    replace_text(tables.folder() / FILE, json.dumps(document, separators=(",", ":")) + "\n")
