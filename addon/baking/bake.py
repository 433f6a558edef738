"""Bake jobs: compute the albedo tables, write them with their provenance, and re-derive their errors."""
import os
import platform

import numpy as np

from ..brdf import exr, tables
from . import albedo_rows, volume_rows
from .workers import mapped

NODE_BOUND, INTERPOLATION_BOUND = 2e-5, 1e-3
_KINDS = {tables.Table: albedo_rows, tables.VolumeTable: volume_rows}


def kind_of(table):
    """The module that computes a table's rows: `nodes`, `cell_errors`, `provenance`."""
    return _KINDS[type(table)]


def bake_row(job) -> np.ndarray:
    """Nodes (columns, 4) of one row of the image; `job` is (table name, row)."""
    name, row = job
    table = tables.TABLES[name]
    return kind_of(table).nodes(table, row)


def bake(names=None, workers=None):
    """Bake tables, a generator that yields (rows done, rows in all, table name) after every row.

    Each table is written beside its file and renamed only when it is whole, so that closing the generator (or Ctrl-C)
    leaves the old tables as they were. Raises OSError when the folder cannot be written.
    """
    names = list(names or tables.TABLES)
    _require_writable(tables.folder())
    jobs = [(name, row) for name in names for row in range(tables.TABLES[name].height)]
    done = {name: [] for name in names}
    for count, ((name, _), nodes) in enumerate(zip(jobs, mapped(bake_row, jobs, workers), strict=True), 1):
        done[name].append(nodes)
        if len(done[name]) == tables.TABLES[name].height:
            _write(tables.TABLES[name], np.stack(done.pop(name)))
        yield count, len(jobs), name
    tables.forget()


def _require_writable(folder):
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{folder}: this folder is read-only; choose another with --output or in the preferences")


def _write(table, nodes):
    # The last cell is the widest, and often the worst.
    errors = sampled_error(table, nodes, {*range(0, table.height - 1, 16), table.height - 2})
    exr.write(table.path, tables.marked(table, nodes), {
        **kind_of(table).provenance(table),
        "plausible:error": f"interpolation {errors:.1e} on every 16th row and the last; bounds: nodes {NODE_BOUND:g}, "
                           f"interpolation {INTERPOLATION_BOUND:g} (relative)",
        "plausible:software": f"Plausible BRDF table format {tables.FORMAT}, NumPy {np.__version__}, "
                              f"Python {platform.python_version()}",
    })


def sampled_error(table, nodes, rows) -> float:
    """Largest relative error of reading `nodes` half-way between the given rows and their successors."""
    return max(cell_errors(table, nodes, row)[1] for row in rows)


def cell_errors(table, nodes, row, refined=False):
    """(node error, interpolation error), relative, of one row and of the cells between it and the next.

    Truth is the integral itself at other points: at the row's own nodes with a finer quadrature when `refined`, and at
    the middle and quarters of the cells, half-way to the next row.
    """
    return kind_of(table).cell_errors(table, nodes, row, refined)


def _check_row(job):
    name, row = job
    table = tables.TABLES[name]
    return cell_errors(table, tables.load(table), row, refined=True)


def check(names=None, workers=None):
    """Re-derive the errors of the shipped tables, a generator.

    Yields (rows done, rows in all, table name, report); `report` is None until the table's last row, then a dict with
    node_error, interpolation_error, ok and, where a table is missing, stale or damaged, message.
    """
    names = list(names or tables.TABLES)
    usable, jobs = [], []
    total = sum(tables.TABLES[name].height for name in names)
    for name in names:
        try:
            tables.load(tables.TABLES[name])
            usable.append(name)
            jobs.extend((name, row) for row in range(tables.TABLES[name].height))
        except tables.TableError as error:
            yield 0, total, name, {"table": name, "ok": False, "message": str(error)}
    errors = {name: [] for name in usable}
    results = mapped(_check_row, jobs, workers)
    for count, ((name, _), error) in enumerate(zip(jobs, results, strict=True), 1):
        errors[name].append(error)
        report = None
        if len(errors[name]) == tables.TABLES[name].height:
            node, between = np.max(errors[name], axis=0).tolist()
            report = {"table": name, "node_error": node, "interpolation_error": between,
                      "ok": node <= NODE_BOUND and between <= INTERPOLATION_BOUND}
        yield count, total, name, report
