"""The random numbers of the shaders, as Cycles makes them: uniform, and independent of each other, from pixel to pixel,
from sample to sample and from bounce to bounce; and where single precision ends that.

The shader that shows them is made of the headers that all shaders use. What is tested is fixed by the hash and by the
scene, so a test passes or fails for good; its significance tells how often a sound hash would be called a bad one.
"""
import itertools

import numpy as np
import pytest
from optics import emission
from optics.emission import headers, perspective, shown
from scipy import special, stats
from scipy.stats import qmc

pytestmark = pytest.mark.blender

TEXT = headers("geometry.h", "random.h")
NUMBERS = "three_numbers(P, I, u, v)"
SIZE = 1000  # a million hits
WRONG = 1e-3  # chance that a sound hash fails anywhere in this file


# Statistics. Each gives p-values of a uniform distribution where numbers are uniform and independent; both ends are
# suspicious: a p-value near 1 belongs to numbers that are spread more evenly than by chance.

def uniform(x, cells=1000):
    """Of numbers (N,): Kolmogorov and Smirnov's test, and chi-square over even cells."""
    counts = np.bincount((x * cells).astype(int).clip(0, cells - 1), minlength=cells)
    return [stats.kstest(x, "uniform", method="asymp").pvalue, stats.chisquare(counts).pvalue]


def together(*numbers, cells=64):
    """Chi-square over even cells of the unit square, or cube, of numbers (N,) each."""
    index = np.zeros(len(numbers[0]), dtype=int)
    for x in numbers:
        index = cells * index + (x * cells).astype(int).clip(0, cells - 1)
    return stats.chisquare(np.bincount(index, minlength=cells ** len(numbers))).pvalue


def neighbours(picture, across, up):
    """Pairs of pixels, (N, 3) each, one so many pixels beside the other; no pixel is in two pairs."""
    step = max(across, abs(up))
    first = np.zeros(picture.shape[:2], dtype=bool)
    rows, columns = np.indices(first.shape)
    along = columns if across >= abs(up) else rows
    first[(along // step) % 2 == 0] = True
    other = np.roll(picture, (-up, -across), axis=(0, 1))
    inside = (rows + up >= 0) & (rows + up < len(first)) & (columns + across < first.shape[1])
    return picture[first & inside], other[first & inside]


def spread_of_means(picture, samples):
    """How many standard deviations the variance of pixels, each the mean of `samples`, is above 1 / (12 samples)."""
    pixels = picture.reshape(-1, picture.shape[-1])
    kurtosis = 3.0 - 1.2 / samples
    ratio = 12.0 * samples * pixels.var(axis=0)
    return (ratio - 1.0) / np.sqrt((kurtosis - 1.0) / len(pixels))


def p_values(picture):
    """All that is asked of a picture (H, W, 3) of one sample a pixel: {what: p-value}."""
    a, b, c = picture.reshape(-1, 3).T
    found = {}
    for i, x in enumerate((a, b, c)):
        found[f"number {i}, KS"], found[f"number {i}, cells"] = uniform(x)
    for (i, x), (j, y) in itertools.combinations(enumerate((a, b, c)), 2):
        found[f"numbers {i} and {j}"] = together(x, y)
    found["all three"] = together(a, b, c, cells=20)
    for step in ((1, 0), (0, 1), (1, 1), (1, -1), (2, 0), (0, 3), (8, 8)):
        here, there = neighbours(picture, *step)
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1)):
            found[f"number {i}, and {j} of the pixel {step} beside"] = together(here[:, i], there[:, j], cells=32)
    return found


SCENES = {
    "from above": {}, "aslant": {"view_deg": 40.0}, "grazing": {"view_deg": 85.0, "side": 40.0},
    "perspective": {"turned": perspective}, "100 m away": {"away": 100.0}, "1 km away": {"away": 1000.0},
    "10 km away": {"away": 1e4, "width": 8.0, "side": 40.0}, "10 km, perspective": {"away": 1e4, "turned": perspective},
    "1 mm of it": {"width": 1e-3}, "narrow filter": {"pixels": 0.01},
}
EVERYDAY = "aslant"
CHECKS = 10 + 7 * 4
TRIALS = len(SCENES) * CHECKS + 40  # and at most 40 elsewhere


def sidak(trials=TRIALS):
    """The p-value below which one of so many tests must not be, so that a sound hash fails any of them by WRONG."""
    return 1.0 - (1.0 - WRONG) ** (1.0 / trials)


def suspicious(found):
    """What of {name: p-value} is further out, at either end, than chance goes."""
    least = 0.5 * sidak()
    return {name: p for name, p in found.items() if not least < p < 1.0 - least}


def assert_normal(z):
    """Standard deviations that are no further from 0 than chance goes."""
    assert np.max(np.abs(z)) < special.ndtri(1.0 - 0.5 * sidak()), z


