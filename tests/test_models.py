"""The Phong and Blinn models: formula, reciprocity, energy, sampling, colour, and what bad input is told.

Models of the halfway vector disk are in test_disk.py.
"""
import math
import pickle

import numpy as np
import pytest
from scipy import stats
from truth import quadrature

from addon import brdf
from addon.backends.osl import estimator
from addon.brdf import MODELS
from addon.forms.albedo.tables import TableError
from addon.library import metals
from addon.models import fresnel, registry
from addon.models.errors import ArgumentError, DuplicateModel, ParameterError, UnknownModel, UnknownParameter

EXPONENTS = [1.0, 1.7, 20.0, 1000.0, 100000.0]
WHITE = {
    "phong": [{}], "blinn": [{}], "phong_limit": [{}],
    "pumped_phong": [{"pumps": 1.0}, {"pumps": 2.5, "control": False}, {"pumps": 4.0, "control": True}],
    "pumped_blinn": [{"pumps": 1.0}, {"pumps": 2.5, "control": False}, {"pumps": 0.5, "control": True}],
}
COLOURED = [
    {"base_color": (0.9, 0.5, 0.1)},
    {"fresnel_type": "schlick", "base_color": (0.9, 0.5, 0.1), "f90": (1.0, 0.8, 0.9)},
    {"fresnel_type": "conductor"},
]
# Models of the two lobes that are powers; those of the disk have tests of their own.
POWERS = {name: model for name, model in MODELS.items() if estimator.base_family(model)}
CASES = [(model, options) for model, variants in WHITE.items() for options in variants]
# What conserves energy: all but Blinn below one whole pump, whose albedo passes 1 (see test_pumping.py).
CONSERVING = [(model, options) for model, options in CASES if "blinn" not in model or options.get("pumps", 0.0) >= 1.0]


def lobe_of(model):
    return "blinn" if "blinn" in model else "phong"


def lights_of(model, mu, n, rings=14, turns=9):
    """Lights above the horizon where the lobe is not 0."""
    light, _ = quadrature.lobe_nodes(lobe_of(model), mu, n, rings, turns)
    return light[light[:, 2] > 1e-6]


def upper_pairs(count, seed):
    """Random directions above the horizon, some of them near it."""
    rng = np.random.default_rng(seed)
    mu = rng.uniform(0.0, 1.0, (2, count)) ** np.where(np.arange(count) % 4 == 0, 8.0, 1.0)
    phi = rng.uniform(0.0, 2.0 * np.pi, (2, count))
    return np.stack([np.sqrt(1.0 - mu**2) * np.cos(phi), np.sqrt(1.0 - mu**2) * np.sin(phi), mu], axis=-1)


def rejected(call, *words):
    """The call raises ValueError in one line that holds every word."""
    with pytest.raises(ValueError) as caught:
        call()
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert str(word) in message, f"{word!r} is not in {message!r}"


def test_the_cases_here_are_all_models():
    assert set(WHITE) == set(POWERS)
    for name, model in MODELS.items():
        assert model.id == name
        with pytest.raises(DuplicateModel) as caught:
            registry.register(model)
        assert caught.value.model == name


# Formula


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("model", ["phong", "blinn", "phong_limit"])
def test_evaluate_is_the_formula(model, n):
    for mu in (1e-3, 0.2, 0.7, 1.0):
        view, light = quadrature.view_at(mu), lights_of(model, mu, n)
        expected = quadrature.f0(lobe_of(model), view, light, n)
        if model == "phong_limit":
            expected = expected / np.where(light[:, 2] > mu, light[:, 2], mu)
        value = MODELS[model].evaluate(view, light, exponent=n)
        # A power multiplies the cosine's rounding error by n.
        np.testing.assert_allclose(value, expected, rtol=1e-12 + 2e-15 * n)
        assert value.max() > 0.0


@pytest.mark.parametrize(("model", "by_hand"), [("phong", 22.0 / (2.0 * np.pi)), ("blinn", 28.0 / (8.0 * np.pi)),
                                                ("phong_limit", 22.0 / (2.0 * np.pi) / 0.5)])
