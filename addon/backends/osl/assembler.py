"""Assembles a model's shader: headers are inserted; base lobes, tables and lobe rows become arrays of numbers."""
import json
import re
from functools import lru_cache
from pathlib import Path

import numpy as np

from ... import resources
from ...forms import bells, closures
from ...forms.albedo import tables, tabulated
from ...forms.albedo.axes import SineAxis
from ...forms.rows import grid, lobe_rows
from ...models import images
from . import constants, definitions, estimator

_INCLUDE = re.compile(r'^#include (?:"([^"]+)"|(\w+))\n', re.MULTILINE)
COMPILED, FILE = "compiled", "file"
_written = {}  # name of a table -> (its nodes, their text): formatting takes long


def shader_path(model) -> Path:
    """The .osl file of a model. Models that differ only in headers and macros share a file."""
    if estimator.is_baked(model):
        name = "weights"
    elif estimator.base_family(model):
        name = "lobe"
    else:
        name = "lump" if len(getattr(model, "lumps", ())) == 1 else model.id
    return resources.OSL / f"{name}.osl"


def chosen_headers(model) -> dict:
    """{macro: header} of the includes that the model's declaration chooses; {} where a shader has none."""
    if not estimator.base_family(model):
        return {}
    return {"LOBE_HEADER": f"include/lobe_{model.lobe.id}.h",
            "CORRECTION_HEADER": f"include/correction_{model.correction}.h"}


def program_of(model) -> tuple:
    """What distinguishes the shaders of models: the file's name, and the headers and macros that the model chooses."""
    return shader_path(model).name, *chosen_headers(model).values(), *_disk(model).values()


def assemble(model, lut: str = COMPILED, parameters: dict | None = None, driven: dict | None = None, baked=None,
             defines: dict | None = None) -> str:
    """The OSL source of `model`, with all includes inserted.

    A baked model's lobe rows are `baked`, a `grid.ParameterGrid`; without it they are baked for `parameters` {id:
    value}, over the ranges `driven` {id: (least, most)}, see forms/rows/grid.py.

    `lut` is "compiled" (tables are numbers in the text) or "file" (texture() reads the tables; their paths are the
    string parameters table_plain, table_controlled and table_volume). `defines` {macro: text} replaces macros, such as
    `definitions.HOOKS`.

    Raises ValueError for another `lut` or an unknown macro, brdf.TableError when a table cannot be used, and OSError
    when a source file is missing.
    """
    if lut not in (COMPILED, FILE):
        raise ValueError(f"lut: {lut!r} is not one of {COMPILED}, {FILE}")
    text = _flattened(shader_path(model), chosen_headers(model), set())
    # The model's own macros.
    if estimator.is_baked(model):
        own = _weights(model, parameters or {}, baked or grid.bake(model, parameters or {}, driven))
    else:
        own = _definitions(model, lut)
    # `defines` may replace only macros that exist.
    macros = definitions.HOOKS | _signature(model) | own
    for name in defines or {}:
        if name not in macros:
            raise ValueError(f"no macro {name!r} is written for {model.id}; there are {', '.join(macros)}")
    return constants.header() + definitions.text(macros | (defines or {})) + text


def spans(model) -> dict:
    """{name of a table: (least, largest) exponent}: the exponents for which a shader can be assembled now."""
    return {name: _in_use(name, FILE).span for name in tabulated.tables_of(model)}


def mode_of(table) -> str:
    """A table's name in a shader, "plain", "controlled" or "volume": the parameter is table_ and this."""
    if isinstance(table, tables.VolumeTable):
        return "volume"
    return "controlled" if table.control else "plain"


def _flattened(path: Path, chosen: dict, seen: set) -> str:
    """The text of a file, with each include inserted once, at its first mention; `chosen` is {macro: header}."""

    def inserted(match):
        included = (path.parent / (match[1] or chosen[match[2]])).resolve()
        if included in seen:
            return ""
        seen.add(included)
        return _flattened(included, chosen, seen)

    return _INCLUDE.sub(inserted, _read(path))


def _read(path: Path) -> str:
    """The text of a file of the extension. Raises OSError, with the cure, where it is missing or not UTF-8."""
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise OSError(f"{path}: {reason}; this file belongs to the extension: install it again") from None


def _read_json(path: Path):
    """The contents of a JSON file of the extension. Raises OSError as `_read`."""
    try:
        return json.loads(_read(path))
    except ValueError as error:
        raise OSError(f"{path}: damaged ({error}); this file belongs to the extension: install it again") from None


_TYPES = {"float": "float", "int": "int", "bool": "int", "enum": "int", "color": "color", "vector": "normal",
          "image": "string"}


