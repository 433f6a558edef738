"""Shader sources: their signatures against the declarations, and what assembling puts into them."""
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from addon import resources
from addon.backends.osl import assembler, estimator
from addon.brdf import MODELS, TableError
from addon.forms.albedo import tables, tabulated
from addon.forms.albedo.axes import SineAxis
from addon.forms.rows import grid, lobe_rows, row_bake
from addon.forms.rows.layout import Layout

BAKED = {name: model for name, model in MODELS.items() if estimator.is_baked(model)}
WRITTEN = {name: model for name, model in MODELS.items() if not estimator.is_baked(model)}
ON_BASE_LOBES = {name: model for name, model in WRITTEN.items() if estimator.base_family(model)}
ON_BELLS = {name: model for name, model in WRITTEN.items() if name not in ON_BASE_LOBES}

SIGNATURE = """shader MODEL(
    MODEL_PARAMETERS,
    DATA_PARAMETERS,
    output closure color BSDF = 0)
{
"""
INPUT = re.compile(r'(float|int|color|normal|string) (\w+) = ((?:color|normal)\([^)]*\)|[-\d.e]+|"[^"]*")')
TYPES = {"float": "float", "int": "int", "bool": "int", "enum": "int", "color": "color", "vector": "normal",
         "image": "string"}


def macro(text, name):
    """What an assembled text defines a macro as."""
    (value,) = re.findall(rf"^#define {re.escape(name)} (.*)$", text, re.MULTILINE)
    return value


def assert_declared(model, text):
    """The signature of an assembled text has what the registry declares, of the declared types."""
    found = INPUT.findall(macro(text, "MODEL_PARAMETERS"))
    assert macro(text, "MODEL") == model.id and text.count(SIGNATURE) == 1
    assert [(kind, name) for kind, name, _ in found] == [(TYPES[p.kind], p.id) for p in model.parameters]
    for (kind, name, default), parameter in zip(found, model.parameters, strict=True):
        assert (json.loads(default) if kind == "string" else numbers(kind, default)) == parameter.default, name
        assert ("(" in default) == (kind in ("color", "normal")), f"{name}: Cycles sets no input of another type"


def numbers(kind, text):
    """An OSL default as the registry's value."""
    values = [float(x) for x in re.findall(r"-?\d+\.?\d*", text)]
    if kind in ("color", "normal"):
        return tuple(values * 3 if len(values) == 1 else values)
    return int(values[0]) if kind == "int" else values[0]


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
def test_signature_is_the_declaration(model):
    """And what an input is held to is the declared range."""
    text = assembler.assemble(model, assembler.FILE)
    assert_declared(model, text)
    for parameter in model.parameters:
        if parameter.kind in ("float", "int", "enum", "color"):
            ends = macro(text, f"LEAST_{parameter.id}"), macro(text, f"MOST_{parameter.id}")
            assert tuple(map(float, ends)) == (parameter.minimum, parameter.maximum), parameter.id
            assert ("." in ends[0]) == (parameter.kind in ("float", "color")), parameter.id
        if parameter.kind == "float":
            assert float(macro(text, f"DEFAULT_{parameter.id}")) == parameter.default


def test_models_that_differ_in_a_header_are_one_file():
    files = {}
    for model in MODELS.values():
        files.setdefault(assembler.shader_path(model).name, set()).add(model.id)
    assert files["lobe.osl"] == {"phong", "blinn", "phong_limit", "pumped_phong", "pumped_blinn"}
    assert files["lump.osl"] == {"disk_scaling", "disk_orthogonal"} and files["weights.osl"] == set(BAKED)
    assert len({assembler.program_of(model) for model in WRITTEN.values()}) == len(WRITTEN)


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
@pytest.mark.parametrize("lut", [assembler.COMPILED, assembler.FILE])
def test_assembled_source_stands_alone(model, lut):
    text = assembler.assemble(model, lut)
    assert "#include" not in text and text.count(SIGNATURE) == 1
    # Every header once, the model's own among them: a header is known by its first line.
    chosen, folder = assembler.chosen_headers(model), assembler.shader_path(model).parent
    own = [chosen.get(name.strip('"'), name.strip('"'))
           for name in re.findall(r"#include (.+)", assembler.shader_path(model).read_text(encoding="utf-8"))]
    headers = sorted((folder / "include").glob("*.h"))
    for name in own:  # grows by what its headers include themselves
        inside = (folder / name).read_text(encoding="utf-8")
        own += [f"include/{other}" for other in re.findall(r'#include "(.+)"', inside)
                if f"include/{other}" not in own]
    for header in headers:
        times = text.count(header.read_text(encoding="utf-8").split("\n")[0] + "\n")
        assert times == 1 if f"include/{header.name}" in own else times <= 1, header.name
    assert 7 < len(own) < len(headers) and set(chosen.values()) <= set(own)
    assert text.count("#define DATA_PARAMETERS") == 1
    assert ("#define TABLE_FILE\n" in text) == (lut == assembler.FILE and bool(tabulated.tables_of(model)))
    assert assembler.assemble(model, lut) == text


