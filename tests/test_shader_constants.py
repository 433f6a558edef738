"""Shaders have no number without a name, none that stands in Python too, and expect no macro that is not declared."""
import re

import numpy as np
import pytest

from addon import resources
from addon.backends.osl import assembler, constants, definitions, estimator
from addon.brdf import MODELS

FILES = {path.name: path.read_text(encoding="utf-8") for path in sorted(resources.OSL.rglob("*")) if path.is_file()}
HEADERS = {header for model in MODELS.values() for header in assembler.chosen_headers(model)}
OF_OSL = {"M_PI", "M_2PI", "M_PI_2", "BSDF", "LEAST_", "MOST_", "DEFAULT_"}  # and what a parameter's id is put behind
# Numbers of formulas, and indices; the last four are those of Beckmann's Lambda.
PLAIN = {*map(float, range(10)), 11.0, 0.5, 0.396, 1.259, 2.181, 3.535}
# Values of shared numbers that other ideas have as well.
COMMON = {0.0, 0.02, 0.03, 0.1, 0.15, 0.25, 0.3, 0.5, 0.6, 1.0, 1e-3, 1e-4, 1.5, *map(float, range(2, 21))}


def code(text):
    """A file without comments and texts."""
    return re.sub(r'"[^"\n]*"', "", re.sub(r"//.*", "", text))


def numbers(text):
    return {float(found) for found in re.findall(r"(?<![\w.])\d+\.?\d*(?:e-?\d+)?", text)}


def names(text):
    """Words in capitals."""
    return set(re.findall(r"\b[A-Z][A-Z0-9_]{2,}\b", text))


def bare(macro):
    """A macro's name without its arguments."""
    return macro.partition("(")[0]


EXPECTED = {name for text in FILES.values() for name in names(code(text))}
DEFINED = {name for text in FILES.values() for name in re.findall(r"#\s*define (\w+)", text)}
DECLARED = [*constants.SHARED, *definitions.MODEL, *map(bare, definitions.HOOKS)]


def test_each_macro_that_shaders_expect_is_declared_once():
    assert len(set(DECLARED)) == len(DECLARED)
    assert set(DECLARED) == EXPECTED - DEFINED - OF_OSL - HEADERS
    assert not DEFINED & set(DECLARED)


def test_what_is_written_is_what_is_declared():
    """For all models together; the inputs' ends are of the parameters' ids."""
    written = set()
    for model in MODELS.values():
        for lut in (assembler.COMPILED, assembler.FILE):
            if not estimator.is_baked(model):
                written |= set(assembler._definitions(model, lut))
        written |= set(assembler._signature(model))
    for macro in written - set(definitions.MODEL):
        assert re.fullmatch("(LEAST|MOST|DEFAULT)_[a-z_0-9]+", macro), macro
    # Those of baked models are seen where they are assembled, below.
    baked = {name for name in definitions.MODEL if name.startswith(("W_", "RANGE_")) or name in (
        "MODEL_LABEL", "MODEL_MATCHES")}
    assert set(definitions.MODEL) - written == baked


def test_what_is_written_of_a_baked_model_is_what_is_declared():
    from addon.forms.rows import grid, row_bake

    model = MODELS["ward"]
    macros = assembler._weights(model, {}, grid.ParameterGrid((), (row_bake.blank(model, {}),)))
    assert set(macros) == {name for name in definitions.MODEL if name.startswith(("W_", "RANGE_"))} | {
        "MODEL_LABEL", "MODEL_MATCHES", "DATA_PARAMETERS"}


@pytest.mark.parametrize("model", MODELS.values(), ids=list(MODELS))
def test_inputs_that_a_shader_holds_are_declared(model):
    """By kind: a count or choice, a number, a colour."""
    kinds = {"HELD": ("float", "int", "enum"), "NUMBER": ("float",), "COLOR": ("color",)}
    for kind, name in re.findall(r"\b(HELD|NUMBER|COLOR)\(([a-z]\w+)\)", FILES[assembler.shader_path(model).name]):
        if name == "pumps" and not any(p.id == "pumps" for p in model.parameters):
            assert "#ifdef PUMPED" in FILES["lobe.osl"]
        else:
            assert model.parameter(name).kind in kinds[kind], name


