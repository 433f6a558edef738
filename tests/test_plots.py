"""Plots: albedos against the models' own quadrature and closed forms, and the picture against what it is drawn of."""

import numpy as np
import pytest
from optics.images import spot, written

from addon.backends.osl import estimator
from addon.brdf import MODELS
from addon.library.metals import METALS
from addon.models import quadrature
from addon.models.errors import ImageError
from addon.models.formulas import he_torrance
from addon.models.geometry import in_plane
from addon.plots import letters, picture, quick

AT = (0.0, 30.0, 60.0, 80.0, 88.0)
UNBOUND = ("lafortune", "pumped_lafortune")  # their sharpest lobes are powers of what passes 1


def cases(model):
    """Defaults, the widest and the narrowest lobe, a colour, and pumps without control."""
    ids = {p.id for p in model.parameters}
    yield {}
    for end in ("minimum", "maximum"):
        yield {name: getattr(model.parameter(name), end) for name in model.widths}
    if "fresnel_type" in ids:
        yield {"fresnel_type": "conductor", "ior": METALS["gold"].ior, "extinction": METALS["gold"].extinction}
    yield {name: value for name, value in (("pumps", 2.5), ("control", False), ("diffuse_color", (0.5, 0.2, 0.1)),
                                           ("base_color", (0.9, 0.6, 0.2))) if name in ids}


def at(view):
    return int(np.argmin(np.abs(quick.VIEWS - view)))


@pytest.mark.parametrize("model_id", [name for name in MODELS if name != "kajiya_kay"])
def test_albedos_are_the_models_own(model_id):
    """Within the tolerance that is stated, in every channel, of pumped models also before pumping."""
    model = MODELS[model_id]
    slow = model_id.startswith("pumped_") and estimator.is_baked(model)
    for given in list(cases(model))[:1 if slow else None]:
        if model_id in UNBOUND and given.get("exponent_1") == 10000.0:
            continue
        plot = quick.plot(model, given)
        mu = np.cos(np.radians(AT))
        truth = model.albedo(mu, **given).reshape(len(AT), -1)
        found = plot.albedo[[at(view) for view in AT]]
        assert np.all(np.abs(found - truth) <= quick.TOLERANCE * np.maximum(truth, 1.0)), given
        assert (plot.unpumped is not None) == (model_id.startswith("pumped_") or model_id in (
            "phong_limit", "reciprocal_disk"))
    assert list(plot.numbers()) == [0.0, 60.0, 80.0]
    assert plot.numbers()[80.0] is not None and np.array_equal(plot.numbers()[80.0], plot.albedo[at(80.0)])


@pytest.mark.parametrize(("pumped", "base"), [("pumped_phong", "phong"), ("pumped_blinn", "blinn"),
                                              ("pumped_ward", "ward"), ("pumped_lafortune", "lafortune")])
def test_before_pumping(pumped, base):
    """The dim curve is the albedo of the model that is pumped; without pumps there is none, and the curve is that."""
    plot = quick.plot(MODELS[pumped], {"pumps": 3.0})
    truth = MODELS[base].albedo(np.cos(np.radians(AT)))
    chosen = [at(view) for view in AT]
    assert np.abs(plot.unpumped[chosen, 0] - truth).max() < quick.TOLERANCE
    plain = quick.plot(MODELS[pumped], {"pumps": 0.0})
    assert plain.unpumped is None
    assert np.abs(plain.albedo[chosen, 0] - truth).max() < quick.TOLERANCE
    assert plot.albedo[at(80.0)] > 1.2 * plain.albedo[at(80.0)]


def test_between_the_views_the_curve_is_the_albedo():
    """Lines from view to view leave it by less than a pixel up to 88 degrees."""
    views = np.linspace(0.5, 87.5, 59)
    for model_id, given in (("phong", {"exponent": 1000.0}), ("cook_torrance", {}), ("edwards_empirical", {}),
                            ("blinn", {"exponent": 5.0})):
        plot = quick.plot(MODELS[model_id], given)
        truth = MODELS[model_id].albedo(np.cos(np.radians(views)), **given).reshape(len(views), -1)
        found = np.stack([np.interp(views, quick.VIEWS, curve) for curve in plot.albedo.T], axis=-1)
        assert np.abs(found - truth).max() < 1.25 / (picture.CEILING - picture.FLOOR) + quick.TOLERANCE


@pytest.mark.parametrize("exponent", [1.0, 50.0, 10000.0])
def test_strands_against_their_integral(exponent):
    """Kajiya and Kay's lobe depends on the angle out of the strand's normal plane alone; half of a turn is lit."""
    plot = quick.plot(MODELS["kajiya_kay"], {"exponent": exponent})
    for view in (0.0, 60.0, 80.0):
        out = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 400001)
        ring = np.maximum(np.cos(out + np.radians(view)), 0.0) ** exponent * np.cos(out) ** 2
        truth = (exponent + 2.0) / (2.0 * np.pi) * np.pi * ring.sum() * (out[1] - out[0])
        assert plot.albedo[at(view), 0] == pytest.approx(truth, rel=1e-3)


