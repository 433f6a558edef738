"""Shader sources: their signatures against the declarations, and what assembling puts into them."""
import json
import re

import numpy as np
import pytest

from addon.baking import ranges, weights
from addon.brdf import MODELS, TableError, tables
from addon.brdf.axes import SineAxis
from addon.shading import source

BAKED = {name: model for name, model in MODELS.items() if model.baked}
WRITTEN = {name: model for name, model in MODELS.items() if not model.baked}  # those with a shader of their own
ON_BASE_LOBES = {name: model for name, model in WRITTEN.items() if model.base_family}
ON_BELLS = {name: model for name, model in WRITTEN.items() if name not in ON_BASE_LOBES}

SIGNATURE = re.compile(r"^shader (\w+)\((.*?)\)\n\{", re.MULTILINE | re.DOTALL)
INPUT = re.compile(r"(float|int|color|normal) (\w+) = (color\([^)]*\)|[-\d.]+) \[\[(.*?)\]\]$", re.DOTALL)
HINT = re.compile(r'(string|float|int) (\w+) = ("[^"]*"|[-\d.]+)')
TYPES = {"float": "float", "int": "int", "bool": "int", "enum": "int", "color": "color", "vector": "normal",
         "image": "string"}


def signature(model):
    """(shader name, [(type, name, default, hints)], what follows the inputs), parsed from a model's own file."""
    text = source.shader_path(model).read_text(encoding="utf-8")
    (name, inside), = SIGNATURE.findall(text)
    parts = [part.strip() for part in re.split(r",\n", inside)]
    inputs, rest = [], []
    for part in parts:
        found = INPUT.fullmatch(part)
        if not found or rest:
            rest.append(part)
            continue
        kind, identifier, default, hints = found.groups()
        inputs.append((kind, identifier, default, {key: value.strip('"') for _, key, value in HINT.findall(hints)}))
    return name, inputs, rest


def numbers(kind, text):
    """An OSL default as the registry's value."""
    values = [float(x) for x in re.findall(r"-?\d+\.?\d*", text)]
    if kind in ("color", "normal"):
        return tuple(values * 3 if len(values) == 1 else values)
    return int(values[0]) if kind == "int" else values[0]


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
def test_signature_is_the_declaration(model):
    name, inputs, rest = signature(model)
    assert name == model.id
    assert [identifier for _, identifier, _, _ in inputs] == [parameter.id for parameter in model.parameters]
    assert rest == ["DATA_PARAMETERS", "output closure color BSDF = 0"]
    for (kind, _, default, hints), parameter in zip(inputs, model.parameters, strict=True):
        assert kind == TYPES[parameter.kind], parameter.id
        assert numbers(kind, default) == parameter.default, parameter.id
        assert hints["label"] == parameter.label, parameter.id
        assert ("widget" in hints) == (parameter.kind == "bool"), parameter.id
        if parameter.kind in ("float", "int", "enum"):
            assert float(hints["min"]) == parameter.minimum and float(hints["max"]) == parameter.maximum, parameter.id
        else:
            assert "min" not in hints and "max" not in hints, parameter.id


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
@pytest.mark.parametrize("lut", [source.COMPILED, source.FILE])
def test_assembled_source_stands_alone(model, lut):
    text = source.assemble(model, lut)
    assert "#include" not in text and len(SIGNATURE.findall(text)) == 1
    # Every header once, the model's own among them: a header is known by its first line.
    own = re.findall(r'#include "(.+)"', source.shader_path(model).read_text(encoding="utf-8"))
    headers = sorted((source.shader_path(model).parent / "include").glob("*.h"))
    for name in own:  # grows by what its headers include themselves
        inside = (source.shader_path(model).parent / name).read_text(encoding="utf-8")
        own += [f"include/{other}" for other in re.findall(r'#include "(.+)"', inside)
                if f"include/{other}" not in own]
    for header in headers:
        times = text.count(header.read_text(encoding="utf-8").split("\n")[0] + "\n")
        assert times == 1 if f"include/{header.name}" in own else times <= 1, header.name
    assert 7 < len(own) < len(headers)
    assert text.count("#define DATA_PARAMETERS") == 1
    assert ("#define TABLE_FILE" in text) == (lut == source.FILE and bool(model.tables))
    assert source.assemble(model, lut) == text


def array(text, name):
    """Numbers of an array parameter, its declared length checked."""
    length, inside = re.search(rf"\b{name}\[(\d+)\] = \{{([^}}]*)\}}", text).groups()
    values = np.array([float(x) for x in inside.split(",")])
    assert len(values) == int(length)
    return values


@pytest.mark.parametrize("model", WRITTEN.values(), ids=list(WRITTEN))
def test_compiled_source_holds_the_tables(model):
    text = source.assemble(model)
    assert source.assemble(model, source.COMPILED) == text
    assert ".exr" not in text
    used = {source.mode_of(tables.TABLES[name]): tables.TABLES[name] for name in model.tables}
    for mode in ("plain", "controlled", "volume"):
        if mode not in used:
            assert f"AXES_{mode.upper()} Axes" not in text
            assert mode == "volume" or not array(text, f"table_{mode}").any()
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
    text = source.assemble(model, source.FILE)
    for name in model.tables:
        table = tables.TABLES[name]
        mode = source.mode_of(table)
        assert f'string table_{mode} = "{table.path.as_posix()}"' in text
        assert f"float table_{mode}[" not in text.split("#define DATA_PARAMETERS")[1].split("\n")[0]
    if not model.tables:
        assert "string table_" not in text and ".exr" not in text
    numbers = sum(4 * tables.TABLES[name].height * tables.TABLES[name].columns.columns for name in model.tables)
    assert len(source.assemble(model)) - len(text) >= 4 * numbers  # characters that the file leaves out