@pytest.mark.parametrize("scene", [pytest.param(name, marks=pytest.mark.versions if name == EVERYDAY
                                                else pytest.mark.proof) for name in SCENES])
def test_uniform_and_independent(scene):
    """One sample a pixel: Cycles takes it at the pixel's centre, in a raster that a poor hash would show."""
    found = p_values(shown(emission.material(TEXT, NUMBERS), SIZE, **SCENES[scene]))
    assert len(found) == CHECKS
    assert not suspicious(found)


@pytest.mark.versions
@pytest.mark.parametrize("samples", [2, 16, 64])
def test_samples_of_a_pixel(samples):
    """They are independent: the variance of their mean is 1 / (12 samples), and neighbours' means know no other's."""
    picture = shown(emission.material(TEXT, NUMBERS), 250, samples, view_deg=40.0)
    assert_normal(spread_of_means(picture, samples))
    for step in ((1, 0), (0, 1), (1, 1)):
        here, there = neighbours(picture, *step)
        r = [np.corrcoef(here[:, i], there[:, i])[0, 1] for i in range(3)]
        assert_normal(np.sqrt(len(here)) * np.array(r))


# Two hits of one path. The pixel's red is a number of the first, green and blue two of the second.

OF_DEPTH = """int depth = 0; getattribute("path:ray_depth", depth); vector n = three_numbers(P, I, u, v);
vector first = vector(n[0], 0.0, 0.0), second = vector(0.0, n[0], n[1]);"""


def pane(place, subject, centre):
    """A second square of the same material."""
    plane = place.scene.objects["Plausible Subject"]
    thing = place._add_object("Plausible Pane", plane.data)
    thing.location = centre


def pairs_of_bounces(colour, before, rest, view_deg, centre):
    subject = emission.material(TEXT, colour, before, rest)

    def turned(place):
        pane(place, subject, centre)
        cycles = place.scene.cycles
        cycles.max_bounces = cycles.glossy_bounces = cycles.transparent_max_bounces = 2

    picture = shown(subject, SIZE, view_deg=view_deg, turned=turned)
    a, b, c = picture.reshape(-1, 3).T
    return {"first": uniform(a)[0], "second": uniform(b)[0], "and its other": uniform(c)[0],
            "a number and itself later": together(a, b), "a number and the other later": together(a, c)}


def test_a_mirror_and_what_it_shows():
    """Half of the 40 metres' tangent up a pane hangs where the mirrored rays arrive."""
    up = 3.0
    centre = (-up * np.tan(np.radians(60.0)), 0.0, up)
    found = pairs_of_bounces("depth == 0 ? first : second", OF_DEPTH, "+ (depth == 0) * reflection(N)", 60.0, centre)
    assert not suspicious(found)


def test_a_pane_and_what_is_behind():
    """Both hits have the same x and y, the same place in their square and the same view: only the heights differ."""
    found = pairs_of_bounces("P[2] > 0.005 ? first : second", OF_DEPTH, "+ transparent()", 0.0, (0.0, 0.0, 0.01))
    assert not suspicious(found)


# Numbers of one hit for several lumps, of one place from several sides, of several directions.

VIEWS = """vector one = hit_numbers(P, I, u, v), second = hit_numbers(P, -I, v, u);
vector other = hit_numbers(P, normalize(I + 1e-4 * vector(0.3, 0.8, 0.0)), u, v);"""


def test_another_view_and_a_second_lump_have_their_own():
    """As edwards_fit asks for its second lump: the view turned around, and the place in the triangle swapped."""
    a, b, c = shown(emission.material(TEXT, "one[0], other[0], second[0]", VIEWS), SIZE, view_deg=40.0).reshape(-1, 3).T
    assert not suspicious({"turned a little": together(a, b), "the second lump's": together(a, c),
                           "both": together(b, c)})


@pytest.mark.proof
@pytest.mark.parametrize("count", [1, 4, 8])
def test_the_lattice(count):
    """Its k-th point has its own part of the first axis, and all of the second: both uniform, and independent."""
    k = count - 1
    lattice = f"vector n = hit_numbers(P, I, u, v); float a = lattice_u(n, {k}, {count}), b = lattice_v(n, {k});"
    a, b, _ = shown(emission.material(TEXT, "a, b, 0.0", lattice), SIZE).reshape(-1, 3).T
    assert a.min() >= k / count and a.max() <= 1.0
    a = np.clip(count * a - k, 0.0, 1.0)
    assert not suspicious({"first": uniform(a)[0], "second": uniform(b)[0], "together": together(a, b)})


def blurred(place):
    place.scene.render.use_motion_blur = True


def test_motion_blur_tells_samples_apart():
    """Where nothing else does: 10 km away through a filter of a hundredth of a pixel each has its own time."""
    picture = shown(emission.material(TEXT, NUMBERS), 128, 64, away=1e4, pixels=0.01, turned=blurred)
    assert_normal(spread_of_means(picture, 64))