@pytest.mark.parametrize("name", FILES)
def test_no_number_is_without_a_name(name):
    plain = [line for line in code(FILES[name]).split("\n") if not line.lstrip().startswith("#")]
    for line in plain:
        assert numbers(line) <= PLAIN, line


@pytest.mark.parametrize("name", constants.SHARED)
def test_a_shared_number_stands_once(name):
    """Not among the shaders' own, by name or by value; and it is read there as the number that it is here."""
    value = float(constants.SHARED[name].value)
    for file, text in FILES.items():
        assert f"#define {name} " not in text, file
        assert value in COMMON or not {n for n in numbers(code(text)) if np.float32(n) == np.float32(value)}, file
    (written,) = re.findall(rf"^#define {name} (\S+)", constants.header(), re.MULTILINE)
    assert float(written) == value and ("." in written or "e" in written) == isinstance(
        constants.SHARED[name].value, float)


def test_the_ends_of_exponents_are_known_by_value():
    """The test above would pass on an empty list."""
    assert 100000.0 in numbers("clamp(n, 1.0, 100000.0)") and 5e-4 in numbers("max(a, 5e-4)")
    assert len(EXPECTED & set(constants.SHARED)) == len(constants.SHARED) >= 40


@pytest.mark.parametrize("name", FILES)
def test_functions_are_short_and_take_few_parameters(name):
    """A macro of parameters, as of a struct and the tables that no struct can hold, is one idea."""
    text = re.sub(r"//.*", "", FILES[name])
    found = re.findall(r"^(?:closure )?\w+ \w+\(([^;{]*?)\)\s*\{(.*?)(?:^\}|\}$)", text, re.MULTILINE | re.DOTALL)
    assert found or name == "random.h"
    for parameters, body in found:
        assert parameters.count(",") < 8, parameters
        assert body.count("\n") <= 42, body[:200]
    assert FILES[name].count("\n") <= 250


@pytest.mark.parametrize("model", MODELS.values(), ids=list(MODELS))
def test_each_shader_has_the_hooks_of_kernels(model):
    """Those that tests and benchmarks ask for would otherwise change nothing, and nobody would see."""
    for hook in ("KERNELS", "AT_KERNEL", "SPOILT_U", "SPOILT_V"):
        assert sum(hook in names(code(FILES[name])) for name in files_of(model)) == 1, hook


def files_of(model):
    """Names of the files that a model's shader is put together of."""
    chosen = assembler.chosen_headers(model)
    found = [assembler.shader_path(model).name]
    for name in found:
        for included in re.findall(r"^#include (\S+)", FILES[name], re.MULTILINE):
            header = chosen.get(included, included.strip('"')).rpartition("/")[2]
            if header not in found:
                found.append(header)
    return found


@pytest.mark.parametrize("model", MODELS.values(), ids=list(MODELS))
def test_no_initialiser_has_a_struct_in_it(model):
    """oslc takes it, and leaves the fields of that struct as they are."""
    text = "".join(code(FILES[name]) for name in files_of(model))
    fields = {struct: set(re.findall(r"^    (\w+) ", inside, re.MULTILINE))
              for struct, inside in re.findall(r"^struct (\w+) \{(.*?)^\};", text, re.MULTILINE | re.DOTALL)}
    initialised = re.findall(r"^\s*(\w+) \w+ = (?:\{|INPUT_COLOUR)", text, re.MULTILINE)
    for struct in set(initialised) & set(fields):
        assert not fields[struct] & set(fields), struct
    assert set(initialised) & set(fields)
