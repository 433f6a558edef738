"""Tests whether a sampler draws directions with its claimed density: Pearson's chi-square over cells of the sphere.

The cells are a grid over azimuth and cosine from the normal. Half of the grid's lines are evenly spaced. The others are
quantiles of a pilot, the first draws, so that a lobe of any width is as many cells wide. The test does not count the
pilot, so the cells are independent of the counted draws. A cell's expected count is the density's integral over the
cell, times the number of draws.
"""
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from ..models.geometry import directions as unit_vectors

TWO_PI = 2.0 * np.pi
PILOT = 20_000  # draws that place the grid's lines; at most a tenth of all draws
LEAST = 5.0  # least expected count of a cell; cells with fewer are merged
NODES = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)  # the two Gauss-Legendre nodes of 0..1
DEPTH = 12  # most times that a cell is quartered
# Allowed error of a cell's integral, in parts of its count's noise. 20 000 cells with such errors move the statistic by
# 0.09 of its spread.
CARE = 0.03
BLOCK = 20  # side of a block of the coarse test, in cells
EDGE_DEPTH = 3  # least times that a cell is quartered where the density jumps
STEPS_DEPTH = 3  # least times that a cell is quartered where the density has steps
ROWS = 1 << 16  # most directions in one call of a density


class Pearson(NamedTuple):
    """Pearson's `statistic` of `degrees` of freedom; `p_value` is the probability of a statistic as large.

    `bias` bounds the integrals' contribution to the statistic by their errors. The statistic's spread is
    sqrt(2 `degrees`).
    """

    statistic: float
    degrees: int
    p_value: float
    bias: float


@dataclass(frozen=True)
class ChiSquare:
    """The drawn and the expected counts of each cell, `counts` and `expected` (P, Z), and the tests of them.

    `azimuths` (P + 1,) in radians and `cosines` (Z + 1,) are the cells' edges. `undrawn` is (counted, expected): the
    number of draws without a direction. `fine` is the test over these cells, `coarse` over blocks of BLOCK x BLOCK of
    them. `integral` is the density's integral over the sphere, within `error`. `strays` is the number of draws where
    the density is 0.
    """

    azimuths: np.ndarray
    cosines: np.ndarray
    counts: np.ndarray
    expected: np.ndarray
    undrawn: tuple
    fine: Pearson
    coarse: Pearson
    integral: float
    error: float
    strays: int

    @property
    def p_value(self) -> float:
        """The probability of draws this far from the density, if the density is right.

        0 where the density cannot be right: a draw lies where it is 0, or its integral is not finite or exceeds 1.
        """
        if self.strays or not self.integral <= 1.0 + self.error:
            return 0.0
        return min(2.0 * min(self.fine.p_value, self.coarse.p_value), 1.0)

    def draw(self, path, title: str = ""):
        """Writes a PNG of both densities and their difference in standard deviations.

        Raises ValueError where matplotlib is missing, or `path` is not a .png in a folder that exists.
        """
        from ..measure import plots

        plots.check(path)
        plots.chi_square(path, title, self)


def significance(level: float, tests: int) -> float:
    """The p value below which one of `tests` fails; correct ones all pass with probability 1 - level (Šidák)."""
    return -np.expm1(np.log1p(-level) / tests)