def test_a_macro_can_be_put_in_place_of_another():
    model = MODELS["phong"]
    text = assembler.assemble(model, defines={"KERNELS": "0", "MOST_samples": "3"})
    assert macro(text, "KERNELS") == "0" and macro(text, "MOST_samples") == "3"
    assert macro(assembler.assemble(model), "KERNELS") == "1"
    with pytest.raises(ValueError, match="W_VIEWS.*phong.*KERNELS"):
        assembler.assemble(model, defines={"W_VIEWS": "3"})


def array(text, name):
    """Numbers of an array parameter, its declared length checked."""
    length, inside = re.search(rf"\b{name}\[(\d+)\] = \{{([^}}]*)\}}", text).groups()
    values = np.array([float(x) for x in inside.split(",")])
    assert len(values) == int(length)
    return values


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
def test_compiled_source_holds_the_tables(model):
    text = assembler.assemble(model)
    assert assembler.assemble(model, assembler.COMPILED) == text
    assert ".exr" not in text
    used = {assembler.mode_of(tables.TABLES[name]): tables.TABLES[name] for name in tabulated.tables_of(model)}
    for mode in ("plain", "controlled", "volume"):
        if mode not in used:
            assert f"AXES_{mode.upper()} Axes" not in text and f"float table_{mode}[" not in text
            continue
        table, values = used[mode], array(text, f"table_{mode}")
        # Six digits: 5e-6.
        np.testing.assert_allclose(values, tables.load(table).ravel(), rtol=5.1e-6)
        axes = re.search(rf"#define AXES_{mode.upper()} Axes\((.*)\)", text)[1]
        c, r = table.columns, table.rows
        assert [float(x) for x in axes.split(",")] == [c.columns, c.grazing, c.normal, r.rows, r.density, r.law,
                                                       table.stamp, isinstance(c, SineAxis), table.height,
                                                       1.0, 100000.0]


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
def test_file_source_names_the_tables(model):
    text = assembler.assemble(model, assembler.FILE)
    for name in tabulated.tables_of(model):
        table = tables.TABLES[name]
        mode = assembler.mode_of(table)
        assert f'string table_{mode} = "{table.path.as_posix()}"' in text
        assert f"float table_{mode}[" not in text.split("#define DATA_PARAMETERS")[1].split("\n")[0]
    if not tabulated.tables_of(model):
        assert "string table_" not in text and ".exr" not in text
    used = [tables.TABLES[name] for name in tabulated.tables_of(model)]
    numbers = sum(4 * table.height * table.columns.columns for table in used)
    assert len(assembler.assemble(model)) - len(text) >= 4 * numbers  # characters that the file leaves out


@pytest.mark.parametrize("model", ON_BASE_LOBES.values(), ids=list(ON_BASE_LOBES))
def test_base_lobes_of_the_family_are_put_in(model):
    base = json.loads((resources.LUTS / "base_lobes.json").read_text(encoding="utf-8"))
    text = assembler.assemble(model, assembler.FILE)
    own = base["families"][model.lobe.id]
    np.testing.assert_allclose(array(text, "base_widths"), base["features"])
    vectors = re.search(r"\bvector base_table\[(\d+)\] = \{(.*?)\}", text)
    values = np.array([float(x) for x in re.findall(r"-?[\d.]+(?:e-?\d+)?", vectors[2])])
    assert len(values) == 3 * int(vectors[1]) == len(own["table"])
    np.testing.assert_allclose(values, own["table"], rtol=5e-6)
    macros = {name: float(value) for name, value in re.findall(r"#define BASE_(\w+) ([\d.]+)\n", text)}
    assert (macros["U"], macros["V"], macros["FEATURES"]) == (own["u_nodes"], own["v_nodes"], len(base["features"]))
    assert len(own["table"]) == 3 * macros["STRIDE"] * macros["U"] * macros["V"] * macros["FEATURES"]
    # A ramp beside the plane of incidence is two closures with one set of colours.
    ramps = array(text, "base_ramps").reshape(-1, 5)
    assert len(ramps) == macros["RAMPS"] == sum(2 if r["side"] else 1 for r in own["ramps"])
    for lean, sharp, side, crease, index in ramps:
        closure = own["ramps"][int(index)]
        assert (lean, sharp, abs(side), crease) == tuple(closure[name] for name in ("lean", "sharp", "side", "crease"))
    assert ramps[:, 2].sum() == 0.0
    assert macros["LEVELS"] == 9 * macros["SETS"] == 9 * len(own["ramps"]) and macros["FACETS"] == len(own["facets"])


