"""Computed properties of the models against what is known of the formulas, and what is published of them."""
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize

from addon import cli
from addon.brdf import MODELS
from addon.dev.compare import agreement, lobes, properties, published
from addon.dev.figures import compare as figures

ROUGH = agreement.SURFACES[0]
SYMMETRIC = ("phong", "blinn", "pumped_phong", "ward", "cook_torrance", "ashikhmin_shirley", "he_torrance",
             "reciprocal_disk")
ONE_WAY = ("disk_scaling", "edwards_empirical", "edwards_fit", "kajiya_kay")


@pytest.fixture(scope="module")
def rows():
    return agreement.matched_rows(ROUGH)


@pytest.mark.parametrize("name", [*SYMMETRIC, *ONE_WAY])
def test_reciprocity(name):
    error = properties.reciprocity_error(MODELS[name], {})
    assert error < 1e-9 if name in SYMMETRIC else error > 0.1


@pytest.mark.parametrize("power", [0.1, 0.01])
def test_a_wrong_factor_is_found(power):
    """f times (N·V)^power is not reciprocal: by 1 - (lower cosine / higher cosine)^power, and lobes are wide enough."""
    ward = MODELS["ward"]
    wrong = replace(ward, lobe=lambda v, light, p: ward.lobe(v, light, p) * v[:, 2] ** power)
    given = {"roughness_u": 0.5, "roughness_v": 0.5}
    angles = np.radians([2.5, 87.5])
    most = 1.0 - (math.cos(angles[1]) / math.cos(angles[0])) ** power
    assert 0.3 * most < properties.reciprocity_error(wrong, given) <= most + 1e-9
    assert properties.reciprocity_error(ward, given) < 1e-9


def test_albedo():
    """DESIGN's check value, and Phong's as first published: 2 pi / (n+2) at the normal."""
    assert properties.largest_albedo(MODELS["blinn"], {"exponent": 20.0}) == (pytest.approx(1.0607, abs=1e-4), 0.0)
    largest, angle = properties.largest_albedo(MODELS["phong_original"], {"exponent": 30.0})
    assert largest == pytest.approx(2.0 * math.pi / 32.0, rel=1e-6) and angle == 0.0
    assert properties.largest_albedo(MODELS["ward_duer"], {})[1] == properties.ALBEDO_ANGLES[-1]


def test_strands_are_seen_across_too():
    """Across, V is at a right angle to the strand: f = (m+2)/(2 pi) sin^(m+1) / N·L, and its albedo the same at any
    angle; along, it has the cosine of the view's angle to the power of m."""
    m = 8.0
    sine = np.sin((np.arange(4000) + 0.5) * math.pi / 4000)  # of the light's angle to the strand; dω = sin dα dφ
    expected = (m + 2.0) / (2.0 * math.pi) * math.pi * np.sum(sine ** (m + 2.0)) * math.pi / 4000
    largest, _ = properties.largest_albedo(MODELS["kajiya_kay"], {"exponent": m})
    assert largest == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize("light", [60.0, 70.0])
def test_off_specular_peaks(light):
    """Ashikhmin and Shirley's beyond the mirror direction: (N·H)^n / V·H, as max(N·L, N·V) is then constant. Cook and
    Torrance's where cos^-4 and 1/N·V win over Beckmann's exponential; G is 1 there for so narrow a lobe."""
    def peak(logarithm):
        found = optimize.minimize_scalar(lambda v: -logarithm(math.radians(v)), bounds=(light, light + 10.0),
                                         method="bounded", options={"xatol": 1e-6})
        return found.x - light

    tilt = math.radians(light)
    n = 400.0
    ashikhmin = peak(lambda v: n * math.log(math.cos(0.5 * (v - tilt))) - math.log(math.cos(0.5 * (v + tilt))))
    found = properties.off_specular(MODELS["ashikhmin_shirley"], {"exponent_u": n, "exponent_v": n}, light)
    assert found == pytest.approx(ashikhmin, abs=0.03) and ashikhmin > 0.3
    m = 0.07
    torrance = peak(lambda v: -(math.tan(0.5 * (v - tilt)) / m) ** 2 - 4.0 * math.log(math.cos(0.5 * (v - tilt)))
                    - math.log(math.cos(v)))
    found = properties.off_specular(MODELS["cook_torrance"], {"roughness": m}, light)
    assert found == pytest.approx(torrance, abs=0.03) and torrance > 0.8