def _signature(model) -> dict:
    """Macros: the model's name and inputs, the range of each number and color, and the default of each number."""
    inputs = [f"{_TYPES[q.kind]} {q.id} = {_literal(_TYPES[q.kind], q.default)}" for q in model.parameters]
    macros = {"MODEL": model.id, "MODEL_PARAMETERS": ", ".join(inputs)}
    for q in model.parameters:
        if q.kind in ("float", "int", "enum", "color"):
            kind = "float" if q.kind == "color" else _TYPES[q.kind]
            macros |= {f"LEAST_{q.id}": _literal(kind, q.minimum), f"MOST_{q.id}": _literal(kind, q.maximum)}
        if q.kind == "float":
            macros[f"DEFAULT_{q.id}"] = _literal("float", q.default)
    return macros


def _definitions(model, lut) -> dict:
    """Macros of a model with a shader of its own, DATA_PARAMETERS among them: the arrays with their values."""
    macros, parameters = _base(estimator.base_family(model)) if estimator.base_family(model) else _bells()
    macros, parameters = macros | _disk(model), list(parameters)
    for table in (_in_use(name, lut) for name in tabulated.tables_of(model)):
        mode = mode_of(table)
        parameters.append(_table_parameter(table, mode, lut))
        macros |= _axes(table, mode.upper(), lut)
        if mode == "volume":
            macros["VOLUME_LAYERS"] = table.layers
    if lut == FILE and tabulated.tables_of(model):
        macros["TABLE_FILE"] = ""
    return macros | {"DATA_PARAMETERS": ", ".join(parameters)}


def _disk(model) -> dict:
    """Macros of a model of lumps: the projection, and whether a single lump is shrunk until it is inside the disk."""
    if not hasattr(model, "projection"):
        return {}
    macros = {"PROJECTION": model.projection.id.upper()}
    if len(model.lumps) == 1:
        macros["HELD_RADII"] = int(model.lumps[0].held)
    return macros


def _in_use(name, lut):
    """A table with the axes of its file. With `lut` "file" an unusable file gives the declared axes instead.

    The shader checks the file when it renders. Raises TableError otherwise.
    """
    try:
        return tables.in_use(name)
    except tables.TableError:
        if lut == FILE:
            return tables.TABLES[name]
        raise


def _weights(model, parameters, baked) -> dict:
    """Macros of a baked model: the condition on its inputs for which its rows hold, the layout, and the rows."""
    p = model.resolve(parameters)
    driven = {axis.parameter.id for axis in baked.ranges}
    matches = [_matches(q, p[q.id]) for q in model.parameters if q.evaluated and q.id not in driven]
    first = baked.nodes[0]
    layout = first.layout
    return {
        "MODEL_LABEL": f'"{model.label}"', "MODEL_MATCHES": " && ".join(matches) or "1",
        # The layout of rows.
        "W_VIEWS": layout.views, "W_AZIMUTHS": layout.azimuths, "W_WHOLE": int(layout.whole),
        "W_RINGS": layout.cell_rings, "W_AROUND": layout.cell_turns, "W_CHANNELS": baked.channels,
        "W_SPIKES": lobe_rows.SPIKES if len(first.spike) else 0,
        # The driven parameters.
        "W_RANGES": len(driven), "W_SETS": len(baked.nodes), "RANGE_PLACES": ", ".join(map(_place, baked.ranges)),
        "RANGE_STEPS": ", ".join(str(axis.steps) for axis in baked.ranges),
        "RANGE_STORAGE": ", ".join(map(str, baked.storage_index)),
        "DATA_PARAMETERS": _array("weights", np.concatenate([_flat(rows, baked.channels) for rows in baked.stored])),
    }


def _place(driven):
    """OSL expression of the position of a driven parameter's input among its steps."""
    kind, name = driven.parameter.kind, driven.parameter.id
    value = name if kind == "color" else f"color({name})"
    return f"range_place({value}, {driven.least!r}, {driven.most!r}, {driven.steps}, {int(driven.geometric)})"


def _flat(rows, channels):
    """The numbers of lobe rows as osl/include/weights.h reads them, with the `channels` that all nodes of a grid have.

    Before all rows stand the numbers of `constants.ROW_HEAD`. A row is the residual's albedo; its facets, the numbers
    of `constants.ROW_FACET` each; the diffuse color; the residual's edges, and its energies. The spike's colors end it.
    """
    facets, residual = rows.facets, rows.with_channels(channels).residual
    numbers = np.concatenate([facets.slopes, facets.widths, facets.colour], axis=-1)
    arrays = (residual.albedo, numbers, rows.diffuse, residual.ring_edges, residual.cell_edges, residual.energies)
    table = np.concatenate([array.reshape(len(rows), -1) for array in arrays], axis=1)
    return np.concatenate([[*rows.layout.stretch, rows.brightness], table.ravel(), rows.spike.ravel()])