@pytest.mark.parametrize("model", ON_BASE_LOBES.values(), ids=list(ON_BASE_LOBES))
def test_a_hit_has_room_for_its_closures(model):
    """Cycles has 64 places, a phong_ramp takes three of them, and a material may hold other shaders too."""
    own = json.loads((resources.LUTS / "base_lobes.json").read_text(encoding="utf-8"))["families"]
    base = own[model.lobe.id]
    ramps = sum(2 if r["side"] else 1 for r in base["ramps"])
    kernels = next(p.maximum for p in model.parameters if p.id == "samples")
    assert 3 * (ramps + kernels) + len(base["facets"]) <= 48


@pytest.mark.parametrize("model", ON_BELLS.values(), ids=list(ON_BELLS))
def test_bells_are_put_in(model):
    stored = json.loads((resources.LUTS / "bells.json").read_text(encoding="utf-8"))
    few, steep = stored["table"], stored["steep"]
    text = assembler.assemble(model, assembler.FILE)
    np.testing.assert_allclose(array(text, "bells"), [*np.ravel(few), *np.ravel(steep)], rtol=1e-5)
    assert f"#define BELLS_PER_UNIT {len(few) - 1} " in text and np.shape(few)[1] == 8
    assert f"#define STEEP_FROM {len(few) - len(steep)} " in text and np.shape(steep)[1] == 20
    # Cycles takes a sum of closures apart with a stack of 16: each is put before the sum, and so waits for none.
    for function in ("kernels", "estimate_lump"):
        estimator = text.split(f"closure color {function}(")[1].split("\n}\n")[0]
        assert "sum +=" not in estimator and estimator.count("+ sum;") == 1
    # 64 places: the middle bell and two rings, and the kernels, of two lumps at most, and a diffuse part.
    kernels = next(p.maximum for p in model.parameters if p.id == "samples")
    assert 2 * (13 + kernels) + 1 <= 48


@pytest.mark.parametrize("model", BAKED.values(), ids=list(BAKED))
def test_baked_models_are_written_from_their_declaration(model, monkeypatch):
    """Their signature has what the registry declares, of the declared types, and asks for the values it is for."""
    few = lobe_rows.LobeRows.zeros(Layout(views=2, azimuths=1, turns=1, cell_rings=1, cell_turns=1, stretch=(1.0, 0.5)))
    few.facets.slopes[:] = np.arange(few.facets.slopes.size).reshape(few.facets.slopes.shape)
    few.residual.energies[:] = [[[[0.25]]], [[[0.75]]]]
    few = replace(few, spike=np.array([[7.0, 8.0, 9.0]]))
    monkeypatch.setattr(row_bake, "bake", lambda of, given: few)
    text = assembler.assemble(model)
    assert "#include" not in text
    assert_declared(model, text)
    conditions = re.search(r"#define MODEL_MATCHES (.*)\n", text)[1]
    asked = set(re.findall(r"\b[a-z]\w*\b", conditions)) - {"abs", "e"}
    assert asked == {p.id for p in model.parameters if p.evaluated}
    written = array(text, "weights")
    np.testing.assert_array_equal(written[:2], few.layout.stretch)
    np.testing.assert_allclose(written[2:], [few.brightness, *assembler._flat(few, 1)[3:-3], 7, 8, 9], rtol=1e-5)
    assert "#define W_CHANNELS 1\n" in text


def test_unknown_lut():
    for lut in ("texture", "", None):
        with pytest.raises(ValueError, match="compiled, file") as caught:
            assembler.assemble(MODELS["phong"], lut)
        assert repr(lut) in str(caught.value)


def test_a_table_that_cannot_be_used(table_folder):
    with pytest.raises(TableError) as caught:
        assembler.assemble(MODELS["pumped_blinn"])
    assert caught.value.code == "missing" and caught.value.path.parent == table_folder
    # File materials find out when they render, and the unpumped models need no table.
    assert str(table_folder) in assembler.assemble(MODELS["pumped_blinn"], assembler.FILE)
    assert assembler.assemble(MODELS["blinn"])


def test_weights_hold_for_their_values_to_single_precision():
    """What is off by 1e-4 is told; what rounding makes of a value is not."""
    model = MODELS["ward"]
    blank = grid.ParameterGrid((), (row_bake.blank(model, {}),))
    text = assembler.assemble(model, baked=blank, parameters={"roughness_u": 0.37})
    (condition,) = re.findall(r"^#define MODEL_MATCHES (.*)$", text, re.MULTILINE)
    value, slack = map(float, re.search(r"abs\(roughness_u - (\S+)\) <= (\S+)", condition).groups())
    assert value == pytest.approx(0.37, rel=1e-6) and 2.0**-24 * value < slack < 1e-4 * value