def of_model(model, parameters: dict, view, samples: int, seed: int, cells=(200, 100)) -> ChiSquare:
    """Tests `model.sample` against `model.pdf` for one `view` (3,), with `samples` draws and a pilot besides.

    `cells` are the numbers of cells over azimuth and cosine. Raises ValueError as `compare` and the model do, and for
    `samples` out of 1000 .. 10 000 000.
    """
    if int(samples) != samples or not 1000 <= samples <= 10_000_000:
        raise ValueError(f"samples: {samples} is not a whole number from 1000 to 10000000")
    u = np.random.default_rng(seed).random((int(samples) + min(PILOT, int(samples) // 9), 2))
    light = model.sample(view, u, **parameters)
    steps = any(p.kind == "image" for p in model.parameters)  # sampled by small cells of half vectors
    return compare(light, lambda direction: model.pdf(view, direction, **parameters), cells, steps)


def compare(directions, pdf, cells=(200, 100), steps: bool = False) -> ChiSquare:
    """Tests independent draws of `directions` (N, 3) against `pdf(directions (M, 3)) -> (M,)`, 1/sr over the sphere.

    Rows that are not finite are draws without a direction. `cells` are the numbers of cells over azimuth and cosine, 2
    to 4096. The first PILOT rows place the cells and are not counted. Set `steps` where the density is constant on
    regions smaller than cells. Raises ValueError for vectors that are not of unit length, for too few draws to fill two
    cells, and for a density that is negative or of a wrong shape.
    """
    drawn = _checked(directions)
    if len(cells) != 2 or any(int(n) != n or not 2 <= n <= 4096 for n in cells):
        raise ValueError(f"cells: {cells} are not two whole numbers from 2 to 4096")
    # The pilot places the cells.
    pilot = min(PILOT, len(drawn) // 10)
    first, drawn = drawn[:pilot], drawn[pilot:]
    azimuths, cosines = _edges(first[np.isfinite(first[:, 0])], cells)
    # The other draws are counted.
    finite = drawn[np.isfinite(drawn[:, 0])]
    cell = _cell_of(_coordinates(finite), azimuths, cosines)
    counts = np.bincount(cell, minlength=(len(azimuths) - 1) * (len(cosines) - 1)).astype(np.float64)
    share, error = integrals(pdf, azimuths, cosines, finite, steps)
    return _judged(azimuths, cosines, counts, share * len(drawn), error * len(drawn), len(drawn),
                   lambda rare: _strays(finite[rare[cell]], pdf))


def _checked(directions):
    """Directions (N, 3) as unit vectors; rows that are not finite become NaN. Raises ValueError."""
    drawn = np.array(directions, dtype=np.float64)
    if drawn.ndim != 2 or drawn.shape[1] != 3:
        raise ValueError(f"directions: expected rows of three numbers, got shape {drawn.shape}")
    missing = ~np.isfinite(drawn).all(axis=1)
    drawn[missing] = np.nan
    drawn[~missing] = unit_vectors("directions", drawn[~missing]) if not missing.all() else np.nan
    return drawn


def _edges(pilot, cells):
    """Edges of the cells over azimuth and over cosine: half of them evenly spaced, half quantiles of `pilot`."""
    return [_mixed(x, low, high, int(count))
            for x, low, high, count in zip(_coordinates(pilot).T, (-np.pi, -1.0), (np.pi, 1.0), cells, strict=True)]


def _mixed(x, low, high, count):
    """Edges (at most `count` + 1,) from `low` to `high`: half evenly spaced, half quantiles of `x`."""
    # An even number of even parts makes the horizon a line.
    even = np.linspace(low, high, max(2 * (count // 4), 1) + 1)
    inner = count + 1 - len(even)
    quantiles = np.quantile(x, (np.arange(inner) + 0.5) / inner) if len(x) else np.zeros(0)
    return np.unique(np.clip(np.concatenate([even, quantiles]), low, high))


def _coordinates(direction):
    """Azimuth and cosine (N, 2) of directions (N, 3)."""
    return np.stack([np.arctan2(direction[:, 1], direction[:, 0]), direction[:, 2]], axis=-1)


def _cell_of(coordinates, azimuths, cosines):
    """Index (N,) of the cell of each azimuth and cosine (N, 2)."""
    return _interval(coordinates[:, 0], azimuths) * (len(cosines) - 1) + _interval(coordinates[:, 1], cosines)


def _interval(x, edges):
    """Index (N,) of the interval between `edges` that holds each x (N,)."""
    return np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)


def integrals(pdf, azimuths, cosines, drawn, steps: bool = False):
    """Integrals (P * Z,) of `pdf` over the cells, and their errors (P * Z,). The draws `drawn` (N, 3) guide the rule.

    The rule takes 2 x 2 Gauss-Legendre nodes in each box of a grid, and in the box's quarters. Where both sums differ
    by more than CARE times the noise of a count, the quarters are quartered again. The difference is the error's
    estimate: it is 15 times the error where the density is smooth, and about twice the error where the density jumps.

    The rule misses a peak or an edge that passes between the nodes. So it also quarters boxes whose count of draws is
    not their share, and boxes where the density jumps. The grid is the cells' grid, with more lines where a wide cell
    is beside a narrow one. With `steps`, the nodes are random, one in each quarter of a box, and the boxes are smaller:
    fixed nodes would miss the steps along a row of cells by the same amount in each cell.
    """
    # `corners` are the lower and the upper corners of the boxes, (boxes, 2) each.
    lines = [_graded(edges) for edges in (azimuths, cosines)]
    corners = [np.stack(np.meshgrid(a, b, indexing="ij"), axis=-1).reshape(-1, 2)
               for a, b in ((lines[0][:-1], lines[1][:-1]), (lines[0][1:], lines[1][1:]))]
    total, error = _quartering(pdf, corners[0], corners[1] - corners[0], lines, drawn, steps)
    cell = _cell_of(0.5 * (corners[0] + corners[1]), azimuths, cosines)
    return np.bincount(cell, total), np.bincount(cell, error)


def _graded(edges):
    """Edges (N,) and more between them, so that no gap is many times its neighbor: gaps grow outwards, 3 times each."""
    gaps, lines = np.diff(edges), [edges]
    for i, gap in enumerate(gaps):
        for near, edge, sign in ((gaps[i - 1] if i else gap, edges[i], 1.0),
                                  (gaps[i + 1] if i + 1 < len(gaps) else gap, edges[i + 1], -1.0)):
            if near < gap / 4.0:
                reach = near * 3.0 ** np.arange(1.0, np.log(gap / near) / np.log(3.0))
                lines.append(edge + sign * reach[reach < 0.5 * gap])
    return np.unique(np.concatenate(lines))


def _quartering(pdf, low, size, lines, drawn, steps):
    """Integrals (N,) over the boxes between `lines` and their errors (N,), see `integrals`.

    `low` and `size` (N, 2) are the boxes' lower corners and sizes.
    """
    owner, draws = np.arange(len(low)), len(drawn)  # the owner is the grid's box that a part lies in
    rule = _gauss if not steps else partial(_gauss, jitter=np.random.default_rng(0))
    least = STEPS_DEPTH if steps else 1
    whole = rule(pdf, low, size)
    # Boxes where the density jumps, and the draws' boxes and positions (0..1) in them.
    area = draws * size.prod(axis=1)
    edge = _jumps(*(x.reshape(len(lines[0]) - 1, -1) for x in (draws * whole / area, area))).ravel()
    coordinates = _coordinates(drawn)
    box = _cell_of(coordinates, *lines)
    within = (coordinates - low[box]) / size[box]
    total, error = np.zeros(len(low)), np.zeros(len(low))
    for depth in range(DEPTH):
        low, size = _quartered(low, size)
        quarters = rule(pdf, low, size).reshape(-1, 4)
        differ = np.abs(quarters.sum(axis=1) - whole)
        # The allowed error, in parts of the noise of the owner's count.
        count = draws * (total + np.bincount(owner, quarters.sum(axis=1), minlength=len(total)))
        allowed = (CARE * np.minimum(np.sqrt(count), count) + 1e-5) / draws / 2.0**depth
        # Boxes whose number of draws is not the expected one.
        expected, counted = draws * quarters.sum(axis=1), np.bincount(box, minlength=len(quarters))
        surprising = np.abs(counted - expected) > 3.0 * np.sqrt(expected)
        again = (differ > allowed[owner]) | surprising | (edge[owner] & (depth < EDGE_DEPTH)) | (depth < least - 1)
        again &= depth < DEPTH - 1
        total += np.bincount(owner[~again], quarters[~again].sum(axis=1), minlength=len(total))
        error += np.bincount(owner[~again], differ[~again], minlength=len(total))
        if not again.any():
            break
        # The quarters of the other boxes are the next boxes.
        box, within = _sent_down(box, within, again)
        again4 = np.repeat(again, 4)
        owner, whole, low, size = np.repeat(owner[again], 4), quarters[again].ravel(), low[again4], size[again4]
    return total, error


def _jumps(density, area):
    """Whether the density jumps at a box, (P, Z): it is many times that of a box beside, by more than a count's noise.

    `density` and `area` are (P, Z); `area` is multiplied by the number of draws. Azimuths are periodic.
    """
    def beside(values):
        """The values (9, P, Z) of each box and its eight neighbors."""
        wide = np.pad(values, ((0, 0), (1, 1)), mode="edge")
        return np.stack([np.roll(wide, turn, axis=0)[:, shift:shift + values.shape[1]]
                         for turn in (-1, 0, 1) for shift in (0, 1, 2)])

    near = beside(density)
    most, least = near.max(axis=0), near.min(axis=0)
    return (least < 0.2 * most) & (beside(area).min(axis=0) * (most - least) ** 2 > 9.0 * most)


def _sent_down(box, within, again):
    """Boxes and positions of the draws in the quarters of the boxes to be quartered `again`.

    `box` (N,) is a draw's box, `within` (N, 2) its position there, 0..1.
    """
    goes_down = again[box]
    box, within = (np.cumsum(again) - 1)[box[goes_down]], 2.0 * within[goes_down]
    upper = within >= 1.0
    return 4 * box + 2 * upper[:, 0] + upper[:, 1], within - upper


def _quartered(low, size):
    """Lower corners and sizes, (4 N, 2) each, of the four quarters of each box, one after the other."""
    half = np.repeat(0.5 * size, 4, axis=0)
    return np.repeat(low, 4, axis=0) + half * np.tile([(0, 0), (0, 1), (1, 0), (1, 1)], (len(low), 1)), half


def _gauss(pdf, low, size, jitter=None):
    """Integrals (N,) over boxes of azimuth and cosine by 2 x 2 nodes, or by one random node in each quarter.

    `jitter` is the random nodes' generator.
    """
    result = np.empty(len(low))
    quarters = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    # Blocks of at most ROWS directions bound the memory.
    for start in range(0, len(low), ROWS // 4):
        rows = slice(start, start + ROWS // 4)
        nodes = NODES[quarters] if jitter is None else 0.5 * (quarters + jitter.random((len(low[rows]), 4, 2)))
        azimuth, cosine = (low[rows, None] + size[rows, None] * nodes).reshape(-1, 2).T
        across = np.sqrt(np.maximum((1.0 - cosine) * (1.0 + cosine), 0.0))
        value = _density(pdf, np.stack([across * np.cos(azimuth), across * np.sin(azimuth), cosine], axis=-1))
        result[rows] = value.reshape(-1, 4).mean(axis=1) * size[rows].prod(axis=1)
    return result


def _density(pdf, direction):
    """The density (N,) at directions (N, 3). Raises ValueError for a wrong shape or a negative value."""
    value = np.asarray(pdf(direction), dtype=np.float64)
    if value.shape != (len(direction),):
        raise ValueError(f"pdf: expected {len(direction)} numbers, got shape {value.shape}")
    if value.size and not np.nanmin(value) >= 0.0:
        raise ValueError(f"pdf: {np.nanmin(value):g} is no density; densities are 0 or more")
    return value


def _strays(direction, pdf):
    """The number of draws where the density is 0 or NaN."""
    return int(np.sum(~(_density(pdf, direction) > 0.0))) if len(direction) else 0


def _judged(azimuths, cosines, counts, expected, error_of_cells, draws, strays):
    """The ChiSquare of cells' counts (P * Z,), their expectations and the expectations' errors.

    `strays(rare)` counts the strays in the cells where `rare` (P * Z,) is True.
    """
    shape = len(azimuths) - 1, len(cosines) - 1
    astray = strays(expected < 1e-2)
    integral = float(expected.sum() / draws)
    error = float(max(3.0 * error_of_cells.sum() / draws, 2e-4))
    # Draws without a direction: their expected number is 1 less the integral. Within the integral's error it is set as
    # near as possible to the counted number.
    missing, lacking = float(draws - counts.sum()), float(draws - expected.sum())
    undrawn = missing, max(min(max(missing, lacking - draws * error), lacking + draws * error), 0.0)
    # Both tests have one more cell, for these draws.
    cells = [x.reshape(shape) for x in (counts, expected, error_of_cells)]
    tests = [_pearson(*(np.append(x, more) for x, more in zip(table, (*undrawn, 0.0), strict=True)))
             for table in (cells, [_blocks(x) for x in cells])]
    return ChiSquare(azimuths, cosines, *cells[:2], undrawn, *tests, integral, error, astray)


def _blocks(values):
    """Sums over blocks of BLOCK x BLOCK cells."""
    for axis in (0, 1):
        values = np.add.reduceat(values, np.arange(0, values.shape[axis], BLOCK), axis=axis)
    return values


def _pearson(counts, expected, error_of_cells):
    """Pearson's test of cells' counts, after merging the cells with few expected draws. Raises ValueError."""
    group = _groups(expected)
    counted, mean, error = (np.bincount(group, x) for x in (counts, expected, error_of_cells))
    if len(mean) < 2:
        raise ValueError(f"directions: {counts.sum():.0f} are too few to count: no two cells should have {LEAST:g}")
    statistic, degrees = float(((counted - mean) ** 2 / mean).sum()), len(mean) - 1
    return Pearson(statistic, degrees, _upper_tail(statistic, degrees), float((error**2 / mean).sum()))


def _groups(expected):
    """The group (N,) of each cell: one of its own, or a merged one that expects at least LEAST draws.

    Cells are merged in the order of their expected counts.
    """
    rare = np.flatnonzero(expected < LEAST)
    rare = rare[np.argsort(expected[rare], kind="stable")]
    # Counts below LEAST, cut at multiples of 2 LEAST of their running sum, give groups above LEAST. The last group may
    # be short and joins the one before.
    sums = np.cumsum(expected[rare])
    ends = max(int(sums[-1] // (2.0 * LEAST)), 1) if len(rare) else 0
    group = np.empty(len(expected), dtype=int)
    group[rare] = np.minimum(sums // (2.0 * LEAST), ends - 1)
    often = np.flatnonzero(~(expected < LEAST))
    if len(rare) and sums[-1] < LEAST and len(often):  # too few for one group: merge with the smallest other cell
        group[often] = np.where(often == often[np.argmin(expected[often])], 0, -1)
        often = often[group[often] < 0]
    group[often] = ends + np.arange(len(often))
    return group


def _upper_tail(statistic, degrees):
    """The probability that chi-square of `degrees` exceeds `statistic`. Raises ValueError where SciPy is missing."""
    try:
        from scipy import special
    except ImportError:
        raise ValueError("the p value needs scipy: install it with `pip install scipy`") from None
    return float(special.gammaincc(0.5 * degrees, 0.5 * statistic))