@pytest.mark.parametrize("model", ON_BASE_LOBES.values(), ids=list(ON_BASE_LOBES))
def test_base_lobes_of_the_family_are_put_in(model):
    base = json.loads((source._OSL.parent / "luts" / "base_lobes.json").read_text(encoding="utf-8"))
    text = source.assemble(model, source.FILE)
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
    own = json.loads((source._OSL.parent / "luts" / "base_lobes.json").read_text(encoding="utf-8"))["families"]
    base = own[model.lobe.id]
    ramps = sum(2 if r["side"] else 1 for r in base["ramps"])
    splats = next(p.maximum for p in model.parameters if p.id == "samples")
    assert 3 * (ramps + splats) + len(base["facets"]) <= 48


@pytest.mark.parametrize("model", ON_BELLS.values(), ids=list(ON_BELLS))
def test_bells_are_put_in(model):
    stored = json.loads((source._OSL.parent / "luts" / "bells.json").read_text(encoding="utf-8"))
    few, steep = stored["table"], stored["steep"]
    text = source.assemble(model, source.FILE)
    np.testing.assert_allclose(array(text, "bells"), [*np.ravel(few), *np.ravel(steep)], rtol=1e-5)
    assert f"#define BELLS_PER_UNIT {len(few) - 1}\n" in text and np.shape(few)[1] == 8
    assert f"#define STEEP_FROM {len(few) - len(steep)}\n" in text and np.shape(steep)[1] == 20
    # Cycles takes a sum of closures apart with a stack of 16: each is put before the sum, and so waits for none.
    estimator = text.split("closure color estimate_lump(")[1].split("\n}\n")[0]
    assert "sum +=" not in estimator and estimator.count("+ sum;") == 2
    # 64 places: the middle bell and two rings, and the splats, of two lumps at most, and a diffuse part.
    splats = next(p.maximum for p in model.parameters if p.id == "samples")
    assert 2 * (13 + splats) + 1 <= 48


@pytest.mark.parametrize("model", BAKED.values(), ids=list(BAKED))
def test_baked_models_are_written_from_their_declaration(model, monkeypatch):
    """Their signature has what the registry declares, of the declared types, and asks for the values it is for."""
    tiny = weights.Layout(views=2, azimuths=1, turns=1, cell_rings=1, cell_turns=1, stretch=(1.0, 0.5))
    rows = np.arange(2.0 * (weights.numbers(tiny, 1) // 2)).reshape(2, -1)
    few = weights.Weights(tiny, rows, np.array([[7.0, 8.0, 9.0]]), 1, np.zeros(2))
    monkeypatch.setattr(weights, "weights", lambda of, given: few)
    text = source.assemble(model)
    assert f"#define MODEL {model.id}\n" in text and "#include" not in text
    inputs = re.search(r"#define MODEL_PARAMETERS (.*)\n", text)[1]
    found = re.findall(r'(float|int|color|normal|string) (\w+) = ((?:color|normal)\([^)]*\)|[-\d.e]+|"[^"]*")', inputs)
    assert [(kind, name) for kind, name, _ in found] == [(TYPES[p.kind], p.id) for p in model.parameters]
    for (kind, name, default), parameter in zip(found, model.parameters, strict=True):
        assert (json.loads(default) if kind == "string" else numbers(kind, default)) == parameter.default, name
        assert ("(" in default) == (kind in ("color", "normal")), f"{name}: Cycles sets no input of another type"
    conditions = re.search(r"#define MODEL_MATCHES (.*)\n", text)[1]
    asked = set(re.findall(r"\b[a-z]\w*\b", conditions)) - {"abs", "e"}
    assert asked == {p.id for p in model.parameters if p.evaluated}
    written = array(text, "weights")
    np.testing.assert_array_equal(written[:2], tiny.stretch)
    np.testing.assert_allclose(written[2:], [few.brightness, *rows.ravel(), 7, 8, 9], rtol=1e-5)
    assert "#define W_CHANNELS 1\n" in text


def test_unknown_lut():
    for lut in ("texture", "", None):
        with pytest.raises(ValueError, match="compiled, file") as caught:
            source.assemble(MODELS["phong"], lut)
        assert repr(lut) in str(caught.value)


def test_a_table_that_cannot_be_used(table_folder):
    with pytest.raises(TableError) as caught:
        source.assemble(MODELS["pumped_blinn"])
    assert caught.value.code == "missing" and caught.value.path.parent == table_folder
    # File materials find out when they render, and the unpumped models need no table.
    assert str(table_folder) in source.assemble(MODELS["pumped_blinn"], source.FILE)
    assert source.assemble(MODELS["blinn"])


def test_weights_hold_for_their_values_to_single_precision():
    """What is off by 1e-4 is told; what rounding makes of a value is not."""
    model = MODELS["ward"]
    text = source.assemble(model, baked=ranges.Sets((), (weights.blank(model, {}),)), parameters={"roughness_u": 0.37})
    (condition,) = re.findall(r"^#define MODEL_MATCHES (.*)$", text, re.MULTILINE)
    value, slack = map(float, re.search(r"abs\(roughness_u - (\S+)\) <= (\S+)", condition).groups())
    assert value == pytest.approx(0.37, rel=1e-6) and 2.0**-24 * value < slack < 1e-4 * value