def test_peak_by_hand(model, by_hand):
    """n = 20, 60 degrees, light at the mirror direction: the power is 1."""
    view = quadrature.view_at(0.5)
    assert MODELS[model].evaluate(view, view * [-1, -1, 1])[0] == pytest.approx(by_hand, rel=1e-12)


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize(("model", "options"), CASES)
def test_reciprocity(model, options, n):
    view, light = upper_pairs(150, seed=3)
    # Random pairs miss narrow lobes, so pairs near the mirror direction as well.
    near = np.concatenate([lights_of(model, mu, n, 6, 5) for mu in (0.03, 0.6)])
    views = np.concatenate([np.tile(quadrature.view_at(mu), (len(lights_of(model, mu, n, 6, 5)), 1))
                            for mu in (0.03, 0.6)])
    view, light = np.concatenate([view, views]), np.concatenate([light, near])
    for colour in [{}, *COLOURED]:
        one = MODELS[model].evaluate(view, light, exponent=n, **options, **colour)
        other = MODELS[model].evaluate(light, view, exponent=n, **options, **colour)
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=0.0)
        assert np.isfinite(one).all() and one.min() >= 0.0 and one.max() > 0.0
        assert one.shape == ((len(view), 3) if colour else (len(view),))


@pytest.mark.parametrize(("model", "options"), CASES)
def test_nothing_below_the_horizon(model, options):
    view, light = upper_pairs(50, seed=5)
    down = [1.0, 1.0, -1.0]
    for pair in ((view, light * down), (view * down, light), (view * down, light * down)):
        assert np.all(MODELS[model].evaluate(*pair, exponent=1.0, **options) == 0.0)
    assert np.all(MODELS[model].evaluate(view, view * [-1, -1, 1], exponent=1.0, **options) > 0.0)


def test_one_direction_stands_for_all():
    view, light = upper_pairs(7, seed=1)
    model = MODELS["pumped_phong"]
    rows = [model.evaluate(view[0], one)[0] for one in light]
    np.testing.assert_allclose(model.evaluate(view[0], light), rows, rtol=1e-14)
    np.testing.assert_allclose(model.evaluate(light, view[:1]), rows, rtol=1e-12)
    assert model.evaluate(view[0], light[0]).shape == (1,)
    assert model.pdf(view[0], light).shape == model.pdf(view, light[0]).shape == (7,)
    assert model.sample(view[0], np.full((5, 2), 0.5)).shape == (5, 3)
    assert model.sample(view, (0.5, 0.5)).shape == (7, 3)
    assert model.albedo(0.5).shape == (1,)
    assert model.albedo([0.5, 0.7], base_color=0.5).shape == (2, 3)
    assert model.evaluate(np.zeros((0, 3)), light[0]).shape == (0,)


# Energy


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize(("model", "options"), CONSERVING)
def test_no_energy_is_created(model, options, n):
    mu = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 40)])
    albedo = MODELS[model].albedo(mu, exponent=n, **options)
    # Pumping divides by a reading of a table, whose error at the albedos near 1 is far below its bound of 1e-3.
    assert albedo.max() <= 1.0 + (2e-4 if "pumped" in model else 1e-7)
    assert albedo.min() > 0.0


@pytest.mark.parametrize("n", [1.7, 20.0, 300.0])
@pytest.mark.parametrize(("model", "options"), CASES)
def test_albedo_is_the_integral_of_evaluate(model, options, n):
    """In another parametrisation, with colour and without; its midpoint rule errs by up to 1.2e-4."""
    for colour in [{}, *COLOURED]:
        def evaluate(view, light, given={"exponent": n, **options, **colour}):  # noqa: B006
            return MODELS[model].evaluate(view, light, **given)

        for mu in (0.05, 0.5, 1.0):
            expected = quadrature.albedo(evaluate, lobe_of(model), mu, n)
            found = MODELS[model].albedo(mu, exponent=n, **options, **colour)[0]
            np.testing.assert_allclose(found, expected, rtol=3e-4)


def test_colour_scales_the_albedo():
    white = MODELS["pumped_phong"].albedo([0.1, 0.8])
    coloured = MODELS["pumped_phong"].albedo([0.1, 0.8], base_color=(0.9, 0.5, 0.0))
    np.testing.assert_allclose(coloured, white[:, None] * [0.9, 0.5, 0.0], rtol=1e-12)


# Sampling


