"""Whether directions are drawn with the density that is claimed: Pearson's chi-square test over cells of the sphere.

The cells are a grid over azimuth and cosine from the normal. Half of its lines are evenly apart, the others where the
draws are: the first of them, which are then not counted, place the lines, so that a lobe of any width is as many cells
wide and the cells know nothing of what is counted in them. What a cell should hold is the density's integral over it.
"""
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from ..models.geometry import directions as unit_vectors

TWO_PI = 2.0 * np.pi
PILOT = 20_000  # draws that place the grid, at most a tenth of all
LEAST = 5.0  # draws that a cell should hold; those of fewer are put together
NODES = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)  # Gauss-Legendre's two, of 0..1
DEPTH = 12  # times that a cell is quartered
# A cell's integral may be wrong by this part of its noise: 20 000 such errors move the statistic by 0.09 of its spread.
CARE = 0.03
BLOCK = 20  # cells along each side that are put together for the coarse test
EDGE_DEPTH = 3  # times at least, where the density jumps
STEPS_DEPTH = 3  # times at least, where it has steps
ROWS = 1 << 16  # directions that a density is asked for at once


class Pearson(NamedTuple):
    """Pearson's `statistic` of that many `degrees` of freedom, and the chance of one as large, `p_value`.

    `bias` bounds what errors of the integrals add to the statistic, whose spread is sqrt(2 degrees).
    """

    statistic: float
    degrees: int
    p_value: float
    bias: float


