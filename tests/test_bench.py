"""The bench: its figures are what they are called, and the command measures, prints, plots and refuses."""
import json

import numpy as np
import pytest

from addon import cli
from addon.brdf import MODELS
from addon.dev import bench
from addon.dev.bench import bake, efficiency, luts, nearest, scaling
from addon.forms.albedo import tables
from addon.measure import scene, standards
from addon.models.lobes import BLINN, PHONG

pytestmark = pytest.mark.blender
BRIEF = bench.Effort(0.1, 3)


def test_relative_variance_and_efficiency():
    rng = np.random.default_rng(1)
    means = rng.uniform(1.0, 2.0, (1, 500, 3))
    pictures = means * (1.0 + 0.1 * rng.standard_normal((400, 500, 3)))
    measured = efficiency._relative_variance(pictures)
    assert measured == pytest.approx(0.01, rel=0.02)
    one, other = efficiency.Efficiency("a", 0.01, 2.0, 64), efficiency.Efficiency("b", 0.02, 0.5, 64)
    assert one.value == pytest.approx(50.0) and one.compared_with(other) == pytest.approx(0.5)
    assert one.compared_with(efficiency.Efficiency("c", 0.0, 1.0, 64)) is None


def test_a_material_is_as_efficient_as_itself():
    closure = standards.phong(20.0)
    same = [efficiency.Candidate(name, closure.material()) for name in ("a", "b", "c")]
    rows = efficiency.measure(same, efficiency.AREA, bench.Effort(0.2, 5), resolution=24)
    assert [row.title for row in rows] == ["a", "b", "c"] and rows[0].spp >= 4
    variances = [row.relative_variance for row in rows]
    assert max(variances) / min(variances) == pytest.approx(1.0, abs=0.2)
    assert all(0.3 < row.compared_with(rows[0]) < 3.0 for row in rows)  # a busy machine's clock


@pytest.mark.parametrize("scene", efficiency.SCENES)
def test_every_scene_is_lit(scene):
    """By a material of albedo 1, and brighter where it is lit by more."""
    with efficiency._lit(efficiency.Candidate("matt", standards.diffuse().material()), scene, 16, None) as place:
        picture = place.render(16)
    middle = picture[6:10, 6:10].mean()
    assert 0.05 < middle < 5.0
    if scene == efficiency.FURNACE:
        assert middle == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("distribution", ["beckmann", "ggx"])
def test_a_node_is_the_closure_that_it_is_taken_for(distribution):
    """SVM's Glossy node of the roughness r is the closure of the slope r²: under a sun of no size, by its formula."""
    view, light = (np.array([np.sin(t), 0.0, np.cos(t)]) for t in (0.4, -0.7))
    expected = np.pi * standards.microfacet(distribution, 0.3).evaluate(view, light)[0] * light[2]
    with scene.MeasuringScene(standards.native(distribution.upper(), 0.3**0.5), scene.PLANE, 8) as place:
        place.scene.cycles.shading_system = False
        place.shine("SUN", light, energy=scene.SUN_ENERGY, angle=0.0)
        place.look_from(view)
        measured = place.render(4).mean()
    assert measured == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("model, exact", [("phong", True), ("pumped_phong", False), ("disk_scaling", False),
                                          ("ward", False)])
def test_the_base_alone_is_the_model_without_kernels(model, exact):
    """Plain Phong's base is all there is; others lose a little light, and all of them their noise under a sun."""
    values = ["exponent=20.0"] if "exponent" in {p.id for p in MODELS[model].parameters} else []
    whole, base = nearest.ours(MODELS[model], values, 4), nearest.base_alone(MODELS[model], values)
    pictures = {}
    for name, candidate in (("whole", whole), ("base", base)):
        with scene.MeasuringScene(candidate.material, scene.PLANE, 16) as place:
            place.sky(1.0)
            place.look_from((0.6, 0.0, 0.8))
            pictures[name] = place.render(256)
    lost = 1.0 - pictures["base"].mean() / pictures["whole"].mean()
    assert abs(lost) < (1e-3 if exact else 0.15)
    assert exact or abs(lost) > 1e-4


def test_three_ways_to_an_albedo_agree():
    """A grid errs by the square of its spacing, and the others by what their sizes say."""
    for lobe in (PHONG, BLINN):
        truth = bake._quadrature(lobe, 1.0, bake.TRUTH)[0]
        errors = [np.abs(bake._grid(lobe, 1.0, size)[0] / truth - 1.0).max() for size in (32, 64, 128)]
        assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.5)
        assert errors[1] / errors[2] == pytest.approx(4.0, abs=0.5)
        assert np.abs(bake._sobol(lobe, 20.0, 16)[0] / bake._quadrature(lobe, 20.0, bake.TRUTH)[0] - 1.0).max() < 2e-4