@pytest.mark.parametrize("mu", [1e-3, 0.3, 0.8, 1.0])
@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("model", ["phong", "blinn"])
def test_pdf_is_a_density_over_the_sphere(model, n, mu):
    light, area = quadrature.lobe_nodes(lobe_of(model), mu, n)
    pdf = MODELS[model].pdf(quadrature.view_at(mu), light, exponent=n)
    assert (pdf * area).sum() == pytest.approx(1.0, abs=1e-4)  # midpoint rule: 3e-5
    assert np.isfinite(pdf).all() and pdf.min() >= 0.0


@pytest.mark.parametrize("mu", [1e-3, 0.3, 1.0])
@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("model", ["phong", "blinn"])
def test_samples_follow_the_lobe(model, n, mu):
    """cos(delta)^(n+1) and the turn about the lobe's axis are uniform and independent: chi-square over 10 x 10 bins."""
    view = quadrature.view_at(mu)
    light = MODELS[model].sample(view, np.random.default_rng(11).random((20000, 2)), exponent=n)
    np.testing.assert_allclose(np.linalg.norm(light, axis=1), 1.0, rtol=1e-12)
    if model == "phong":
        x, y, axis = np.array([mu, 0.0, view[0]]), np.array([0.0, 1.0, 0.0]), view * [-1.0, -1.0, 1.0]
        around = light
    else:
        x, y, axis = np.eye(3)
        around = view + light
        around = around / np.linalg.norm(around, axis=1, keepdims=True)
        around = around * np.sign(around[:, 2:])
    power = np.clip(around @ axis, 0.0, 1.0) ** (n + 1.0)
    turn = np.arctan2(around @ y, around @ x) / (2.0 * np.pi) % 1.0
    counts = np.histogram2d(power, turn, bins=10, range=((0.0, 1.0), (0.0, 1.0)))[0]
    assert counts.sum() == len(light)
    assert stats.chisquare(counts.ravel()).pvalue > 1e-4


@pytest.mark.parametrize("mu", [0.02, 0.5, 0.95])
@pytest.mark.parametrize("n", [1.0, 20.0, 150.0])
@pytest.mark.parametrize("model", POWERS)
def test_samples_follow_the_pdf(model, n, mu):
    """Chi-square over 10 x 12 bins of the sphere, what is expected by integrating .pdf."""
    view = quadrature.view_at(mu)

    def histogram(light, weights=None):
        turn = np.arctan2(light[:, 1], light[:, 0])
        return np.histogram2d(light[:, 2], turn, (10, 12), ((-1.0, 1.0), (-np.pi, np.pi)), weights=weights)[0].ravel()

    light = MODELS[model].sample(view, np.random.default_rng(17).random((20000, 2)), exponent=n)
    found = histogram(light)
    nodes, area = quadrature.lobe_nodes(lobe_of(model), mu, n, 500, 301)
    expected = histogram(nodes, MODELS[model].pdf(view, nodes, exponent=n) * area) * len(light)
    rare = expected < 10.0
    found, expected = (np.append(x[~rare], x[rare].sum()) for x in (found, expected))
    expected *= found.sum() / expected.sum()
    keep = expected > 1.0
    chi2 = ((found - expected)[keep] ** 2 / expected[keep]).sum()
    assert stats.chi2.sf(chi2, max(keep.sum() - 1, 1)) > 1e-4
    # The test has teeth: the lobe of a neighbouring view fails it.
    if keep.sum() > 8:
        other = MODELS[model].sample(quadrature.view_at(mu - 0.02 if mu > 0.5 else mu + 0.08),
                                     np.random.default_rng(17).random((20000, 2)), exponent=n)
        moved = histogram(other)
        moved = np.append(moved[~rare], moved[rare].sum())
        assert stats.chi2.sf(((moved - expected)[keep] ** 2 / expected[keep]).sum(), keep.sum() - 1) < 1e-4