@dataclass(frozen=True)
class ChiSquare:
    """What was drawn and what should have been, by cells: `counts` and `expected` (P, Z).

    `azimuths` (P + 1,) in radians and `cosines` (Z + 1,) are the cells' edges. `undrawn` is how often nothing was drawn
    and how often it should have been. `fine` is the test by these cells, `coarse` by blocks of BLOCK x BLOCK of them.
    `integral` is the density's over the sphere, within `error`; `strays` is how many draws lie where it is 0.
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
        """The chance of draws so far from the density, were it right. 0 where they cannot be its: one of them lies
        where it is 0, or its integral is not finite or passes 1."""
        if self.strays or not self.integral <= 1.0 + self.error:
            return 0.0
        return min(2.0 * min(self.fine.p_value, self.coarse.p_value), 1.0)

    def draw(self, path, title: str = ""):
        """Write a PNG of both densities and their difference in standard deviations. Raises ValueError as `plots`."""
        from ..measure import plots

        plots.check(path)
        plots.chi_square(path, title, self)


def significance(level: float, tests: int) -> float:
    """The p value below which one of so many `tests` fails, if all shall pass with probability 1 - level (Šidák)."""
    return -np.expm1(np.log1p(-level) / tests)


def of_model(model, parameters: dict, view, samples: int, seed: int, cells=(200, 100)) -> ChiSquare:
    """The test of `model.sample` against `model.pdf` for one `view` (3,), by that many draws beside those of the pilot.

    Raises ValueError as `compare` and the model do, and for a number of samples out of 1000 .. 10 000 000.
    """
    if int(samples) != samples or not 1000 <= samples <= 10_000_000:
        raise ValueError(f"samples: {samples} is not a whole number from 1000 to 10000000")
    u = np.random.default_rng(seed).random((int(samples) + min(PILOT, int(samples) // 9), 2))
    light = model.sample(view, u, **parameters)
    steps = any(p.kind == "image" for p in model.parameters)  # drawn by small cells of half vectors
    return compare(light, lambda direction: model.pdf(view, direction, **parameters), cells, steps)


def compare(directions, pdf, cells=(200, 100), steps: bool = False) -> ChiSquare:
    """Hold independent draws of `directions` (N, 3) against `pdf(directions (M, 3)) -> (M,)`, 1/sr over the sphere.

    Rows that are not finite are draws of nothing. `cells` are those over azimuth and over cosine. The first PILOT rows
    are not counted. `steps` tells of a density that is constant on regions smaller than cells. Raises ValueError for
    other than unit vectors, for fewer draws than fill two cells, and for a density that is negative or of another
    shape.
    """
    drawn = _checked(directions)
    if len(cells) != 2 or any(int(n) != n or not 2 <= n <= 4096 for n in cells):
        raise ValueError(f"cells: {cells} are not two whole numbers from 2 to 4096")
    pilot = min(PILOT, len(drawn) // 10)
    first, drawn = drawn[:pilot], drawn[pilot:]
    azimuths, cosines = _edges(first[np.isfinite(first[:, 0])], cells)
    known = drawn[np.isfinite(drawn[:, 0])]
    place = _cell_of(_place(known), azimuths, cosines)
    counts = np.bincount(place, minlength=(len(azimuths) - 1) * (len(cosines) - 1)).astype(np.float64)
    share, wrong = integrals(pdf, azimuths, cosines, known, steps)
    return _judged(azimuths, cosines, counts, share * len(drawn), wrong * len(drawn), len(drawn),
                   lambda rare: _strays(known[rare[place]], pdf))


def _checked(directions):
    drawn = np.array(directions, dtype=np.float64)
    if drawn.ndim != 2 or drawn.shape[1] != 3:
        raise ValueError(f"directions: expected rows of three numbers, got shape {drawn.shape}")
    nothing = ~np.isfinite(drawn).all(axis=1)
    drawn[nothing] = np.nan
    drawn[~nothing] = unit_vectors("directions", drawn[~nothing]) if not nothing.all() else np.nan
    return drawn


def _edges(pilot, cells):
    """Edges of the cells over azimuth and over cosine: half of them evenly apart, half of them quantiles of `pilot`."""
    return [_mixed(x, low, high, int(count))
            for x, low, high, count in zip(_place(pilot).T, (-np.pi, -1.0), (np.pi, 1.0), cells, strict=True)]


def _mixed(x, low, high, count):
    # An even number of even parts, that the horizon is a line.
    even = np.linspace(low, high, max(2 * (count // 4), 1) + 1)
    inner = count + 1 - len(even)
    where = np.quantile(x, (np.arange(inner) + 0.5) / inner) if len(x) else np.zeros(0)
    return np.unique(np.clip(np.concatenate([even, where]), low, high))


def _place(direction):
    """Azimuth and cosine (N, 2) of directions (N, 3)."""
    return np.stack([np.arctan2(direction[:, 1], direction[:, 0]), direction[:, 2]], axis=-1)


def _cell_of(place, azimuths, cosines):
    """Index (N,) of the cells that azimuths and cosines (N, 2) lie in."""
    return _between(place[:, 0], azimuths) * (len(cosines) - 1) + _between(place[:, 1], cosines)


def _between(x, edges):
    return np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)


def integrals(pdf, azimuths, cosines, drawn, steps: bool = False):
    """Integrals (P * Z,) of `pdf` over the cells, and what they may be wrong by, (P * Z,); `drawn` (N, 3) show where.

    By Gauss-Legendre's 2 x 2 nodes in each box of a grid and in its quarters; where both differ by more than CARE times
    the noise of a count, the quarters are quartered again. What they differ by is taken for the error: where the
    density is smooth it is 15 times that, where it jumps some two times. That sees no peak, and no edge, that passes
    between the nodes. So what holds other than its share of the draws is quartered as well, and so are boxes where the
    density jumps; and the grid is the cells', with more lines where a wide one is beside a narrow one. Where there are
    `steps`, nodes are random, one in each quarter of a box, and boxes smaller: steps along a row of cells would be
    missed by the same in each of them.
    """
    lines = [_graded(edges) for edges in (azimuths, cosines)]
    corners = [np.stack(np.meshgrid(a, b, indexing="ij"), axis=-1).reshape(-1, 2)
               for a, b in ((lines[0][:-1], lines[1][:-1]), (lines[0][1:], lines[1][1:]))]
    total, wrong = _quartering(pdf, corners[0], corners[1] - corners[0], lines, drawn, steps)
    into = _cell_of(0.5 * (corners[0] + corners[1]), azimuths, cosines)
    return np.bincount(into, total), np.bincount(into, wrong)


def _graded(edges):
    """Edges (N,) and others between, such that no gap is many times as wide as the next: outwards each 3 times."""
    gaps, lines = np.diff(edges), [edges]
    for i, gap in enumerate(gaps):
        for near, place, sign in ((gaps[i - 1] if i else gap, edges[i], 1.0),
                                  (gaps[i + 1] if i + 1 < len(gaps) else gap, edges[i + 1], -1.0)):
            if near < gap / 4.0:
                reach = near * 3.0 ** np.arange(1.0, np.log(gap / near) / np.log(3.0))
                lines.append(place + sign * reach[reach < 0.5 * gap])
    return np.unique(np.concatenate(lines))


def _quartering(pdf, low, size, lines, drawn, steps):
    """Integrals (N,) over the boxes between `lines` and their errors, see `integrals`."""
    owner, draws = np.arange(len(low)), len(drawn)
    rule = _gauss if not steps else partial(_gauss, jitter=np.random.default_rng(0))
    least = STEPS_DEPTH if steps else 1
    whole = rule(pdf, low, size)
    area = draws * size.prod(axis=1)
    edge = _jumps(*(x.reshape(len(lines[0]) - 1, -1) for x in (draws * whole / area, area))).ravel()
    place = _place(drawn)
    box = _cell_of(place, *lines)
    within = (place - low[box]) / size[box]
    total, wrong = np.zeros(len(low)), np.zeros(len(low))
    for depth in range(DEPTH):
        low, size = _quartered(low, size)
        parts = rule(pdf, low, size).reshape(-1, 4)
        differ = np.abs(parts.sum(axis=1) - whole)
        held = draws * (total + np.bincount(owner, parts.sum(axis=1), minlength=len(total)))
        allowed = (CARE * np.minimum(np.sqrt(held), held) + 1e-5) / draws / 2.0**depth
        wanted, found = draws * parts.sum(axis=1), np.bincount(box, minlength=len(parts))
        surprising = np.abs(found - wanted) > 3.0 * np.sqrt(wanted)
        again = (differ > allowed[owner]) | surprising | (edge[owner] & (depth < EDGE_DEPTH)) | (depth < least - 1)
        again &= depth < DEPTH - 1
        total += np.bincount(owner[~again], parts[~again].sum(axis=1), minlength=len(total))
        wrong += np.bincount(owner[~again], differ[~again], minlength=len(total))
        if not again.any():
            break
        box, within = _sent_down(box, within, again)
        again4 = np.repeat(again, 4)
        owner, whole, low, size = np.repeat(owner[again], 4), parts[again].ravel(), low[again4], size[again4]
    return total, wrong


def _jumps(density, area):
    """Whether the densities in a box and in those beside it are many times each other, by more than the noise of a
    count, (P, Z). `area` is times the number of draws. Azimuths go round.
    """
    def beside(values):
        wide = np.pad(values, ((0, 0), (1, 1)), mode="edge")
        return np.stack([np.roll(wide, turn, axis=0)[:, shift:shift + values.shape[1]]
                         for turn in (-1, 0, 1) for shift in (0, 1, 2)])

    near = beside(density)
    most, least = near.max(axis=0), near.min(axis=0)
    return (least < 0.2 * most) & (beside(area).min(axis=0) * (most - least) ** 2 > 9.0 * most)


def _sent_down(box, within, again):
    """Draws in boxes (N,), at (N, 2) of 0..1 within them: those of boxes quartered `again`, in the quarters."""
    kept = again[box]
    box, within = (np.cumsum(again) - 1)[box[kept]], 2.0 * within[kept]
    upper = within >= 1.0
    return 4 * box + 2 * upper[:, 0] + upper[:, 1], within - upper


def _quartered(low, size):
    """The four quarters of each box, one after the other: (4 N, 2) both."""
    half = np.repeat(0.5 * size, 4, axis=0)
    return np.repeat(low, 4, axis=0) + half * np.tile([(0, 0), (0, 1), (1, 0), (1, 1)], (len(low), 1)), half


def _gauss(pdf, low, size, jitter=None):
    """Integrals (N,) over boxes of azimuth and cosine by 2 x 2 nodes, or one in each quarter by the random `jitter`."""
    result = np.empty(len(low))
    quarters = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    for start in range(0, len(low), ROWS // 4):
        rows = slice(start, start + ROWS // 4)
        nodes = NODES[quarters] if jitter is None else 0.5 * (quarters + jitter.random((len(low[rows]), 4, 2)))
        azimuth, cosine = (low[rows, None] + size[rows, None] * nodes).reshape(-1, 2).T
        across = np.sqrt(np.maximum((1.0 - cosine) * (1.0 + cosine), 0.0))
        value = _density(pdf, np.stack([across * np.cos(azimuth), across * np.sin(azimuth), cosine], axis=-1))
        result[rows] = value.reshape(-1, 4).mean(axis=1) * size[rows].prod(axis=1)
    return result


def _density(pdf, direction):
    value = np.asarray(pdf(direction), dtype=np.float64)
    if value.shape != (len(direction),):
        raise ValueError(f"pdf: expected {len(direction)} numbers, got shape {value.shape}")
    if value.size and not np.nanmin(value) >= 0.0:
        raise ValueError(f"pdf: {np.nanmin(value):g} is no density; densities are 0 or more")
    return value


def _strays(direction, pdf):
    """How many of the draws lie where the density is 0 or not a number."""
    return int(np.sum(~(_density(pdf, direction) > 0.0))) if len(direction) else 0


def _judged(azimuths, cosines, counts, expected, wrong, draws, strays):
    shape = len(azimuths) - 1, len(cosines) - 1
    astray = strays(expected < 1e-2)
    integral = float(expected.sum() / draws)
    error = float(max(3.0 * wrong.sum() / draws, 2e-4))
    # What the integral lacks, give or take its error: as near as that comes to what is missing.
    nothing, lacks = float(draws - counts.sum()), float(draws - expected.sum())
    undrawn = nothing, max(min(max(nothing, lacks - draws * error), lacks + draws * error), 0.0)
    cells = [x.reshape(shape) for x in (counts, expected, wrong)]
    tests = [_pearson(*(np.append(x, more) for x, more in zip(parts, (*undrawn, 0.0), strict=True)))
             for parts in (cells, [_blocks(x) for x in cells])]
    return ChiSquare(azimuths, cosines, *cells[:2], undrawn, *tests, integral, error, astray)


def _blocks(values):
    """Sums over blocks of BLOCK x BLOCK cells."""
    for axis in (0, 1):
        values = np.add.reduceat(values, np.arange(0, values.shape[axis], BLOCK), axis=axis)
    return values


def _pearson(counts, expected, wrong):
    group = _groups(expected)
    found, wanted, error = (np.bincount(group, x) for x in (counts, expected, wrong))
    if len(wanted) < 2:
        raise ValueError(f"directions: {counts.sum():.0f} are too few to count: no two cells should have {LEAST:g}")
    statistic, degrees = float(((found - wanted) ** 2 / wanted).sum()), len(wanted) - 1
    return Pearson(statistic, degrees, _upper_tail(statistic, degrees), float((error**2 / wanted).sum()))


def _groups(expected):
    """Which group each cell is of, (N,): its own, or, in the order of what they should hold, one of at least LEAST."""
    rare = np.flatnonzero(expected < LEAST)
    rare = rare[np.argsort(expected[rare], kind="stable")]
    # Of numbers below LEAST the sums between two multiples of 2 LEAST are above it, but for the last, which joins.
    sums = np.cumsum(expected[rare])
    ends = max(int(sums[-1] // (2.0 * LEAST)), 1) if len(rare) else 0
    group = np.empty(len(expected), dtype=int)
    group[rare] = np.minimum(sums // (2.0 * LEAST), ends - 1)
    often = np.flatnonzero(~(expected < LEAST))
    if len(rare) and sums[-1] < LEAST and len(often):  # not even one group: with the next larger cell
        group[often] = np.where(often == often[np.argmin(expected[often])], 0, -1)
        often = often[group[often] < 0]
    group[often] = ends + np.arange(len(often))
    return group


def _upper_tail(statistic, degrees):
    try:
        from scipy import special
    except ImportError:
        raise ValueError("the p value needs scipy: install it with `pip install scipy`") from None
    return float(special.gammaincc(0.5 * degrees, 0.5 * statistic))