@pytest.mark.parametrize("given", [{"roughness_u": 0.01}, {"roughness_v": 0.01}])
def test_stretched_lobes_against_ten_times_the_nodes(given):
    model = MODELS["ward"]
    p, plot = model.resolve(given), quick.plot(model, given)
    for view in (0.0, 60.0, 80.0):
        truth = quadrature.hemisphere(lambda v, light: model._value(v, light, p), in_plane(view)[0], 0.01,
                                      mirrored=False, azimuthal=300)
        assert plot.albedo[at(view), 0] == pytest.approx(truth, abs=1e-3)


def test_ndf_maps_of_images(tmp_path):
    """A spot far from the middle, turned; the lobe peaks where half vectors do."""
    given = {"image": written(tmp_path, spot(64, x=0.35, y=0.0)), "rotation": 0.5, "diffuse_color": (0.1, 0.1, 0.1)}
    plot = quick.plot(MODELS["ndf_map"], given)
    truth = MODELS["ndf_map"].albedo(np.cos(np.radians(AT)), **given)
    assert np.abs(plot.albedo[[at(view) for view in AT]] - truth).max() < quick.TOLERANCE
    # Half vectors are about x = -0.35; seen from above the light is at twice their angle.
    at_peak = plot.lobes[0].angles[plot.lobes[0].values.argmax()]
    assert at_peak == pytest.approx(-2.0 * np.degrees(np.arcsin(0.35)), abs=3.0)
    with pytest.raises(ImageError) as caught:
        quick.plot(MODELS["ndf_map"], {"image": str(tmp_path / "none.exr")})
    assert (caught.value.code, caught.value.path) == ("missing", tmp_path / "none.exr")


@pytest.mark.parametrize("model_id", MODELS)
def test_lobes_are_f_times_cosine(model_id):
    """Against `evaluate`, for pumped models within 1 % of the peak; every 37th light."""
    plot = quick.plot(MODELS[model_id], {})
    for lobe in plot.lobes:
        light = in_plane(lobe.angles[::37])
        f = MODELS[model_id].evaluate(in_plane(-lobe.view), light)
        truth = (f if f.ndim == 1 else f @ (0.2126, 0.7152, 0.0722)) * light[:, 2]
        assert np.abs(lobe.values[::37] - truth).max() < 0.01 * lobe.peak
        assert np.all(np.diff(lobe.angles) > 0.0)


def test_the_sharpest_peak_is_found():
    for lobe in quick.plot(MODELS["phong"], {"exponent": 100000.0}).lobes:
        assert lobe.peak == pytest.approx(100002.0 / (2.0 * np.pi) * np.cos(np.radians(lobe.view)), rel=1e-4)
        assert lobe.angles[lobe.values.argmax()] == pytest.approx(lobe.view, abs=5e-3)


def test_the_series_of_rough_surfaces():
    """He-Torrance's sum in steps is the sum of all terms, for g from 1e-3 to 1400."""
    rng = np.random.default_rng(3)
    g, x = 10.0 ** rng.uniform(-3.0, 3.15, 300), 10.0 ** rng.uniform(-3.0, 3.5, 300)
    total, log_term = np.zeros(300), -g
    for m in range(1, 2400):
        log_term = log_term + np.log(g) - np.log(m)
        total += np.exp(log_term - x / m) / m
    known = total > 1e-20
    assert np.abs(he_torrance._series(g, x)[known] / total[known] - 1.0).max() < 1e-8


# The picture.

def plot_of(albedo, unpumped=None, peaks=(1.0, 1.0, 1.0), width=10.0):
    """A plot of an albedo (VIEWS, C) and of bells of `width` degrees about the mirror direction."""
    angles = np.arange(-89.75, 90.0, 0.25)
    lobes = tuple(quick.Lobe(view, angles, peak * np.exp(-((angles - view) / width) ** 2))
                  for view, peak in zip(quick.LOBE_VIEWS, peaks, strict=True))
    return quick.Plot(np.asarray(albedo), unpumped, lobes, False)


def likeness(pixels, colour):
    """How near pixels (..., 4) are to a colour, against the background: 1 is all of it, 0 is far from it."""
    wanted = np.asarray(colour) - picture.BACKGROUND
    there = pixels[..., :3] - np.asarray(picture.BACKGROUND)
    off = np.linalg.norm(there - (there @ wanted / (wanted @ wanted))[..., None] * wanted, axis=-1)
    return np.where(off < 0.06, there @ wanted / (wanted @ wanted), 0.0)


def height_of(pixels, column, colour, about):
    """Height in pixels of a line's middle in a column; other lines may be 8 pixels from the height `about`."""
    y = np.arange(len(pixels)) + 0.5
    ink = np.maximum(likeness(pixels[:, column], colour) - 0.5, 0.0) * (np.abs(y - about) < 8.0)
    assert ink.sum() > 0.5
    return (ink * y).sum() / ink.sum()


def straight(at_normal, at_grazing):
    return (at_normal + (at_grazing - at_normal) * quick.VIEWS / 90.0)[:, None]


