"""The bench: its figure is the efficiency, and the command prints, plots and refuses."""
import json

import numpy as np
import pytest

from addon import cli

pytestmark = pytest.mark.blender


def test_relative_variance_and_efficiency():
    from addon.verify import efficiency

    rng = np.random.default_rng(1)
    means = rng.uniform(1.0, 2.0, (1, 500, 3))
    pictures = means * (1.0 + 0.1 * rng.standard_normal((400, 500, 3)))
    measured = efficiency._relative_variance(pictures)
    assert measured == pytest.approx(0.01, rel=0.02)
    one, other = efficiency.Efficiency("a", 0.01, 2.0, 64), efficiency.Efficiency("b", 0.02, 0.5, 64)
    assert one.value == pytest.approx(50.0) and one.compared_with(other) == pytest.approx(0.5)
    assert one.compared_with(efficiency.Efficiency("c", 0.0, 1.0, 64)) is None


def test_a_material_is_as_efficient_as_itself():
    from addon.verify import efficiency, standards

    closure = standards.phong(20.0)
    same = {name: closure.material() for name in ("a", "b", "c")}
    rows = efficiency.measure(same, efficiency.AREA, seconds=0.2, seeds=5, resolution=24)
    assert [row.title for row in rows] == ["a", "b", "c"] and rows[0].spp >= 4
    variances = [row.relative_variance for row in rows]
    assert max(variances) / min(variances) == pytest.approx(1.0, abs=0.2)
    assert all(0.3 < row.compared_with(rows[0]) < 3.0 for row in rows)  # a busy machine's clock


def test_bench_command(tmp_path, capfd):
    call = ["bench", "pumped_phong", "--quick", "--scenes", "area", "sun", "--samples", "2", "--resolution", "16"]
    assert cli.main([*call, "--json", "--output", str(tmp_path / "bench.png")]) == 0
    report = json.loads(capfd.readouterr().out)
    assert [result["scene"] for result in report["results"]] == ["area", "sun"]
    rows = report["results"][0]["rows"]
    assert [row["title"] for row in rows] == ["phong_ramp", "pumped_phong, 2"]
    assert 1e-3 < rows[1]["relative_to"]["phong_ramp"] < 10.0
    assert all(row["seconds"] > 0.0 and row["relative_variance"] > 0.0 for row in report["results"][1]["rows"])
    assert (tmp_path / "bench.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("arguments, word", [
    (["nonsense"], "no model"), (["--set", "exponent=nan"], "outside"), (["--output", "plot.doc"], "png"),
    (["--samples", "99"], "outside"), (["--quick", "--scenes", "hdri", "--hdri", "nowhere.exr"], "nowhere.exr"),
])
def test_what_a_user_gets_wrong_is_one_line(arguments, word, capfd):
    assert cli.main(["bench", *arguments]) == 2
    said = capfd.readouterr()
    assert said.err.strip().count("\n") == 0 and word in said.err


def test_the_interfaces_cost(capsys):
    """How long is not tested, as machines differ: that each model is timed."""
    assert cli.main(["bench", "phong", "ward", "--interface", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert [row["model"] for row in rows] == ["phong", "ward"]
    assert all(row["plot_ms"] > 0.0 and row["stand_in_ms"] > 0.0 for row in rows)
