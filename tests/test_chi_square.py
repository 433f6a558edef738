"""Every model's sampler draws with the density that it claims; and the test that says so sees what is planted."""
import json
import zlib

import numpy as np
import pytest
from scipy import stats

from addon import cli
from addon.brdf import MODELS
from addon.models.geometry import around, in_plane
from addon.models.samplers import AxisPower, Cosine
from addon.statistics import chi_square
from addon.statistics.chi_square import compare, significance

pytestmark = pytest.mark.proof
SAMPLES = 1_000_000
TURN = np.radians(25.0)  # azimuth of views: no plane of symmetry is a line of the grid


def extreme(model, end):
    """The parameters that say how wide a model's lobes are, each at its "minimum" or "maximum"."""
    return {name: getattr(model.parameter(name), end) for name in model.widths}


def crossed(model, low="minimum", high="maximum"):
    """Its widths along and across the tangent as unlike as can be."""
    return {name: getattr(model.parameter(name), end) for name, end in zip(model.axes, (low, high), strict=True)}


def configurations():
    """{name: (model, parameters, view's angle in degrees)}."""
    found = {}

    def add(name, angle, **parameters):
        values = ", ".join(f"{key} = {value}" for key, value in parameters.items())
        found[f"{name} at {angle:g}: {values or 'defaults'}"] = name, parameters, angle

    for name, model in MODELS.items():
        add(name, 0.0)
        add(name, 89.9)
        add(name, 60.0, **extreme(model, "minimum"))
        add(name, 85.0, **extreme(model, "maximum"))
        if model.axes:
            add(name, 80.0, **crossed(model))
    for n in (1.0, 1e5):
        add("phong", 0.0, exponent=n)
        add("blinn", 89.9, exponent=n)
        add("reciprocal_disk", 88.0, exponent=n)
    add("disk_scaling", 40.0, radius_u=0.05, radius_v=0.6, rotation=0.2)
    add("disk_orthogonal", 85.0, exponent=0.0)
    add("edwards_empirical", 60.0, retro=0.5, retro_exponent=1000.0, base_color=0.6)
    add("edwards_empirical", 85.0, retro=1.0, base_color=1.0, vary_exponents=True, retro_grazing_exponent=3.0)
    add("edwards_fit", 70.0, blend=0.8, renormalize=False, base_color=1.0)
    add("ward", 45.0, roughness_u=0.05, roughness_v=0.5, diffuse_color=0.4)
    add("ashikhmin_shirley", 70.0, exponent_u=1000.0, exponent_v=10.0, base_color=0.3, diffuse_color=0.6)
    add("ndf_map", 45.0, rotation=0.3, diffuse_color=0.5)
    return found


CONFIGURATIONS = configurations()
BOUND = significance(0.01, len(CONFIGURATIONS))


def view_at(angle):
    polar = np.radians(angle)
    return np.array([np.sin(polar) * np.cos(TURN), np.sin(polar) * np.sin(TURN), np.cos(polar)])


def test_the_configurations_are_enough():
    assert len(CONFIGURATIONS) >= 120
    sampled = {name for name, _, _ in CONFIGURATIONS.values()}
    assert sampled == set(MODELS) and len(sampled) >= 34
    assert {angle for _, _, angle in CONFIGURATIONS.values()} >= {0.0, 60.0, 80.0, 85.0, 89.9}
    assert (1.0 - BOUND) ** len(CONFIGURATIONS) == pytest.approx(0.99, rel=1e-9)


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_samples_follow_the_density(name, tmp_path):
    model, parameters, angle = CONFIGURATIONS[name]
    result = chi_square.of_model(MODELS[model], parameters, view_at(angle), SAMPLES, zlib.crc32(name.encode()))
    if not result.p_value > BOUND:
        result.draw(tmp_path / "densities.png", name)
    assert result.p_value > BOUND, f"{name}: p = {result.p_value:.3g}, see {tmp_path / 'densities.png'}"
    assert result.counts.shape == (200, 100) and result.counts.sum() + result.undrawn[0] == SAMPLES
    # The error of what was expected is far below the noise of what was found; most of all of an image's steps.
    assert result.fine.bias < (0.2 if model == "ndf_map" else 0.05) * np.sqrt(2.0 * result.fine.degrees)


# What is planted is found: densities and samplers that are a little wrong.

VIEW = in_plane([50.0])
LOBE = MODELS["phong"]