@pytest.mark.parametrize("ends", [(0.9, 0.2), (0.3, 0.6), (0.7, 0.7)])
def test_the_curve_lies_at_the_albedo(ends):
    pixels = picture.draw(plot_of(straight(*ends)))
    for column in (60, 101, 150, 211, 240):
        view = 90.0 * (column + 0.5 - picture.LEFT) / (picture.RIGHT - picture.LEFT)
        albedo = ends[0] + (ends[1] - ends[0]) * view / 90.0
        expected = picture.FLOOR + (picture.CEILING - picture.FLOOR) * albedo / 1.25
        assert height_of(pixels, column, picture.CURVE, expected) == pytest.approx(expected, abs=0.75)


def test_three_channels_and_what_was_before_pumping():
    albedo = np.concatenate([straight(0.9, 0.8), straight(0.6, 0.5), straight(0.2, 0.3)], axis=1)
    pixels = picture.draw(plot_of(albedo, unpumped=straight(0.4, 0.1)))
    column, view = 120, 90.0 * (120.5 - picture.LEFT) / (picture.RIGHT - picture.LEFT)
    scale = (picture.CEILING - picture.FLOOR) / 1.25
    ends = ((0.9, 0.8), (0.6, 0.5), (0.2, 0.3), (0.4, 0.1))
    for colour, (high, low) in zip((*picture.CHANNELS, picture.BEFORE), ends, strict=True):
        expected = picture.FLOOR + scale * (high + (low - high) * view / 90.0)
        assert height_of(pixels, column, colour, expected) == pytest.approx(expected, abs=0.75)


def test_above_one_is_a_warning():
    """Where the albedo passes 1, there and nowhere else; being right at 1 is none."""
    half = picture.SIDE
    assert likeness(picture.draw(plot_of(straight(1.0, 1.0)))[:, :half], picture.WARNING).max() < 0.5
    pixels = picture.draw(plot_of(straight(0.8, 1.2)))[:, :half]
    warned = (likeness(pixels, picture.WARNING) > 0.9).any(axis=0).nonzero()[0]
    assert warned.min() == pytest.approx(picture.LEFT + 0.5 * (picture.RIGHT - picture.LEFT), abs=4.0)
    assert warned.max() == pytest.approx(picture.RIGHT, abs=3.0)
    # The line of 1 is dashed, at its height.
    y = int(picture.FLOOR + (picture.CEILING - picture.FLOOR) / 1.25)
    dashes = likeness(pixels[y - 2:y + 3, 50:130], picture.UNITY).max(axis=0) > 0.6
    assert 0.3 < dashes.mean() < 0.7


@pytest.mark.parametrize(("peaks", "power"), [((1.0, 0.5, 2.0), 1), ((10.0, 2.5, 40.0), 2), ((1000.0, 8000.0, 1.0), 3)])
def test_lobes_point_and_reach_where_they_do(peaks, power):
    plot = plot_of(straight(0.5, 0.5), peaks=peaks)
    assert picture.power_of(plot) == power
    pixels = picture.draw(plot)
    y, x = np.indices(pixels.shape[:2]) + 0.5
    x, y = x - picture.CENTRE[0], y - picture.CENTRE[1]
    radius, angle = np.hypot(x, y), np.degrees(np.arctan2(x, y))
    for lobe, colour, peak in zip(plot.lobes, picture.LOBES, peaks, strict=True):
        inside = (likeness(pixels, colour) > 0.6) & (radius < picture.RADIUS + 0.9) & (np.abs(angle - lobe.view) < 12.0)
        expected = picture.RADIUS * (peak / max(peaks)) ** (1.0 / power)
        if expected < 8.0:
            continue  # lost among the others
        assert radius[inside].max() == pytest.approx(expected, abs=2.5)
        tip = inside & (radius > expected - 1.5)
        assert angle[tip].mean() == pytest.approx(lobe.view, abs=2.0)


def test_no_numbers_make_no_trouble():
    """Albedos and lobes that are no numbers, without bound or all 0."""
    for albedo in (np.nan, np.inf, 0.0, 1e30):
        plot = plot_of(np.full((len(quick.VIEWS), 1), albedo), peaks=(np.inf, 0.0, np.nan))
        pixels = picture.draw(plot)
        assert pixels.shape == (256, 512, 4) and np.isfinite(pixels).all()
        assert pixels.min() >= 0.0 and pixels.max() <= 1.0 and np.all(pixels[..., 3] == 1.0)
    for given in ({"cxy_1": 1.2, "exponent_1": 10000.0}, {"weight_1": 0.0, "weight_2": 0.0, "weight_3": 0.0}):
        for model_id in UNBOUND:
            assert np.isfinite(picture.draw(quick.plot(MODELS[model_id], given))).all()


def test_letters():
    assert letters.bitmap("10.5°", 2).shape == letters.size("10.5°", 2)[::-1]
    shapes = {letter: ink.tobytes() for letter, ink in letters.LETTERS.items()}
    assert len(set(shapes.values())) == len(shapes)
    with pytest.raises(ValueError, match="Q"):
        letters.bitmap("Q", 1)