def _literal(kind, value):
    """A default in OSL, of the input's own type: Cycles does not set inputs whose default is converted."""
    if kind == "string":
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, tuple):
        return "{}({}, {}, {})".format(kind, *value)
    return repr(float(value)) if kind == "float" else f"{value:d}"


def _matches(parameter, value):
    """OSL condition that an input equals `value`, to single precision."""
    if parameter.kind == "color":
        return " && ".join(f"abs({parameter.id}[{i}] - {c!r}) <= {1e-5 * max(abs(c), 1e-3):.3g}"
                           for i, c in enumerate(value))
    if parameter.kind == "float":
        return f"abs({parameter.id} - {value!r}) <= {1e-5 * max(abs(value), 1e-3):.3g}"
    if parameter.kind == "image":
        return f"{parameter.id} == {_literal('string', value)}"
    return f"{parameter.id} == {int(value)}"


def _bells():
    """(macros, array parameters) of the table of bells, see addon/forms/bells.py."""
    path = resources.LUTS / bells.FILE
    return _bells_of(path, images.stamp(path))


@lru_cache(maxsize=1)
def _bells_of(path, _):
    stored = _read_json(path)
    few, steep = np.array(stored["table"]), np.array(stored["steep"])
    numbers = {"BELLS_ROW": few.shape[1], "STEEP_ROWS": few.size, "STEEP_ROW": steep.shape[1],
               "STEEP_KNOTS": steep.shape[1] - bells.KNOTS - 1}
    return numbers, (_array("bells", [*few.ravel(), *steep.ravel()]),)


def _base(family):
    """(macros, array parameters) of a family's base lobes, see addon/forms/base_lobes."""
    path = resources.LUTS / "base_lobes.json"
    return _base_of(family, path, images.stamp(path))


@lru_cache(maxsize=4)
def _base_of(family, path, _):
    base = _read_json(path)
    own = base["families"][family]
    # One row for each closure: a ramp off the plane of incidence is a pair, of one set of levels.
    ramps = [(r["lean"], r["sharp"], side, r["crease"], i) for i, r in enumerate(own["ramps"])
             for side in ((-r["side"], r["side"]) if r["side"] else (0.0,))]
    facets = [(f["lean"], f["sharp"]) for f in own["facets"]]
    # Macros without their prefix, and the arrays.
    numbers = {"U": own["u_nodes"], "POWER": own["power"], "V": own["v_nodes"], "FEATURES": len(base["features"]),
               "GRAZING": base["grazing"], "DRAWN": base["drawn"], "NEGATIVE_RADIUS": base["hole"],
               "SETS": len(own["ramps"]), "STRIDE": own["stride"], "LEVELS": closures.SLOTS * len(own["ramps"]),
               "RAMPS": len(ramps), "FACETS": len(facets), "FACET_ROOM": max(len(facets), 1),
               "PLAIN": int(own["plain"])}
    arrays = [_array("base_widths", base["features"]), _array("base_ramps", np.ravel(ramps)),
              _array("base_facets", np.ravel(facets or [(0.0, 0.0)])), _vectors("base_table", own["table"])]
    return {f"BASE_{name}": value for name, value in numbers.items()}, tuple(arrays)


def _table_parameter(table, mode, lut):
    """The parameter of a table: its path, or an array of its nodes."""
    if lut == FILE:
        return f'string table_{mode} = "{table.path.as_posix()}"'
    nodes = tables.load(table)
    if table.name not in _written or _written[table.name][0] is not nodes:
        # Six digits keep a node within 5e-6, a quarter of the tables' bound for nodes.
        _written[table.name] = nodes, _array(f"table_{mode}", nodes.ravel())
    return _written[table.name][1]


def _axes(table, mode, lut):
    """Macros of a table's axes, in the order of `Axes` in osl/include/table.h, and of its name in messages."""
    c, r = table.columns, table.rows
    numbers = (f"{c.columns}, {c.grazing}, {c.normal}, {r.rows}, {r.density}, {r.law}, {table.stamp!r}, "
               f"{int(isinstance(c, SineAxis))}, {table.height}, {r.lowest}, {r.highest}")
    name = f"table_{mode.lower()}" if lut == FILE else f'"{table.name}"'
    return {f"AXES_{mode}": f"Axes({numbers})", f"TABLE_NAME_{mode}": name}


def _array(name, values):
    """A float array parameter with its values, to six digits."""
    text = ",".join(f"{v:.6g}" for v in values)
    return f"float {name}[{len(values)}] = {{{text}}}"


def _vectors(name, values):
    """A parameter, an array of vectors, with its values, three to a vector, to four digits."""
    rows = np.reshape(values, (-1, 3))
    text = ",".join(f"vector({x:.4g},{y:.4g},{z:.4g})" for x, y, z in rows)
    return f"vector {name}[{len(rows)}] = {{{text}}}"