def test_without_an_off_specular_peak():
    for angle in properties.OFF_SPECULAR_ANGLES:
        assert properties.off_specular(MODELS["phong"], {}, angle) == pytest.approx(0.0, abs=0.026)
        assert properties.off_specular(MODELS["blinn"], {}, angle) == pytest.approx(0.0, abs=0.026)
        # Ward's grows as 1/√(N·V): no peak at all.
        assert properties.off_specular(MODELS["ward"], {}, angle) is None
    # Embrechts' keeps growing, to a finite value.
    assert properties.off_specular(MODELS["embrechts"], {"smoothness": 5.0}, 70.0) == 20.0


def test_fresnel():
    """Schlick's factor of 4 % at 85 degrees."""
    expected = 1.0 + 24.0 * (1.0 - math.cos(math.radians(85.0))) ** 5
    for name in ("cook_torrance", "ashikhmin_shirley", "he_torrance", "blinn_fresnel", "disk_scaling", "edwards_fit"):
        assert properties.fresnel(MODELS[name], {}) == pytest.approx(expected, rel=1e-9)
    for name in ("ward", "lafortune", "phong_original", "kajiya_kay"):
        assert properties.fresnel(MODELS[name], {}) == pytest.approx(1.0, rel=1e-12)


def test_anisotropy():
    for name in ("ward", "ward_duer", "ashikhmin_shirley", "disk_scaling", "kajiya_kay"):
        assert properties.anisotropy(MODELS[name], {}) > 0.5
    for name in ("phong", "cook_torrance", "he_torrance", "lafortune", "pumped_ward", "edwards_fit"):
        assert properties.anisotropy(MODELS[name], {}) < 1e-9


def test_diffuse():
    for name, kind in (("phong", "none"), ("pumped_ward", "none"), ("ward", "Lambert"), ("cook_torrance", "Lambert"),
                       ("embrechts", "Lambert"), ("ashikhmin_shirley", "not Lambert"), ("kajiya_kay", "not Lambert"),
                       ("edwards_empirical", "not Lambert")):
        assert properties.diffuse(MODELS[name], {}) == kind, name


def test_mirror_and_wavelength():
    # Smooth, it is a mirror of exp(-g), g = (4 pi sigma N·V / wavelength)², and all of it at grazing but for shadows.
    assert properties.spike(MODELS["he_torrance"], {"sigma": 0.01, "tau": 20.0}) == pytest.approx(1.0, abs=0.01)
    assert properties.dispersion(MODELS["he_torrance"], {}) > 0.1
    for name in ("cook_torrance", "embrechts"):
        assert properties.spike(MODELS[name], {}) == properties.dispersion(MODELS[name], {}) == 0.0


@pytest.mark.parametrize(("name", "law"), [
    ("cook_torrance", "Beckmann"), ("embrechts", "Beckmann"), ("ward", "Beckmann"), ("cosine_microfacet", "power"),
    ("blinn", "power"), ("ashikhmin_shirley", "power"), ("edwards_fit", "neither")])
def test_half_vectors(name, law):
    found, errors = properties.half_vector_distribution(MODELS[name], {})
    assert found == law
    if name in ("cook_torrance", "cosine_microfacet"):  # theirs is that law itself, where nothing is hidden
        assert errors[law] < 1e-4 and max(errors.values()) > 3e-3


