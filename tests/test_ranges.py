"""Lobe rows over ranges of driven parameters: which values they are baked for, and how exact it is between these."""
import json
from dataclasses import replace

import numpy as np
import pytest

from addon import cli
from addon.backends.osl import assembler, estimator
from addon.brdf import MODELS
from addon.forms.rows import error as rows_error
from addon.forms.rows import grid, layout, row_bake
from addon.models.pumped_model import PumpedModel

BAKED = [model for model in MODELS.values() if estimator.is_baked(model)]


def directions(count=400):
    rng = np.random.default_rng(5)
    mu, phi = rng.uniform(0.02, 1.0, (2, count)), rng.uniform(0.0, 2.0 * np.pi, (2, count))
    sine = np.sqrt(1.0 - mu**2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


@pytest.fixture
def zeros(monkeypatch):
    """Lobe rows that cost nothing."""
    def few(model, parameters, common=None):
        return replace(row_bake.blank(model, parameters), layout=common or layout.ROUND)

    monkeypatch.setattr(row_bake, "bake", few)
    monkeypatch.setattr(grid, "_kept", {})


def steps(model, driven, **given):
    return {each.parameter.id: [each.value(i) for i in range(each.steps)]
            for each in grid.bake(MODELS[model], given, driven).ranges}


def test_widths_go_in_equal_ratios(zeros):
    found = steps("cook_torrance", {"roughness": (0.1, 0.4)})["roughness"]
    assert found[0] == 0.1 and found[-1] == pytest.approx(0.4) and len(found) == 9
    np.testing.assert_allclose(np.divide(found[1:], found[:-1]), 4.0 ** (1.0 / 8.0))
    assert max(np.divide(found[1:], found[:-1])) <= grid.WIDER


def test_exponents_go_in_the_squares_of_these(zeros):
    found = steps("blinn_original", {"exponent": (10.0, 160.0)})["exponent"]
    assert len(found) == 9 and found[1] / found[0] == pytest.approx(16.0 ** (1.0 / 8.0))


def test_what_is_linear_has_two_steps(zeros):
    black, white = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    assert steps("ward", {"base_color": (0.0, 1.0)}) == {"base_color": [black, white]}
    assert steps("ward", {"base_color": (0.0, 1.0)}, diffuse_color=0.3) == {"base_color": [black, white]}
    both = {"base_color": (0.0, 1.0), "diffuse_color": (0.0, 1.0)}
    assert steps("blinn_fresnel", both) == {name: [black, white] for name in both}
    assert steps("cook_torrance", {"base_color": (0.0, 1.0)}, fresnel_type="schlick") == {"base_color": [black, white]}
    assert len(steps("weighted_lobes", {"weight_1": (0.0, 1.0)})["weight_1"]) == 2


def test_what_bends_has_more_and_what_is_not_read_one(zeros):
    metal = {"fresnel_type": "conductor"}
    assert len(steps("blinn_fresnel", {"ior": (0.1, 3.0)}, **metal)["ior"]) == grid.EVEN_STEPS
    assert steps("blinn_fresnel", {"ior": (0.0, 20.0)})["ior"] == [(10.0, 10.0, 10.0)]


def test_narrow_lobes_are_seen(zeros):
    assert len(steps("ward", {"roughness_u": (0.01, 0.02)}, roughness_v=0.01)["roughness_u"]) == 5
    assert len(steps("blinn_original", {"exponent": (9000.0, 10000.0)})["exponent"]) == 2
    assert len(steps("blinn_original", {"base_color": (0.0, 1.0)}, exponent=10000.0)["base_color"]) == 2


def test_many_sets_have_fewer_views(zeros):
    few = grid.bake(MODELS["blinn_fresnel"], {}, {"exponent": (30.0, 90.0)})
    driven = {"exponent": (30.0, 90.0), "base_color": (0.0, 1.0), "diffuse_color": (0.0, 1.0)}
    many = grid.bake(MODELS["blinn_fresnel"], {"fresnel_type": "schlick"}, driven)
    assert len(many.nodes) == 4 * len(few.nodes) and few.nodes[0].layout.views == layout.ROUND.views
    assert many.nodes[0].layout.views == round(0.8 * layout.ROUND.views)


def test_what_comes_back_half_way_is_read(zeros):
    """The star of an NDF map is the same after half a turn."""
    assert len(steps("ndf_map", {"rotation": (0.0, 1.0)})["rotation"]) == grid.EVEN_STEPS


def test_steps_are_for_all_that_the_others_may_be(zeros):
    """An index is read by the conductor only, which is one of the driven choices."""
    driven = {"fresnel_type": (0, 2), "ior": (0.1, 3.0)}
    found = steps("blinn_fresnel", driven, extinction=2.0)
    assert len(found["ior"]) == grid.EVEN_STEPS and found["fresnel_type"] == [0, 1, 2]
    # What driven parameters are otherwise changes nothing.
    assert steps("blinn_fresnel", driven, extinction=2.0, ior=2.0) == found


@pytest.mark.parametrize("least", np.linspace(-1.19, 1.19, 60).round(3))
def test_rounding_leads_to_no_step_beyond(zeros, least):
    parameter = MODELS["lafortune"].parameter("cxy_1")
    each = grid.Range(parameter, least, 1.2, 9)
    assert parameter.check(each.value(8)) == pytest.approx(1.2)
    exponent = MODELS["blinn_original"].parameter("exponent")
    low = 4000.0 + 50.0 * least
    assert exponent.check(grid.Range(exponent, low, 10000.0, 9, geometric=True).value(8)) == pytest.approx(10000.0)


def test_sets_are_kept_while_they_are_used(zeros):
    first = grid.bake(MODELS["ward"], {}, {"roughness_u": (0.1, 0.2)})
    for i in range(2 * grid._KEPT):
        grid.bake(MODELS["ward"], {"roughness_v": 0.1 + 0.01 * i}, {"base_color": (0.0, 1.0)})
        assert grid.bake(MODELS["ward"], {}, {"roughness_u": (0.1, 0.2)}) is first
    assert len(grid._kept) == grid._KEPT


def test_switches_have_all_their_values(zeros):
    assert steps("blinn_fresnel", {"fresnel_type": (0, 2)})["fresnel_type"] == [0, 1, 2]
    assert steps("pumped_ward", {"control": (0, 1)})["control"] == [False, True]


def test_sets_are_in_the_order_that_the_shader_counts(zeros):
    baked = grid.bake(MODELS["blinn_fresnel"], {}, {"exponent": (10.0, 20.0), "base_color": (0.0, 1.0)})
    assert [each.parameter.id for each in baked.ranges] == ["base_color", "exponent"]
    assert len(baked.nodes) == baked.ranges[0].steps * baked.ranges[1].steps
    assert baked.at([1, 0]) is baked.nodes[baked.ranges[1].steps]
    text = assembler.assemble(MODELS["blinn_fresnel"], baked=baked)
    assert f"#define W_SETS {len(baked.nodes)}\n" in text and "#define RANGE_STEPS 2, 3\n" in text
    places = "range_place(base_color, 0.0, 1.0, 2, 0), range_place(color(exponent), 10.0, 20.0, 3, 1)"
    assert f"#define RANGE_PLACES {places}\n" in text and "#define RANGE_STORAGE 0, -1, -1, -1, -1, -1\n" in text
    assert "abs(exponent -" not in text and "abs(diffuse_color[0] -" in text


@pytest.mark.parametrize("name, driven, words", [
    ("ward", {"roughness_u": (0.3, 0.3)}, "roughness_u: a range from 0.3 to 0.3 is none"),
    ("ward", {"roughness_u": (0.3, 0.2)}, "a range from 0.3 to 0.2 is none"),
    ("ward", {"roughness_u": (0.0, 0.2)}, "roughness_u: 0 is outside 0.01 .. 1"),
    ("ward", {"roughness_u": (0.1, float("nan"))}, "roughness_u: nan is outside"),
    ("ndf_map", {"image": ("", "")}, "image: it has no range"),
    ("ward", {"samples": (1, 8)}, "samples: it has no range"),
    ("ward", {"width": (1, 8)}, "no parameter 'width'"),
    ("ward", {"roughness_u": (0.01, 1.0), "roughness_v": (0.01, 1.0)},
     "too many steps for one shader, 27 of Slope U times 27 of Slope V"),
])
def test_what_is_no_range_is_told(name, driven, words):
    with pytest.raises(ValueError, match=words.replace("(", r"\(")):
        grid.bake(MODELS[name], {}, driven)


def test_progress_is_told_and_can_end_it(zeros):
    told = []
    grid.bake(MODELS["ward"], {}, {"base_color": (0.0, 1.0)}, tell=lambda *each: told.append(each))
    assert told == [(0, 2), (1, 2), (2, 2)]

    def end(done, total):
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        grid.bake(MODELS["ward"], {}, {"roughness_u": (0.1, 0.2)}, tell=end)


# Pumped formulas have the parameters and lobes of the plain ones, and take long to look at: one stands for all.
UNLIKE = [each for each in BAKED if not isinstance(each, PumpedModel) or each.id == "pumped_ward"]


@pytest.mark.parametrize("model", UNLIKE, ids=lambda model: model.id)
def test_usual_ranges_hold_the_value_and_fit_into_one_shader(zeros, model):
    p = model.resolve({})
    for q in model.parameters:
        if q.can_be_driven:
            least, most = grid.check(q, *q.usual_range(p[q.id]))
            assert least <= np.min(p[q.id]) <= np.max(p[q.id]) <= most
            assert grid.bake(model, {}, {q.id: (least, most)}).nodes
            for edge in (q.minimum, q.maximum):
                grid.check(q, *q.usual_range((edge,) * 3 if q.kind == "color" else edge))


@pytest.mark.parametrize("model", BAKED, ids=lambda model: model.id)
def test_each_channel_goes_by_its_own_values(model):
    """The red of a formula depends on the red of its colours only: what sets of gray steps take for granted."""
    view, light = directions()
    colours = [q for q in model.parameters if q.kind == "color"]
    choices = [q for q in model.parameters if q.kind == "enum"]
    for choice in range(len(choices[0].items) if choices else 1):
        given = {choices[0].id: choice} if choices else {}
        rgb = {q.id: tuple(q.minimum + (q.maximum - q.minimum) * s for s in (0.9, 0.4, 0.1)) for q in colours}
        value = model.evaluate(view, light, **given, **rgb)
        for channel in range(3):
            gray = model.evaluate(view, light, **given, **{name: (c[channel],) * 3 for name, c in rgb.items()})
            of_gray = gray[:, 0] if gray.ndim == 2 else gray
            np.testing.assert_allclose(value[:, channel] if value.ndim == 2 else value, of_gray, rtol=1e-9, atol=1e-300)


def test_steps_that_are_too_far_apart_are_told(monkeypatch):
    """Halfway between two steps the error grows with the square of how far apart they are."""
    model, driven = MODELS["blinn_original"], {"exponent": (20.0, 45.0)}
    within = rows_error.largest(model, {}, driven)
    assert 0.002 < within[0] < 0.03 and within[1] < 0.02
    monkeypatch.setattr(grid, "WIDER", 1.5)
    monkeypatch.setattr(grid, "_kept", {})
    beyond = rows_error.largest(model, {}, driven)
    assert beyond[0] > 2.0 * within[0] and beyond[1] > 2.0 * within[1]


def test_what_is_linear_is_as_exact_as_its_ends(monkeypatch):
    model, driven = MODELS["blinn_original"], {"base_color": (0.0, 1.0)}
    exact = rows_error.error(model, {}).largest()
    assert rows_error.largest(model, {}, driven)[0] < exact[0] + 2e-3
    white = row_bake.bake(model, {})
    brighter = replace(white, facets=replace(white.facets, colour=1.1 * white.facets.colour))
    monkeypatch.setattr(grid, "_kept", {})
    real = row_bake.bake
    monkeypatch.setattr(row_bake, "bake", lambda m, p, common=None: brighter
                        if p["base_color"] == (1.0, 1.0, 1.0) else real(m, p, common))
    assert rows_error.largest(model, {}, driven)[1] > 0.05


def test_round_and_stretched_sets_share_a_layout():
    """Along a range of one slope a lobe is round at one step only: all are laid out as stretched, each to its width."""
    baked = grid.bake(MODELS["ward"], {"roughness_v": 0.2}, {"roughness_u": (0.2, 0.22)})
    assert [rows.layout.azimuths for rows in baked.nodes] == [layout.STRETCHED.azimuths] * 2
    assert baked.nodes[0].layout.stretch == (1.0, 1.0) and baked.nodes[1].layout.stretch[1] < 0.95
    assert rows_error.largest(MODELS["ward"], {"roughness_v": 0.2}, {"roughness_u": (0.2, 0.22)})[0] < 0.02


def test_brightness_is_about_the_albedo():
    model = MODELS["blinn_original"]
    white, gray, black = (row_bake.bake(model, {"base_color": c}).brightness for c in (1.0, 0.5, 0.0))
    assert black == 0.0 and gray == pytest.approx(0.5 * white, rel=0.02)


def test_the_command_states_it(capsys):
    arguments = ["bake", "--weights", "blinn_original", "--drive", "exponent=40:50"]
    assert cli.main([*arguments, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["sets"] == 2 and found["steps"] == {"exponent": [40.0, pytest.approx(50.0)]}
    assert (found["lobe"], found["albedo"]) == rows_error.largest(
        MODELS["blinn_original"], {}, {"exponent": (40.0, 50.0)})
    assert cli.main(arguments) == 0
    assert "exponent: 40, 50\n" in capsys.readouterr().out
    for wrong, words in (("exponent", "is not PARAMETER=FROM:TO"), ("exponent=1", "is not PARAMETER=FROM:TO"),
                         ("exponent=9:3", "a range from 9 to 3 is none"), ("width=1:2", "no parameter 'width'")):
        assert cli.main(["bake", "--weights", "blinn_original", "--drive", wrong]) == 2
        assert words in capsys.readouterr().err
