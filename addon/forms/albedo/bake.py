"""The bake of albedo tables: it computes them, writes them with their provenance, and measures their errors."""
import json
import os
import platform
import time

import numpy as np

from ...models import exr
from ..workers import mapped
from . import albedo_rows, sizes, tables, volume_rows

NODE_BOUND, INTERPOLATION_BOUND = 2e-5, 1e-3  # largest relative errors at nodes and between them
MEASURED = 4  # each bake measures the error of every fourth row, and of the last
_ABANDONED = 3600.0  # age in seconds from which on a temporary file is from a bake that was killed
# {kind of a table: the module of its rows}.
_KINDS = {tables.Table: albedo_rows, tables.VolumeTable: volume_rows}


def kind_of(table):
    """The module that computes a table's rows: `nodes`, `cell_errors`, `provenance`."""
    return _KINDS[type(table)]


def bake_row(job) -> np.ndarray:
    """Nodes (columns, 4) of one row of the image; `job` is (table, row)."""
    table, row = job
    return kind_of(table).nodes(table, row)


def measure_row(job) -> float:
    """Largest relative error of readings half-way from a row to the next; `job` is (table, nodes, row)."""
    table, nodes, row = job
    return cell_errors(table, nodes, row)[1]


def measured_rows(table) -> list:
    """The rows whose error a bake measures. The last is among them: its cell is the widest, and often the worst."""
    return sorted({*range(0, table.height - 1, MEASURED), table.height - 2})


def bake(names=None, workers=None, size=sizes.STANDARD):
    """Bake the tables `names`, by default all, a generator that yields (steps done, all steps, table name).

    `size` is their resolution and range, and `workers` the number of processes. After the rows of a table, the errors
    between rows are measured, and written with them. A table replaces its old file only when it is complete: when the
    generator is closed (or on Ctrl-C), the old tables do not change. Raises OSError when the folder cannot be written.
    """
    baked = [sizes.sized(tables.TABLES[name], size) for name in names or tables.TABLES]
    folder = tables.folder()
    require_writable(folder)
    total, done = sum(steps(table) for table in baked), 0
    # The rows of each table, then their errors.
    for table in baked:
        rows, errors = [], []
        for row in mapped(bake_row, [(table, row) for row in range(table.height)], workers):
            rows.append(row)
            done += 1
            yield done, total, table.name
        nodes = np.stack(rows).astype(np.float32).astype(np.float64)
        for error in mapped(measure_row, [(table, nodes, row) for row in measured_rows(table)], workers):
            errors.append(error)
            if len(errors) == len(measured_rows(table)):
                _write(folder / table.path.name, table, nodes, max(errors), size)
            done += 1
            yield done, total, table.name
    tables.forget()


def steps(table) -> int:
    """The number of steps of `bake` for a table."""
    return table.height + len(measured_rows(table))


def require_writable(folder):
    """Make a folder for tables where it is missing, and delete abandoned files. Raises OSError if it is read-only."""
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{folder}: this folder is read-only; choose another with --output or in the preferences")
    for part in folder.glob(".*.exr.*.part"):
        if time.time() - part.stat().st_mtime > _ABANDONED:
            part.unlink(missing_ok=True)


def _write(path, table, nodes, error, size):
    """Write a table, with its provenance, axes and `error` as metadata."""
    exr.write(path, tables.marked(table, nodes), {
        **kind_of(table).provenance(table),
        tables.AXES: json.dumps(table.told_axes()),
        tables.RESOLUTION: size.resolution,
        tables.ERROR: f"interpolation {error:.1e} on every {MEASURED}th row and the last; bounds: nodes "
                      f"{NODE_BOUND:g}, interpolation {sizes.bound(size.resolution, INTERPOLATION_BOUND):g} (relative)",
        "plausible:software": f"Plausible BRDF table format {tables.FORMAT}, NumPy {np.__version__}, "
                              f"Python {platform.python_version()}",
    })


def cell_errors(table, nodes, row, refined=False):
    """(node error, interpolation error), both relative, of one row and of the cells between it and the next.

    They compare `nodes` (rows, columns, 4) with the integral itself. The node error is that at the row's own nodes,
    with a finer quadrature; it is 0 unless `refined`. The interpolation error is that half-way to the next row, at the
    columns and between them.
    """
    return kind_of(table).cell_errors(table, nodes, row, refined)


def _check_row(job):
    """`cell_errors` of a row of a table in use; `job` is (table name, row)."""
    name, row = job
    table = tables.in_use(name)
    return cell_errors(table, tables.load(table), row, refined=True)


def check(names=None, workers=None):
    """Measure the errors of all rows of the tables in use, a generator.

    Yields (rows done, all rows, table name, report). `report` is None until a table's last row. Then it is a dict with
    "table", "node_error", "interpolation_error", "interpolation_bound" and "ok"; for a table that is missing, stale or
    damaged it has "table", "ok" and "message".
    """
    names = list(names or tables.TABLES)
    usable, jobs, unusable = {}, [], []
    for name in names:
        try:
            usable[name] = tables.in_use(name)
            jobs.extend((name, row) for row in range(usable[name].height))
        except tables.TableError as error:
            unusable.append((0, name, {"table": name, "ok": False, "message": str(error)}))
    # The unusable tables first, then the errors of the others, row by row.
    for done, name, report in unusable:
        yield done, len(jobs), name, report
    errors = {name: [] for name in usable}
    results = mapped(_check_row, jobs, workers)
    for count, ((name, _), error) in enumerate(zip(jobs, results, strict=True), 1):
        errors[name].append(error)
        report = None
        if len(errors[name]) == usable[name].height:
            node, between = np.max(errors[name], axis=0).tolist()
            bound = sizes.bound(tables.resolution(name), INTERPOLATION_BOUND)
            report = {"table": name, "node_error": node, "interpolation_error": between, "interpolation_bound": bound,
                      "ok": node <= NODE_BOUND and between <= bound}
        yield count, len(jobs), name, report