@pytest.mark.parametrize("name", ["cook_torrance", "ward", "blinn", "pumped_blinn", "disk_scaling", "kajiya_kay"])
@pytest.mark.parametrize("angle", [3.0, 8.0])
def test_matching(name, angle):
    given = lobes.matched(MODELS[name], angle)
    f = lobes.seen_from_above(MODELS[name], [0.0, angle], {**given, **lobes.those(MODELS[name], pumps=0.0)})
    assert f[1] / f[0] == pytest.approx(0.5, abs=1e-3)


def test_matching_of_known_shapes():
    """cos^n = 1/2; an ellipse becomes round; what cannot be matched says so."""
    n = lobes.matched(MODELS["blinn"], 5.0)["exponent"]
    assert n == pytest.approx(math.log(0.5) / math.log(math.cos(math.radians(5.0))), rel=1e-4)
    given = lobes.matched(MODELS["ward"], 5.0, {"roughness_u": 0.5, "roughness_v": 0.1})
    assert given["roughness_u"] == given["roughness_v"]
    with pytest.raises(ValueError, match="embrechts: a half-angle of 0.001 degrees is out of reach"):
        lobes.matched(MODELS["embrechts"], 0.001)


def test_conformity():
    assert properties.conformity(MODELS["he_torrance"], ROUGH, ROUGH) == pytest.approx(0.0, abs=1e-6)
    assert properties.conformity(MODELS["embrechts"], {}, {"sigma": 0.01, "tau": 20.0}) is None  # is too narrow
    # A rough surface scatters as Beckmann's facets, narrow lobes of which nothing shadows.
    facets = {"sigma": 1.0, "tau": 20.0, "wavelength": 0.38}
    near, far = (properties.conformity(MODELS[name], {}, facets) for name in ("cook_torrance", "disk_scaling"))
    assert near < 0.05 < 0.3 < far


def test_cost(monkeypatch):
    """By a clock that only models move."""
    clock = [0.0]

    class Ticking:
        def __init__(self, seconds):
            self.seconds = seconds

        def evaluate(self, view, light, **given):
            clock[0] += self.seconds

    monkeypatch.setattr(properties.time, "thread_time", lambda: clock[0])
    monkeypatch.setitem(MODELS, "phong", Ticking(2.0))
    assert properties.cost(Ticking(7.0), {}) == pytest.approx(3.5)


# What is published.


def test_statements_are_about_our_models():
    assert set(published.MODELS) <= set(MODELS)
    assert len({(s.model, s.about) for s in published.STATEMENTS}) == len(published.STATEMENTS)
    assert set(published.REMARKS) <= {(s.model, s.about) for s in published.STATEMENTS}


def test_the_rough_surface_shows_the_paper_s_figure_3(rows):
    assert rows["he_torrance"].off_specular[agreement.FIGURE_3] > 1.0
    angles = {name: row.half_angle for name, row in rows.items()}
    assert max(angles.values()) == pytest.approx(min(angles.values()), rel=1e-3)


def test_what_agrees(rows):
    """But for four, whose reasons are given, and for speeds, which are this machine's."""
    differs = {(v.statement.model, v.statement.about) for v in agreement.verdicts(rows)
               if not v.agrees and v.statement.about != "speed"}
    assert differs == {("he_torrance", "energy"), ("he_torrance", "distribution"), ("embrechts", "spike"),
                       ("embrechts", "diffuse"), ("phong_original", "energy")}
    assert differs <= set(published.REMARKS)


def test_verdicts_are_two_sided(rows):
    """Each statement turned into its opposite no longer agrees, and the other way round."""
    for statement in published.STATEMENTS:
        if isinstance(statement.says, bool):
            opposite = replace(statement, says=not statement.says)
            assert agreement.judge(statement, rows).agrees != agreement.judge(opposite, rows).agrees
    ashikhmin = next(s for s in published.STATEMENTS if (s.model, s.about) == ("ashikhmin_shirley", "conformity"))
    assert agreement.judge(ashikhmin, rows).agrees
    assert not agreement.judge(replace(ashikhmin, says=0), rows).agrees


# The command.