def test_the_error_of_a_table_is_the_checks():
    """At a factor of one it is what the shipped table is baked to; a quarter of the columns costs sixteen times."""
    rows = list(luts._rows(tables.TABLES["disk_plain"], 1.0))
    assert rows[0]["precision"] == "float32" and 1e-4 < rows[0]["error"] < 1e-3
    coarse = next(luts._rows(tables.TABLES["disk_plain"], 0.25))
    assert 8.0 < coarse["error"] / rows[0]["error"] < 25.0
    assert rows[0]["bytes"] == 2 * rows[1]["bytes"] and rows[1]["error"] > rows[0]["error"]


@pytest.fixture
def brief(monkeypatch):
    """The parts measure little, that all of them run in seconds."""
    monkeypatch.setattr(bench, "QUICK", BRIEF)
    monkeypatch.setattr(scaling, "SAMPLES", (4,))
    monkeypatch.setattr(scaling, "RESOLUTIONS", (16,))
    monkeypatch.setattr(scaling, "MATERIALS", (2,))
    monkeypatch.setattr(bake, "NODES", ((2, 5), (16, 36)))
    monkeypatch.setattr(bake, "SOBOL", (6,))
    monkeypatch.setattr(bake, "GRID", (8,))
    monkeypatch.setattr(bake, "EXPONENTS", (1.0, 20.0))
    monkeypatch.setattr(bake, "EVERY", 200)
    monkeypatch.setattr(bake, "_by_size", lambda repeats: [{"columns": 36, "ms": 1.0}])
    monkeypatch.setattr(bake, "_by_exponent", lambda repeats: [{"exponent": 20.0, "ms": 1.0}])
    monkeypatch.setattr(luts, "FACTORS", (0.1,))
    monkeypatch.setattr(luts, "CELLS", 2)


def test_all_parts_are_measured_printed_and_drawn(brief, tmp_path, capfd):
    call = ["bench", "--quick", "--models", "pumped_phong", "--scenes", "area", "furnace", "--resolution", "16",
            "--output", str(tmp_path)]
    assert cli.main([*call, "--json"]) == 0
    report = json.loads(capfd.readouterr().out)
    assert set(report) == {"blender", *bench.PARTS}
    for part in bench.PARTS:
        assert (tmp_path / f"bench_{part}.png").read_bytes().startswith(b"\x89PNG")
        assert json.loads((tmp_path / f"bench_{part}.json").read_text())[part] == report[part]
    results = report["render"]["results"]
    assert [(r["model"], r["scene"]) for r in results] == [("pumped_phong", "area"), ("pumped_phong", "furnace")]
    rows = results[0]["rows"]
    assert [row["title"] for row in rows] == ["phong_ramp (OSL)", "beckmann (SVM)", "pumped_phong, 4",
                                              "pumped_phong, base alone"]
    assert 1e-3 < rows[2]["efficiency"]["phong_ramp (OSL)"] < 10.0 and rows[0]["efficiency"] == {}
    assert {row["table"] for row in report["bake"]["tables"]} == set(tables.TABLES)
    assert all(row["first_pixel_ms"] > 0.0 and row["bake_s"] is None for row in report["startup"]["rows"])
    assert all(row["plot_ms"] > 0.0 for row in report["interface"]["rows"])


def test_one_part_is_printed(brief, capfd):
    assert cli.main(["bench", "interface", "--models", "phong"]) == 0
    out = capfd.readouterr().out
    assert "interface:" in out and "\nphong " in out and "render" not in out


@pytest.mark.parametrize("arguments, word", [
    (["nonsense"], "no part"), (["render", "--models", "nonsense"], "no model"),
    (["render", "--models", "phong", "--set", "exponent=nan"], "outside"),
    (["render", "--models", "phong", "--samples", "99"], "outside"),
    (["render", "--quick", "--scenes", "hdri", "--hdri", "nowhere.exr"], "nowhere.exr"),
])
def test_what_a_user_gets_wrong_is_one_line(arguments, word, capfd):
    assert cli.main(["bench", *arguments]) == 2
    said = capfd.readouterr()
    assert said.err.strip().count("\n") == 0 and word in said.err