def lobe_draws(exponent=20.0, view=VIEW):
    return LOBE.sample(view, np.random.default_rng(1).random((SAMPLES, 2)), exponent=exponent)


def lobe_pdf(light, exponent=20.0):
    return LOBE.pdf(VIEW, light, exponent=exponent)


def side(light):
    """A half of the sphere that parts the lobe in two equal halves."""
    return light[:, 1] > 0.0


WRONG = {
    "1.01 on a half, 0.99 on the other": lambda light: lobe_pdf(light) * np.where(side(light), 1.01, 0.99),
    "1.01 on a half": lambda light: lobe_pdf(light) * np.where(side(light), 1.01, 1.0),
    "0.99 on a half": lambda light: lobe_pdf(light) * np.where(side(light), 0.99, 1.0),
    "exponent 2 % up": lambda light: lobe_pdf(light, 20.4),
    "exponent 2 % down": lambda light: lobe_pdf(light, 19.6),
    "tilt": lambda light: lobe_pdf(light) * (1.0 + 0.1 * light[:, 1]),
    "a hole": lambda light: lobe_pdf(light) * (np.abs(light[:, 1] - 0.1) > 1e-3),
    "nothing below the horizon": lambda light: lobe_pdf(light) * (light[:, 2] > 0.0),
    "not a number": lambda light: np.where(light[:, 2] > 0.9, np.nan, lobe_pdf(light)),
}


def test_the_right_density_passes():
    assert compare(lobe_draws(), lobe_pdf).p_value > BOUND


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_densities_are_found(wrong):
    assert compare(lobe_draws(), WRONG[wrong]).p_value < BOUND


def drawn_wrongly():
    u = np.random.default_rng(2).random((SAMPLES, 2))
    light = lobe_draws()
    missing = light.copy()
    missing[::1000] = np.nan
    stray = light.copy()
    stray[-1] = -light[-1]
    return {"view 0.3 degrees off": lobe_draws(view=in_plane([50.3])), "exponent 2 % up": lobe_draws(20.4),
            "one in a thousand is not drawn": missing, "one stray in a million": stray,
            "uniform numbers squared a little": LOBE.sample(VIEW, u ** [1.01, 1.0], exponent=20.0),
            "a quarter turn is short": LOBE.sample(VIEW, u * [1.0, 0.999], exponent=20.0)}


def test_wrong_samplers_are_found():
    for name, light in drawn_wrongly().items():
        assert compare(light, lobe_pdf).p_value < BOUND, name


# The test itself.

def test_p_values_are_uniform_where_the_density_is_right():
    """A hundred tests of Lambert's cosine: as many p values below any number as there should be."""
    view, found = np.zeros((1, 3)), []
    for seed in range(100):
        u = np.random.default_rng(seed).random((20000, 2))
        found.append(compare(Cosine().sample(view, u), lambda light: Cosine().pdf(view, light), (30, 16)))
    for values in ([r.fine.p_value for r in found], [r.coarse.p_value for r in found]):
        assert stats.kstest(values, "uniform").pvalue > 1e-3
    assert 0.7 < np.mean([r.fine.statistic / r.fine.degrees for r in found]) < 1.3


@pytest.mark.parametrize("n", [1.0, 50.0, 1e5])
def test_integrals_over_cells_against_closed_form(n):
    """A power about the normal: (z_1^(n+1) - z_0^(n+1)) times the part of a turn."""
    sampler = AxisPower(lambda view: np.array([[0.0, 0.0, 1.0]]), n)
    light = sampler.sample(None, np.random.default_rng(3).random((200000, 2)))
    result = compare(light, lambda light: sampler.pdf(None, light))
    upto = np.maximum(result.cosines, 0.0) ** (n + 1.0)
    exact = np.diff(result.azimuths)[:, None] / (2.0 * np.pi) * np.diff(upto) * result.counts.sum()
    assert np.abs(result.expected - exact).max() < 0.03 * np.sqrt(exact.max())
    assert ((result.expected - exact) ** 2 / np.maximum(exact, 1.0)).sum() < 0.02 * np.sqrt(2.0 * result.fine.degrees)