def test_perspective_tells_samples_apart():
    """The view is known to 1e-7, wherever the camera is."""
    picture = shown(emission.material(TEXT, NUMBERS), 128, 64, away=1e4, pixels=0.01, turned=perspective)
    assert_normal(spread_of_means(picture, 64))


# Where it ends. Under an orthographic camera rays start at numbers of single precision, and nothing of a sample is
# known but where it hits: two that start alike are one. The variance of a pixel's mean then is larger, by so many times
# as each sample is counted on average.

FAR = [  # (metres away, pixel filter, side of the square); a pixel is 1/128 m
    (0.0, 0.01, 4.0), (100.0, 1.5, 4.0), (1000.0, 1.5, 4.0),
    (100.0, 0.01, 4.0), (1000.0, 0.01, 4.0), (1e4, 1.5, 4.0), (1e4, 0.01, 4.0),
    (0.0, 1.5, emission.BROAD), (0.0, 0.01, emission.BROAD),
]


def repeats(quantum, width, samples=64, pixels=300):
    """Mean number of a pixel's samples that share one's place, itself among them, on a grid of `quantum` metres.

    Samples are spread as a Sobol sequence is, through a Blackman-Harris window `width` metres wide.
    """
    x = np.linspace(0.0, 1.0, 2001)
    window = sum(a * np.cos(2.0 * np.pi * k * x) for k, a in enumerate((0.35875, -0.48829, 0.14128, -0.01168)))
    cumulated = np.cumsum(window) / window.sum()
    grid, rng = width / quantum, np.random.default_rng(5)
    total = 0.0
    for seed in range(pixels):
        place = np.interp(qmc.Sobol(2, seed=seed).random(samples), cumulated, x) * grid + rng.random(2)
        total += (np.unique(np.floor(place), axis=0, return_counts=True)[1] ** 2).sum() / samples
    return total / pixels


@pytest.mark.proof
@pytest.mark.parametrize("away, pixels, side", FAR)
def test_far_away_samples_repeat_as_single_precision_does(away, pixels, side):
    """No more than its grid says, a coordinate's or, where a triangle is 20 km large, that of the place in it.

    And no less than on one that is 2.2 times as fine: better would be news.
    """
    picture = shown(emission.material(TEXT, NUMBERS), 128, 64, away=away, pixels=pixels, side=side)
    ratio = (12.0 * 64 * picture.reshape(-1, 3).var(axis=0)).mean()
    quantum = max(float(np.spacing(np.float32(max(away, 0.5)))), side * 2.0**-25)
    noise = 5.0 * ratio * np.sqrt(2.0 / 128**2)
    low, high = (repeats(q, pixels / 128.0) for q in (quantum / 2.2, quantum))
    assert 1.0 <= low <= high <= 64.0
    assert low - noise <= ratio <= 1.03 * high + noise, (low, ratio, high)


# Planted errors.

PLANTED = {
    "both numbers the same": ({"SECOND_HASH": "0.0"}, "numbers 0 and 1"),
    "the third is the second": ({"THIRD_HASH": "SECOND_HASH"}, "numbers 1 and 2"),
    "a little lower": ({"FIRST_NUMBER": "pow(hashnoise(place, apart), 1.01)"}, "number 0, KS"),
    "never the lowest": ({"FIRST_NUMBER": "0.002 + 0.998 * hashnoise(place, apart)"}, "number 0, cells"),
    "two pixels share one": ({"FIRST_NUMBER": "hashnoise(floor(500.0 * place), 0.0)"}, "number 0, and 0"),
}


@pytest.mark.proof
@pytest.mark.parametrize("error", PLANTED)
def test_a_planted_error_is_found(error):
    hooks, where = PLANTED[error]
    wrong = headers("geometry.h", "random.h", **hooks)
    found = suspicious(p_values(shown(emission.material(wrong, NUMBERS), SIZE)))
    assert any(name.startswith(where) for name in found), found


def test_samples_that_repeat_are_found():
    """A hash of the pixel and not of the sample."""
    wrong = headers("geometry.h", "random.h", FIRST_NUMBER="hashnoise(floor(250.0 * place), 0.0)")
    z = spread_of_means(shown(emission.material(wrong, NUMBERS), 250, 16), 16)
    assert z[0] > 100.0 and np.abs(z[1]) < 5.0


def test_the_window_is_blackman_and_harris():
    """The prediction's own check: a sample counts once on a grid that is fine, and all together on one that is wide."""
    assert repeats(1e-6, 1.0, pixels=20) == pytest.approx(1.0, abs=1e-3)
    assert repeats(1e3, 1.0, pixels=100) == pytest.approx(64.0, abs=1.0)
