"""Bake jobs: compute the albedo tables, write them with their provenance, and re-derive their errors."""
import json
import os
import platform
import time

import numpy as np

from ...models import exr
from ..workers import mapped
from . import albedo_rows, sizes, tables, volume_rows

NODE_BOUND, INTERPOLATION_BOUND = 2e-5, 1e-3
MEASURED = 4  # the error of every fourth row and the last is measured with each bake
_ABANDONED = 3600.0  # seconds after which a part of a file was left behind by a bake that was killed
_KINDS = {tables.Table: albedo_rows, tables.VolumeTable: volume_rows}


def kind_of(table):
    """The module that computes a table's rows: `nodes`, `cell_errors`, `provenance`."""
    return _KINDS[type(table)]


def bake_row(job) -> np.ndarray:
    """Nodes (columns, 4) of one row of the image; `job` is (table, row)."""
    table, row = job
    return kind_of(table).nodes(table, row)


def measure_row(job) -> float:
    """Largest relative error of a reading half-way from a row to the next; `job` is (table, nodes, row)."""
    table, nodes, row = job
    return cell_errors(table, nodes, row)[1]


def measured_rows(table) -> list:
    """The rows whose error is measured with a bake. The last cell is the widest, and often the worst."""
    return sorted({*range(0, table.height - 1, MEASURED), table.height - 2})


def bake(names=None, workers=None, size=sizes.STANDARD):
    """Bake tables, a generator that yields (steps done, steps in all, table name) after every row.

    `size` is their resolution and range. When all rows of a table are done, the error between them is measured, and
    written with them. Each table is written beside its file and renamed only when it is whole, so that closing the
    generator (or Ctrl-C) leaves the old tables as they were. Raises OSError when the folder cannot be written.
    """
    baked = [sizes.sized(tables.TABLES[name], size) for name in names or tables.TABLES]
    folder = tables.folder()
    require_writable(folder)
    total, done = sum(steps(table) for table in baked), 0
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
    """How many times `bake` yields for a table."""
    return table.height + len(measured_rows(table))


def require_writable(folder):
    """Make a folder for tables where there is none. Raises OSError where it cannot be written."""
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{folder}: this folder is read-only; choose another with --output or in the preferences")
    for part in folder.glob(".*.exr.*.part"):
        if time.time() - part.stat().st_mtime > _ABANDONED:
            part.unlink(missing_ok=True)


def _write(path, table, nodes, error, size):
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
    """(node error, interpolation error), relative, of one row and of the cells between it and the next.

    Truth is the integral itself at other points: at the row's own nodes with a finer quadrature when `refined`, and at
    the middle and quarters of the cells, half-way to the next row.
    """
    return kind_of(table).cell_errors(table, nodes, row, refined)


def _check_row(job):
    name, row = job
    table = tables.in_use(name)
    return cell_errors(table, tables.load(table), row, refined=True)


def check(names=None, workers=None):
    """Re-derive the errors of the tables in use, a generator.

    Yields (rows done, rows in all, table name, report); `report` is None until the table's last row, then a dict with
    node_error, interpolation_error, its bound, ok and, where a table is missing, stale or damaged, message.
    """
    names = list(names or tables.TABLES)
    usable, jobs, unusable = {}, [], []
    for name in names:
        try:
            usable[name] = tables.in_use(name)
            jobs.extend((name, row) for row in range(usable[name].height))
        except tables.TableError as error:
            unusable.append((0, name, {"table": name, "ok": False, "message": str(error)}))
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
