"""Versions of Blender: what is tested in each, how that is chosen, and the table of what came out."""
import json
import subprocess
from pathlib import Path
from types import SimpleNamespace

import conftest
import pytest
import versions

from addon.backends.osl import assembler
from addon.brdf import MODELS

ROOT = Path(__file__).resolve().parents[1]


def a_result(blender, **changed):
    return {"blender": blender, "python": "3.11", "selection": "", "tests": 9, "passed": 9, "skipped": 0,
            "minutes": 2.5, "date": "2026-01-02", **changed}


def test_a_result_counts_each_test_once():
    """One that passes and cannot be cleaned up after has failed."""
    outcomes = {"passed": {"a", "b", "c"}, "failed": {"d"}, "error": {"b", "e"}, "skipped": {"f"}, "": {"a", "b", "c"}}
    found = versions.result(outcomes, "versions", 90.0, "2026-01-02")
    assert (found["tests"], found["passed"], found["skipped"], found["minutes"]) == (6, 2, 1, 1.5)
    said = versions.line(found)
    assert "2 of 6 tests passed, 1 skipped in 1.5 minutes (-m 'versions')" in said and said.count("\n") == 0


def test_the_table_has_one_row_a_version_in_their_order():
    table = versions.table("", [a_result("10.0.1"), a_result("4.2.23"), a_result("5.0.1")])
    table = versions.table(table, [a_result("4.2.24", passed=8, date="2026-02-03"), a_result("4.5.15")])
    rows = [line for line in table.splitlines() if line.startswith("| ") and "Blender" not in line]
    assert [row.split()[1] for row in rows] == ["4.2.24", "4.5.15", "5.0.1", "10.0.1"]
    assert rows[0] == "| 4.2.24 | 3.11 | 9 | 8 | 0 | 2.5 | 2026-02-03 |"
    assert versions.table(table, []) == table


def test_only_whole_suites_are_put_into_the_table(tmp_path, capsys):
    results, table = tmp_path / "results", tmp_path / "versions.md"
    results.write_text("\n".join(map(json.dumps, [a_result("4.2.23", selection="not proof"),
                                                   a_result("4.5.15", selection="x")])))
    versions.main(results, table)
    assert "4.5.15" not in table.read_text() and "4.2.23" in table.read_text()
    assert capsys.readouterr().out.count("\n") == 2 and {p.name for p in tmp_path.iterdir()} == {"results", table.name}
    results.write_text("")
    versions.main(results)
    assert "no tests" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["test", "versions"])
def test_a_version_that_there_is_not_is_refused(command):
    done = subprocess.run(["bash", str(ROOT / "run"), command, "5.2", "3.6"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr == "run: no Blender version 3.6 to test in; there are 4.2 4.5 5.0 5.2\n"


def shaders_of(*tests):
    """The shaders, see `source.program_of`, that parametrised tests render first cases of in each version."""
    found = set()
    for test in tests:
        marks = {mark.name: mark for mark in test.pytestmark}
        assert "versions_by_shader" in marks
        assert marks["parametrize"].args[0].split(",")[0] == "model"
        found |= {assembler.program_of(MODELS[case[0]]) for case in marks["parametrize"].args[1]}
    return found


@pytest.mark.blender  # whose modules are looked at
def test_every_shader_is_rendered_in_each_version(request):
    """In a furnace, under a sun, and under a lamp."""
    files = [pytest.Module.from_parent(request.session, path=ROOT / "tests" / f"{name}.py").obj
             for name in ("test_render", "test_render_disk", "test_render_weights")]
    shaders = {assembler.program_of(model) for model in MODELS.values()}
    assert {name for name, *_ in shaders} == {path.name for path in (ROOT / "osl").glob("*.osl")}
    assert shaders_of(*(file.test_furnace for file in files)) == shaders
    assert shaders_of(*(file.test_sphere_under_a_sun for file in files)) == shaders
    assert shaders_of(*(file.test_area_lamp for file in files)) == shaders


def test_the_first_case_of_each_shader_is_chosen():
    def case(number, model):
        marks = []
        return SimpleNamespace(nodeid=f"x.py::test_y[{number}]", marks=marks, add_marker=marks.append,
                               get_closest_marker=lambda name: name == "versions_by_shader" or None,
                               callspec=SimpleNamespace(params={"model": model}),
                               _fixtureinfo=SimpleNamespace(name2fixturedefs={}))

    models = ("phong", "phong", "ward", "lafortune", "blinn")  # Ward's and Lafortune's shader is that of weights
    cases = [case(number, model) for number, model in enumerate(models)]
    conftest.pytest_collection_modifyitems(cases)
    assert [one.marks for one in cases] == [["versions"], [], ["versions"], [], ["versions"]]
