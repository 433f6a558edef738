"""The list of mutations does not rot: what each replaces is still there, and so are the tests that should notice it."""
import ast
from pathlib import Path

import mutations
import pytest

ROOT = Path(__file__).resolve().parents[1]


def test_names_are_given_once_and_there_are_enough():
    names = [mutation.name for mutation in mutations.MUTATIONS]
    assert len(set(names)) == len(names) >= 30
    assert {"addon/models", "osl/include", "luts", "addon/forms", "addon/measure"} <= {
        str(Path(mutation.file).parent) for mutation in mutations.MUTATIONS}


@pytest.mark.parametrize("mutation", mutations.MUTATIONS, ids=lambda mutation: mutation.name)
def test_a_mutation_can_be_made(mutation):
    path = ROOT / mutation.file
    if mutation.spoil is None:
        assert path.read_text(encoding="utf-8").count(mutation.old) == 1, f"{mutation.old!r} in {mutation.file}"
        assert mutation.new != mutation.old
    assert path.is_file() and mutation.tests
    for test in mutation.tests:
        file, _, name = test.partition("::")
        assert name.partition("[")[0] in functions(file), test


def functions(file):
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize(("code", "output", "caught"), [
    (1, "FAILED tests/test_models.py::test_x[a b] - assert 1 == 2", "test_models.py::test_x[a b]"),
    (1, "FAILED tests/test_models.py::test_x - AssertionError: ", "test_models.py::test_x"),
    (1, "FAILED tests/test_models.py::test_x - Failed: DID NOT RAISE <class 'ValueError'>", "test_models.py::test_x"),
    (1, "FAILED tests/test_models.py::test_x - NameError: name 'm' is not defined", ""),
    (2, "ERROR tests/test_models.py - SyntaxError: invalid syntax", ""),
    (1, "FAILED tests/test_models.py::test_x - addon.blender.osl.OslError: the shader did not compile", ""),
    (0, "5 passed", ""), (None, "", ""), (4, "ERROR: not found: tests/test_models.py::test_y", ""),
])
def test_only_assertions_count(code, output, caught):
    outcome = mutations.judge(mutations.MUTATIONS[0], code, output, 1.0)
    assert outcome.caught == caught and bool(outcome.words) != bool(caught)
    assert ("NOT CAUGHT" in mutations.line(outcome)) != bool(caught)


def test_a_text_that_is_not_there_once_is_refused(tmp_path):
    (tmp_path / "a.py").write_text("x = 1\nx = 1\n", encoding="utf-8")
    for old in ("x = 1", "y = 1"):
        with pytest.raises(ValueError, match="times in a.py, not once"):
            mutations.Mutation("m", "a.py", old, "x = 2", ("t",)).apply(tmp_path)
    mutations.Mutation("m", "a.py", "x = 1\nx", "x = 3\nx", ("t",)).apply(tmp_path)
    assert (tmp_path / "a.py").read_text(encoding="utf-8") == "x = 3\nx = 1\n"


def test_wrong_calls_are_one_line(capsys):
    with pytest.raises(SystemExit):
        mutations.main(["no-such-factor"])
    assert "no mutation no-such-factor" in capsys.readouterr().err
    assert mutations.main(["--list"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(mutations.MUTATIONS)


def test_the_page():
    outcomes = [mutations.Outcome(mutations.MUTATIONS[0], "test_models.py::test_x", "", 3.2),
                mutations.Outcome(mutations.MUTATIONS[1], "", "survives", 9.0)]
    text = mutations.page(outcomes)
    assert "1 of 2 were caught" in text and "| `test_models.py::test_x` | 3 |" in text and "| survives | 9 |" in text