def test_table(capsys):
    assert cli.main(["compare", "blinn", "cook_torrance"]) == 0
    text = capsys.readouterr().out
    lines = text.splitlines()
    assert max(len(line) for line in lines) <= 160
    assert lines[1].startswith("blinn ") and "1.0607 at    0°!" in lines[1] and lines[2].startswith("cook_torrance ")
    assert len({lines[i].index(x) for i, x in ((0, " diffuse"), (1, " none"), (2, " Lambert"))}) == 1
    # Statements about what is shown, and no others.
    assert text.count("\ncook_torrance ") == 1 + sum(s.model == "cook_torrance" for s in published.STATEMENTS)
    assert "\nward " not in text and "off-specular peak" in text


def test_json(capsys):
    assert cli.main(["compare", "ward", "--json"]) == 0
    found = json.loads(capsys.readouterr().out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    (row,) = found["models"]
    assert row["model"] == "ward" and row["off_specular"] == [None] * 3 and row["conserves"] is True
    assert {s["model"] for s in found["published"]} == {"ward"}
    assert all(set(m) == {"sigma", "tau", "measured", "agrees"} for s in found["published"] for m in s["measured"])


def test_other_parameters(capsys):
    assert cli.main(["compare", "blinn", "--set", "exponent=1000", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["published"] == [] and found["models"][0]["conserves"] is False  # n(n+8)/((n+2)(n+4)) at the normal
    assert found["models"][0]["half_angle"] == pytest.approx(math.degrees(math.acos(0.5**0.001)), rel=1e-4)


@pytest.mark.parametrize("argv", [["compare", "wart"], ["compare", "phong", "--set", "sigma=1"],
                                  ["compare", "phong", "--set", "exponent=-3"]])
def test_wrong_calls_are_one_line(argv, capsys):
    assert cli.main(argv) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.startswith("plausible compare: ") and printed.err.count("\n") == 1


# The figures.


def test_every_model_is_on_a_page():
    pages = {model.id: figures.page_of(model) for model in MODELS.values()}
    assert set(pages.values()) == set(figures.SET) - {figures.PUBLISHED}
    for name, page in {"phong_limit": "phong", "weighted_lobes": "phong", "ward": "literature", "kajiya_kay":
                       "literature", "pumped_ward": "pumped", "edwards_fit": "disk", "reciprocal_disk": "disk"}.items():
        assert pages[name] == page, name


@pytest.mark.parametrize("name", ["blinn", "phong_limit"])
def test_lobes_drawn(name):
    """(N·H)^n and (R·L)^n / max(N·L, N·V) in the plane of incidence, over their peaks at the mirror direction."""
    shown = figures.lobes_of(MODELS[name])
    n, view = shown.given["exponent"], np.radians(figures.VIEWS)
    for light, curve, height in zip(figures.LIGHTS, shown.curves, shown.heights, strict=True):
        tilt = math.radians(light)
        if name == "blinn":
            expected, peak = np.cos(0.5 * (view - tilt)) ** n, 1.0
        else:
            power = np.clip(np.cos(view - tilt), 0.0, None) ** n
            expected = power * math.cos(tilt) / np.maximum(np.cos(view), math.cos(tilt))
            peak = 1.0 / math.cos(tilt)
        np.testing.assert_allclose(curve, expected, rtol=1e-3, atol=1e-4)
        assert curve.max() == 1.0 and height == pytest.approx(peak, rel=1e-3)


def test_figures_are_written_as_png_and_svg(tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(figures, "SET", ("published", "disk"))  # the others differ in their models only
    assert cli.main(["figures", "compare", "--output", str(tmp_path)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 4
    for name in figures.SET:
        png, svg = ((tmp_path / f"compare_{name}.{ending}").read_bytes() for ending in ("png", "svg"))
        assert png.startswith(b"\x89PNG") and len(png) > 20000 and b"<svg" in svg[:2000]
    with pytest.raises(ValueError, match="no figure"):
        figures.draw("nothing")