@pytest.mark.parametrize("mu", [1e-3, 0.05, 0.5, 1.0])
@pytest.mark.parametrize("n", [1.0, 20.0, 1000.0, 100000.0])
@pytest.mark.parametrize(("model", "options"), CASES)
def test_importance_sampling_finds_the_albedo(model, options, n, mu):
    view = quadrature.view_at(mu)
    given = {"exponent": n, **options}
    light = MODELS[model].sample(view, np.random.default_rng(23).random((20000, 2)), **given)
    pdf = MODELS[model].pdf(view, light, **given)
    weight = MODELS[model].evaluate(view, light, **given) * np.clip(light[:, 2], 0.0, None) / pdf
    mean, sigma = weight.mean(), weight.std() / math.sqrt(len(weight))
    assert abs(mean - MODELS[model].albedo(mu, **given)[0]) < 5.0 * sigma + 1e-9
    assert sigma < 0.02 * mean


def test_sampling_at_the_ends_of_the_unit_square():
    for model in POWERS.values():
        for n in (1.0, 100000.0):
            light = model.sample(quadrature.view_at(0.5), [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)], exponent=n)
            assert np.isfinite(light).all()
            np.testing.assert_allclose(light[2:], np.tile([-math.sqrt(0.75), 0.0, 0.5], (2, 1)), atol=1e-7)


# Parameters


def test_roughness_and_exponent():
    """n = 2 / r^4 - 2, held to 1 .. 100000."""
    assert brdf.exponent_of_roughness(0.5) == pytest.approx(30.0)
    assert brdf.exponent_of_roughness(1.0) == 1.0
    assert brdf.exponent_of_roughness(0.0) == 100000.0
    for n in EXPONENTS:
        assert brdf.exponent_of_roughness(brdf.roughness_of_exponent(n)) == pytest.approx(n, rel=1e-9)
    view, light = upper_pairs(40, seed=2)
    lit = MODELS["phong"].evaluate(view, light) > 0.0
    view, light = view[lit], light[lit]
    for model in POWERS.values():
        by_exponent = model.evaluate(view, light, exponent=30.0)
        np.testing.assert_allclose(model.evaluate(view, light, roughness=0.5), by_exponent, rtol=1e-12)
        both = {"exponent": 30.0, "roughness": 0.9, "use_roughness": False}
        np.testing.assert_allclose(model.evaluate(view, light, **both), by_exponent, rtol=1e-12)
        assert np.abs(model.evaluate(view, light, roughness=0.6) / by_exponent - 1.0).max() > 0.1


@pytest.mark.parametrize("model", MODELS.values(), ids=list(MODELS))
def test_declaration_is_complete(model):
    assert model.label and model.description and model.formula and model.references
    ids = [parameter.id for parameter in model.parameters]
    assert len(ids) == len(set(ids))
    for parameter in model.parameters:
        assert parameter.label and parameter.help
        assert parameter.check(parameter.default) == parameter.default
        assert parameter.minimum < parameter.maximum


# Colour factor


def test_schlick_runs_from_colour_to_edge():
    f0, f90 = (0.9, 0.5, 0.1), (1.0, 0.8, 0.4)
    np.testing.assert_allclose(fresnel.schlick([1.0, 0.0], f0, f90), [f0, f90], rtol=1e-14)
    # 60 degrees: 1/32 of the way.
    np.testing.assert_allclose(fresnel.schlick(0.5, f0, f90)[0], [0.9 + 0.1 / 32, 0.5 + 0.3 / 32, 0.1 + 0.3 / 32])


def fresnel_by_complex_numbers(mu, index):
    """Unpolarised reflectance of a surface with a complex index, from Snell's law and Fresnel's amplitudes."""
    inside = np.sqrt(1.0 - (1.0 - mu * mu) / index**2 + 0j)
    perpendicular = (mu - index * inside) / (mu + index * inside)
    parallel = (index * mu - inside) / (index * mu + inside)
    return 0.5 * (abs(perpendicular) ** 2 + abs(parallel) ** 2)


def test_conductor_is_fresnel_with_a_complex_index():
    rng = np.random.default_rng(4)
    mu = np.concatenate([[0.0, 1.0, 1e-3, 0.999], rng.random(200)])
    for n, k in [(0.2, 3.9), (0.001, 5.5), (1.5, 0.0), (2.9, 3.1), (20.0, 40.0), *rng.uniform(0.01, 5.0, (8, 2))]:
        found = fresnel.conductor(mu, [n], [k])[:, 0]
        np.testing.assert_allclose(found, fresnel_by_complex_numbers(mu, complex(n, k)), rtol=1e-9, atol=1e-12)
        assert found[0] == pytest.approx(1.0, abs=1e-12)  # grazing
        assert found[1] == pytest.approx(((n - 1) ** 2 + k * k) / ((n + 1) ** 2 + k * k), rel=1e-12)
        assert found.min() >= 0.0 and found.max() <= 1.0 + 1e-12
    assert np.isfinite(fresnel.conductor(mu, [0.0], [0.0])).all()


