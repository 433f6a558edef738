"""The command `plausible`: exit codes, and one line for every call that is wrong."""
import argparse
import importlib
import json
import math

import pytest

from addon import brdf, cli
from addon.forms.albedo import bake


def one_line(capsys):
    """What a failed call printed: nothing to stdout, one line to stderr."""
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1 and "Traceback" not in printed.err
    return printed.err


def test_list_shows_every_model(capsys):
    assert cli.main(["list"]) == 0
    text = capsys.readouterr().out
    for model in brdf.MODELS.values():
        assert f"{model.id}: {model.label}\n" in text and model.formula in text and model.references[0] in text
    assert "1 .. 100000" in text and "constant | schlick | conductor" in text and "phong_plain.exr" in text


def test_list_one_model(capsys):
    assert cli.main(["list", "blinn"]) == 0
    text = capsys.readouterr().out
    assert "blinn: Blinn" in text and "pumped" not in text and "table" not in text


def test_list_as_json(capsys):
    assert cli.main(["list", "--json"]) == 0
    assert [entry["id"] for entry in json.loads(capsys.readouterr().out)] == list(brdf.MODELS)
    assert cli.main(["list", "pumped_phong", "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    model = brdf.MODELS["pumped_phong"]
    assert entry["tables"] == ["phong_plain", "phong_controlled"] and entry["formula"] == model.formula
    assert [p["id"] for p in entry["parameters"]] == [p.id for p in model.parameters]
    for shown, parameter in zip(entry["parameters"], model.parameters, strict=True):
        assert shown["label"] == parameter.label and shown["kind"] == parameter.kind
        assert shown["default"] == (list(parameter.default) if isinstance(parameter.default, tuple)
                                    else parameter.default)
        assert shown["maximum"] == (parameter.maximum if math.isfinite(parameter.maximum) else None)
        assert shown["items"] == [item[0] for item in parameter.items]


def test_unknown_model(capsys):
    assert cli.main(["list", "wart"]) == 2
    error = one_line(capsys)
    assert error.startswith("plausible list: ") and "'wart'" in error
    assert all(name in error for name in brdf.MODELS)


@pytest.mark.parametrize("argv", [["paint"], [], ["--check"]])
def test_unknown_command(argv, capsys):
    with pytest.raises(SystemExit) as left:
        cli.main(argv)
    assert left.value.code == 2
    printed = capsys.readouterr()
    assert printed.out == "" and "usage: plausible" in printed.err
    if argv == ["paint"]:
        assert "'paint'" in printed.err and all(name in printed.err for name in cli.COMMANDS)


@pytest.mark.parametrize("argv", [["list", "--colour"], ["bake", "--workers", "many"], ["list", "phong", "blinn"]])
def test_unknown_argument(argv, capsys):
    with pytest.raises(SystemExit) as left:
        cli.main(argv)
    assert left.value.code == 2
    error = capsys.readouterr().err
    assert f"plausible {argv[0]}: error:" in error and argv[-1] in error


def test_bad_bake_calls(capsys):
    assert cli.main(["bake", "ward_plain"]) == 2
    error = one_line(capsys)
    assert "'ward_plain'" in error and "phong_plain" in error and "blinn_controlled" in error
    for count in ("0", "-3"):
        assert cli.main(["bake", "--workers", count]) == 2
        assert count in one_line(capsys)


def test_help_names_every_command(capsys):
    with pytest.raises(SystemExit) as left:
        cli.main(["--help"])
    assert left.value.code == 0
    text = capsys.readouterr().out
    assert all(name in text for name in cli.COMMANDS)


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_help_of_a_command(name, capsys):
    with pytest.raises(SystemExit) as left:
        cli.main([name, "--help"])
    assert left.value.code == 0
    text = capsys.readouterr().out
    module = importlib.import_module(cli.COMMANDS[name][0])
    assert text.startswith(f"usage: plausible {name}") and " ".join(module.DESCRIPTION.split())[:20] in text
    # Everything that can be given says what it is for.
    parser = argparse.ArgumentParser()
    module.add_arguments(parser)
    assert all(action.help for action in parser._actions)


@pytest.mark.parametrize(("error", "code"), [(ValueError("no such thing"), 2), (OSError(28, "disk full"), 2),
                                             (cli.CommandError("no such thing"), 2), (KeyboardInterrupt(), 130)])
def test_what_a_user_can_get_wrong_is_one_line(error, code, monkeypatch, capsys):
    def failing(*arguments):
        raise error
        yield

    monkeypatch.setattr(bake, "bake", failing)
    assert cli.main(["bake"]) == code
    assert one_line(capsys).startswith("plausible bake: ")


def test_our_own_defects_keep_their_traceback(monkeypatch):
    def failing(*arguments):
        raise ZeroDivisionError
        yield

    monkeypatch.setattr(bake, "bake", failing)
    with pytest.raises(ZeroDivisionError):
        cli.main(["bake"])
