"""Size and error of the albedo tables, by a factor of columns and rows, in single and half precision."""
import numpy as np

from ...forms.albedo import bake, tables
from ...measure import plots

FACTORS = (0.25, 0.35, 0.5, 0.7, 1.0, 1.4)
CELLS = 6  # pairs of rows where a table's error is measured, including the last pair


def measure(effort, progress) -> dict:
    """{rows: [{table, factor, precision, bytes, error}]}: the largest relative error between nodes, at CELLS rows."""
    names = [name for name, table in tables.TABLES.items() if isinstance(table, tables.Table)]
    rows, done = [], 0
    for name in names:
        for factor in FACTORS:
            rows.extend(_rows(tables.TABLES[name], factor))
            done += 1
            progress(done, len(names) * len(FACTORS))
    return {"rows": rows}


def _rows(declared, factor):
    """Yields the size and error of a table in each precision, its columns and rows multiplied by `factor`."""
    axes = declared.told_axes()
    axes.update({axis: round(factor * axes[axis]) for axis in ("columns", "rows")})
    table = declared.with_axes(**axes)
    # Only the rows whose cells are measured are baked.
    nodes = np.zeros((table.height, table.columns.columns, 4))
    chosen = np.unique(np.linspace(0, table.height - 2, CELLS).astype(int))
    for row in {*chosen, *(chosen + 1)}:
        nodes[row] = bake.bake_row((table, row))
    for precision in (np.float32, np.float16):
        stored = nodes.astype(precision).astype(np.float64)
        yield {"table": table.name, "factor": factor, "precision": precision.__name__,
               "bytes": int(nodes.size * np.dtype(precision).itemsize),
               "error": max(float(bake.cell_errors(table, stored, row)[1]) for row in chosen)}


def lines(report):
    """Yields a line for each table, factor and precision."""
    for row in report["rows"]:
        yield (f"{row['table']:17} x{row['factor']:<5g} {row['precision']:8} {1e-3 * row['bytes']:7.0f} kB   "
               f"within {row['error']:.1e}")


def draw(report):
    """Plots error over size, a line for each table; half precision is dotted."""
    plt = plots._pyplot()
    figure, axis = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
    for i, name in enumerate(dict.fromkeys(row["table"] for row in report["rows"])):
        for precision, style in (("float32", "o-"), ("float16", "o:")):
            rows = [r for r in report["rows"] if r["table"] == name and r["precision"] == precision]
            axis.plot([1e-3 * r["bytes"] for r in rows], [r["error"] for r in rows], style, ms=4, color=plots.VIEWS[i],
                      label=name if precision == "float32" else None)
    axis.axhline(bake.INTERPOLATION_BOUND, color=plots.INK, lw=0.8, ls=(0, (4, 3)))
    axis.plot([], [], "o:", color=plots.INK, ms=4, label="half precision")
    axis.set(xscale="log", yscale="log", xlabel="kB, uncompressed", ylabel="largest relative error between nodes")
    axis.legend(frameon=False, fontsize=8)
    return figure