def test_integrals_of_a_density_with_an_edge():
    """A cap about a slanted axis, its rim through the cells: of each of its rings as much as lies within."""
    axis, rim = in_plane([40.0])[0], np.cos(np.radians(20.0))
    area = 2.0 * np.pi * (1.0 - rim)
    u = np.random.default_rng(4).random((400000, 2))
    light = around(axis[None], 1.0 - u[:, 0] * (1.0 - rim), 2.0 * np.pi * u[:, 1])
    result = compare(light, lambda light: np.where(light @ axis > rim, 1.0 / area, 0.0))
    assert result.p_value > 1e-3 and result.integral == pytest.approx(1.0, abs=2e-5)
    # A ring between cosines z_0 and z_1 has of the cap the integral of the azimuth that lies inside: by many nodes.
    z = result.cosines[:-1, None] + np.diff(result.cosines)[:, None] * (np.arange(2000) + 0.5) / 2000
    cosine = (rim - axis[2] * z) / np.maximum(axis[0] * np.sqrt(1.0 - z * z), 1e-12)
    rings = (2.0 * np.arccos(np.clip(cosine, -1.0, 1.0))).mean(axis=1) * np.diff(result.cosines) / area
    found = result.expected.sum(axis=0) / result.counts.sum()
    np.testing.assert_allclose(found, rings, atol=5e-5)  # a third of the noise of a count, or less


def test_what_is_not_drawn_is_a_cell_of_its_own():
    """Only what lies above the horizon is drawn of a lobe that reaches below it, and its density says so."""
    light = lobe_draws(2.0)
    light[light[:, 2] <= 0.0] = np.nan

    def above(light):
        return np.where(light[:, 2] > 0.0, lobe_pdf(light, 2.0), 0.0)

    result = compare(light, above)
    assert result.p_value > 1e-3 and result.undrawn[0] == np.isnan(light[chi_square.PILOT:, 0]).sum() > 10000
    assert result.undrawn[1] == pytest.approx(result.undrawn[0], abs=5.0 * np.sqrt(result.undrawn[0]))


def test_picture(tmp_path):
    from matplotlib import image

    result = compare(lobe_draws()[:50000], lobe_pdf)
    result.draw(tmp_path / "a.png", "Phong")
    assert image.imread(tmp_path / "a.png").shape[1] > 1000
    with pytest.raises(ValueError, match="png"):
        result.draw(tmp_path / "a.jpg")


@pytest.mark.parametrize(("change", "words"), [
    ({"directions": np.zeros((5, 2))}, "shape"), ({"directions": 2.0 * np.eye(3)}, "unit vectors"),
    ({"directions": np.eye(3)}, "too few"), ({"cells": (1, 100)}, "cells"), ({"cells": (20, 10.5)}, "cells"),
    ({"pdf": lambda light: -np.ones(len(light))}, "density"), ({"pdf": lambda light: 1.0}, "shape"),
])
def test_bad_input(change, words):
    good = {"directions": lobe_draws()[:10000], "pdf": lobe_pdf}
    with pytest.raises(ValueError, match=words):
        compare(**{**good, **change})


# The command.

def test_command(tmp_path, capsys):
    path = tmp_path / "ward.png"
    call = ["chi2", "ward", "--set", "roughness_u=0.3", "--view", "70", "--samples", "100000", "--json"]
    assert cli.main([*call, "--output", str(path)]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["passes"] and report["parameters"] == {"roughness_u": 0.3} and report["cells"] == [200, 100]
    assert report["samples"] == 100000 and 0.01 < report["p_value"] <= 1.0 and path.stat().st_size > 10000
    assert cli.main(call[:-1]) == 0
    text = capsys.readouterr().out
    assert "Ward, 70°, roughness_u = 0.3: 100000 directions in 200 x 100 cells" in text and text.endswith("ok\n")


def test_command_says_what_fails(monkeypatch, capsys):
    model = type(MODELS["phong"])
    right = model._pdf
    monkeypatch.setattr(model, "_pdf", lambda self, view, light, p: right(self, view, light, {**p, "exponent": 22.0}))
    assert cli.main(["chi2", "phong", "--samples", "100000"]) == 1
    assert "FAILED" in capsys.readouterr().out


@pytest.mark.parametrize("wrong", [
    ["wart"], ["phong", "--view", "91"], ["phong", "--samples", "10"], ["phong", "--cells", "1", "1"],
    ["phong", "--set", "exponent=-1"], ["phong", "--seed", "-1"], ["phong", "--significance", "0"],
    ["phong", "--output", "a.jpg"]])
def test_wrong_calls(wrong, capsys):
    assert cli.main(["chi2", *wrong]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.startswith("plausible chi2: ") and printed.err.count("\n") == 1