@pytest.mark.parametrize("model", POWERS)
def test_colour_factor_depends_on_view_and_half(model):
    """evaluate() with colour over evaluate() without is the factor at V·H, here by its own formula."""
    view, light = upper_pairs(60, seed=6)
    mu = np.sqrt(0.5 * (1.0 + np.einsum("ij,ij->i", view, light)))
    white = MODELS[model].evaluate(view, light, exponent=3.0)
    lit = white > 0.0
    gold = metals.METALS["gold"]
    metal = MODELS[model].evaluate(view, light, exponent=3.0, fresnel_type="conductor", ior=gold.ior,
                                   extinction=gold.extinction)
    for channel, index in enumerate(complex(n, k) for n, k in zip(gold.ior, gold.extinction, strict=True)):
        np.testing.assert_allclose(metal[lit, channel] / white[lit], fresnel_by_complex_numbers(mu, index)[lit],
                                   rtol=1e-8)
    edge = MODELS[model].evaluate(view, light, exponent=3.0, fresnel_type=1, base_color=(0.2, 0.0, 1.0), f90=0.7)
    expected = np.array([0.2, 0.0, 1.0]) + (0.7 - np.array([0.2, 0.0, 1.0])) * (1.0 - mu[lit, None]) ** 5
    np.testing.assert_allclose(edge[lit] / white[lit, None], expected, rtol=1e-9)
    assert lit.sum() > 20


# Bad input: an error that says in fields what is wrong, in one line that names the value and what is allowed


def calls(model, **given):
    """The four ways to ask a model for something."""
    up = (0.0, 0.0, 1.0)
    return (lambda: model.evaluate(up, up, **given), lambda: model.albedo(0.5, **given),
            lambda: model.sample(up, (0.5, 0.5), **given), lambda: model.pdf(up, up, **given))


@pytest.mark.parametrize(("given", "code", "allowed"), [
    ({"exponent": 0.5}, "range", (1.0, 1e5)), ({"exponent": 2e5}, "range", (1.0, 1e5)),
    ({"exponent": math.nan}, "range", (1.0, 1e5)), ({"exponent": math.inf}, "range", (1.0, 1e5)),
    ({"exponent": "sharp"}, "type", ()), ({"exponent": [1.0, 2.0]}, "type", ()), ({"exponent": None}, "type", ()),
    ({"roughness": -0.1}, "range", (0.0, 1.0)), ({"pumps": 4.5}, "range", (0.0, 4.0)),
    ({"pumps": -1}, "range", (0.0, 4.0)), ({"control": 2}, "range", (0, 1)), ({"control": 0.5}, "type", ()),
    ({"control": "yes"}, "type", ()), ({"fresnel_type": "metal"}, "choice", ("constant", "schlick", "conductor")),
    ({"fresnel_type": 3}, "range", (0, 2)), ({"fresnel_type": 0.5}, "type", ()),
    ({"base_color": (1.0, 0.5, 1.5)}, "range", (0.0, 1.0)), ({"base_color": (1.0, 0.5)}, "shape", ()),
    ({"base_color": (1.0, math.nan, 0.5)}, "range", (0.0, 1.0)), ({"base_color": "red"}, "type", ()),
    ({"f90": -1.0}, "range", (0.0, 1.0)), ({"ior": 21.0}, "range", (0.0, 20.0)),
    ({"extinction": (1, 2, 41)}, "range", (0.0, 40.0)), ({"shading_normal": 1.0}, "shape", ()),
])
def test_bad_parameters(given, code, allowed):
    (name, value), = given.items()
    for call in calls(MODELS["pumped_phong"], **given):
        with pytest.raises(ParameterError) as caught:
            call()
        error = caught.value
        assert (error.parameter, error.code, error.allowed) == (name, code, allowed)
        assert np.array_equal(error.value, np.broadcast_to(value, np.shape(error.value)), equal_nan=code == "range")
        message = str(error)
        assert message.startswith(f"{name}: ") and "\n" not in message
        assert all((end if code == "choice" else f"{end:g}") in message for end in allowed)


def test_a_message_names_the_value_and_what_is_allowed():
    rejected(calls(MODELS["phong"], exponent=0.5)[0], "exponent: 0.5 is outside 1 .. 100000")
    rejected(calls(MODELS["phong"], fresnel_type="metal")[0], "'metal' is not one of constant, schlick, conductor")
    rejected(calls(MODELS["pumped_phong"], roughness=0.5, exponent=20.0)[0], "exponent", "not both", "0.5", "20.0")


def test_unknown_names():
    for model, name in (("pumped_phong", "shininess"), ("phong", "pumps")):
        for call in calls(MODELS[model], **{name: 1.0}):
            with pytest.raises(UnknownParameter) as caught:
                call()
            assert (caught.value.model, caught.value.parameter) == (model, name)
            assert caught.value.allowed == tuple(p.id for p in MODELS[model].parameters)
    with pytest.raises(UnknownModel) as caught:
        brdf.find_model("wart")
    assert caught.value.model == "wart" and caught.value.allowed == tuple(MODELS)
    assert "wart" in str(caught.value) and "phong_limit" in str(caught.value)


def test_errors_come_whole_from_another_process():
    for error in (ParameterError("exponent", "range", 0.5, "too small", (1.0, 2.0)), UnknownModel("wart", ["ward"]),
                  ArgumentError("view", "length", "no unit vector"), TableError("gone", "missing", "a.exr")):
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error) and str(again) == str(error) and vars(again) == vars(error)
        assert isinstance(again, ValueError)


def refused(call, argument, code):
    with pytest.raises(ArgumentError) as caught:
        call()
    assert (caught.value.argument, caught.value.code) == (argument, code)
    assert str(caught.value).startswith(f"{argument}: ") and "\n" not in str(caught.value)


@pytest.mark.parametrize(("bad", "code"), [
    ((0.0, 0.0, 2.0), "length"), ((0.0, 0.0, 0.0), "length"), ((0.0, 0.0), "shape"), (np.zeros((1, 1, 3)), "shape"),
    ((0.0, math.nan, 1.0), "finite"), ("up", "type"), ([[0.0, 0.0, 1.0], [0.0, 1.0]], "type"),
])
def test_bad_directions(bad, code):
    model, up = MODELS["phong"], (0.0, 0.0, 1.0)
    refused(lambda: model.evaluate(bad, up), "view", code)
    refused(lambda: model.evaluate(up, bad), "light", code)
    refused(lambda: model.pdf(up, bad), "light", code)
    refused(lambda: model.sample(bad, (0.5, 0.5)), "view", code)


def test_directions_of_unequal_number():
    two, three = np.tile([0.0, 0.0, 1.0], (2, 1)), np.tile([0.0, 0.0, 1.0], (3, 1))
    refused(lambda: MODELS["phong"].evaluate(two, three), "view, light", "rows")
    refused(lambda: MODELS["phong"].pdf(two, three), "view, light", "rows")
    refused(lambda: MODELS["phong"].sample(two, np.full((3, 2), 0.5)), "view, u", "rows")


def test_slightly_unnormalised_directions_are_normalised():
    view, light = upper_pairs(10, seed=9)
    np.testing.assert_allclose(MODELS["phong"].evaluate(view * 1.00005, light), MODELS["phong"].evaluate(view, light),
                               rtol=1e-12)
    refused(lambda: MODELS["phong"].evaluate(view * 1.0002, light), "view", "length")


@pytest.mark.parametrize(("bad", "code"), [
    (-0.1, "range"), ([0.5, 1.1], "range"), (math.nan, "range"), ([], "shape"), ([[0.5]], "shape"),
])
def test_bad_cosines(bad, code):
    refused(lambda: MODELS["phong"].albedo(bad), "cos_theta", code)


@pytest.mark.parametrize(("bad", "code"), [
    ((0.5, 1.5), "range"), ((math.nan, 0.5), "range"), ((0.1, 0.2, 0.3), "shape"),
])
def test_bad_uniform_numbers(bad, code):
    refused(lambda: MODELS["blinn"].sample((0.0, 0.0, 1.0), bad), "u", code)
