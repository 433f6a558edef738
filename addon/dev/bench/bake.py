"""The cost of an albedo by our quadrature, by Monte Carlo with a Sobol sequence, as in Cycles, and by a plain grid.

The reference is the quadrature with twice the nodes each way, which two other integrals confirm (tests/test_baking.py).
"""
import os
import tempfile
import tracemalloc
from pathlib import Path

import numpy as np

from ...forms.albedo import bake, tables
from ...measure import plots
from ...models import exr
from ...models.lobes import BLINN, PHONG
from ...models.quadrature import polar_energy
from .clock import milliseconds

EXPONENTS = (1.0, 20.0, 1000.0, 100000.0)
VIEWS = np.cos(np.radians([0.0, 30.0, 50.0, 65.0, 75.0, 82.0, 87.0, 89.5]))
NODES = ((2, 5), (4, 9), (6, 14), (8, 18), (12, 27), (16, 36))
TRUTH = (32, 72)
SOBOL, GRID = range(6, 19, 2), (8, 16, 32, 64, 128, 256, 512)
BOUND = bake.NODE_BOUND
IO_REPEATS, EVERY = 9, 8  # repeats of writing and reading; one in EVERY rows of a table is baked


def measure(effort, progress) -> dict:
    """{albedo: error by cost, exponents: ms by exponent, sizes: ms by columns, tables: ms of bake and I/O}, in rows."""
    rows, lobes = [], (PHONG, BLINN)
    plans = [(name, size) for name, sizes in (("ours", NODES), ("sobol", SOBOL), ("grid", GRID)) for size in sizes]
    total = len(plans) * len(lobes) + len(tables.TABLES) + 2
    for lobe in lobes:
        truth = {n: polar_energy(lobe, n, VIEWS, *TRUTH)[1].sum(axis=1) for n in EXPONENTS}
        for method, size in plans:
            cost = _cost(_METHODS[method], lobe, size, truth, effort.repeats)
            rows.append({"lobe": lobe.id, "method": method, **cost})
            progress(len(rows), total)
    report = {"bound": BOUND, "albedo": rows, "exponents": _by_exponent(effort.repeats)}
    progress(len(rows) + 1, total)
    report["sizes"] = _by_size(effort.repeats)
    progress(len(rows) + 2, total)
    report["tables"] = []
    for name in tables.TABLES:
        report["tables"].append(_table(name, rows))
        progress(len(rows) + 2 + len(report["tables"]), total)
    return report


def _quadrature(lobe, n, size):
    """Albedos (views,) by our quadrature with `size` nodes, and the number of evaluations."""
    light, energy = polar_energy(lobe, n, VIEWS, *size)
    return energy.sum(axis=1), light.size * size[1]


def _sobol(lobe, n, size):
    """Albedos (views,) by 2^`size` samples of a Sobol sequence, and the number of evaluations."""
    from scipy.stats import qmc

    u = qmc.Sobol(2, seed=1).random_base2(size)
    albedos = []
    for mu in VIEWS:
        view = np.broadcast_to([np.sqrt(1.0 - mu * mu), 0.0, mu], (len(u), 3))
        light = lobe.sample(view, u, n)
        density = lobe.pdf(view, light, n)
        seen = (light[:, 2] > 0.0) & (density > 0.0)
        value = lobe.value(view[seen], light[seen], n) * light[seen, 2] / density[seen]
        albedos.append(value.sum() / len(u))
    return np.array(albedos), len(u) * len(VIEWS)


def _grid(lobe, n, size):
    """Albedos (views,) by a grid of `size` x 2 `size` midpoints in angle, and the number of evaluations."""
    theta = 0.5 * np.pi * (np.arange(size) + 0.5) / size
    phi = np.pi * (np.arange(2 * size) + 0.5) / (2 * size)
    sine, cosine = np.sin(theta)[:, None], np.cos(theta)[:, None]
    light = np.stack(np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), cosine), axis=-1).reshape(-1, 3)
    weight = np.broadcast_to(2.0 * sine * cosine, (size, 2 * size)).ravel() * 0.5 * np.pi / size * np.pi / (2 * size)
    albedos = [lobe.value(np.broadcast_to([np.sqrt(1.0 - mu * mu), 0.0, mu], light.shape), light, n) @ weight
               for mu in VIEWS]
    return np.array(albedos), light.shape[0] * len(VIEWS)


_METHODS = {"ours": _quadrature, "sobol": _sobol, "grid": _grid}


def _cost(method, lobe, size, truth, repeats):
    """Error, evaluations and time of one albedo, means over exponents, and memory of all views at once."""
    errors, evaluations = {}, 0
    for n in EXPONENTS:
        albedos, count = method(lobe, n, size)
        errors[f"{n:g}"] = float(np.abs(albedos / truth[n] - 1.0).max())
        evaluations += count / (len(EXPONENTS) * len(VIEWS))
    spent = milliseconds(lambda: [method(lobe, n, size) for n in EXPONENTS], repeats) / (len(EXPONENTS) * len(VIEWS))
    tracemalloc.start()
    method(lobe, EXPONENTS[1], size)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return {"evaluations": evaluations, "ms_per_albedo": spent, "peak_kb": 1e-3 * peak, "error": errors,
            "largest_error": max(errors.values())}


def _by_exponent(repeats):
    """Milliseconds of a table's row, by the row's exponent."""
    table = tables.TABLES["phong_controlled"]
    rows = np.unique(np.linspace(0, table.height - 1, 9).astype(int))
    return [{"exponent": float(table.rows.exponents()[row]),
             "ms": milliseconds(lambda row=row: bake.bake_row((table, row)), min(repeats, 3))} for row in rows]


def _by_size(repeats):
    """Milliseconds of the row nearest to n = 20, by the table's columns."""
    declared, times = tables.TABLES["phong_controlled"], []
    for columns in (36, 72, 144, 288, 576):
        table = declared.with_axes(**{**declared.told_axes(), "columns": columns})
        row = int(np.abs(np.log(table.rows.exponents() / 20.0)).argmin())
        times.append({"columns": columns,
                      "ms": milliseconds(lambda t=table, r=row: bake.bake_row((t, r)), min(repeats, 3))})
    return times


def _table(name, albedos):
    """Times of a bake (of one in EVERY rows, times EVERY), and of writing the file and reading it back.

    `least_ms` bounds the time of any quadrature that needs as many evaluations as ours within the bound: the four
    albedos of a chain share evaluations, and only the power is counted.
    """
    table = tables.in_use(name)
    rows = range(0, table.height, EVERY)
    spent = milliseconds(lambda: [bake.bake_row((table, row)) for row in rows], 1) * table.height / len(rows)
    image, metadata = exr.read(table.path)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "table.exr"

        def pass_through():
            exr.write(path, image, metadata)
            exr.read(path)

        moved = milliseconds(pass_through, IO_REPEATS)
        size = os.path.getsize(path)
    needed = [row["evaluations"] for row in albedos if row["method"] == "ours" and row["largest_error"] <= BOUND]
    least = min(needed, default=float("nan")) * table.height * table.columns.columns * _power_ms()
    return {"table": name, "bytes": size, "bake_ms": spent, "write_and_read_ms": moved, "least_ms": least}


def _power_ms():
    """Milliseconds of one power, in an array that fits the processor's cache."""
    base = np.linspace(0.1, 1.0, 4096)
    return milliseconds(lambda: [base**20.5 for _ in range(64)], 5) / (64 * len(base))


def lines(report):
    """Yields the errors and costs, the times of rows, and the times of tables."""
    yield "error of an albedo by its cost, largest over views and exponents"
    for row in report["albedo"]:
        by = "  ".join(f"n={n}: {error:.1e}" for n, error in row["error"].items())
        yield (f"  {row['lobe']:6} {row['method']:6} {row['evaluations']:9.0f} evaluations "
               f"{row['ms_per_albedo']:9.3f} ms {row['peak_kb']:9.0f} kB   {by}")
    by_exponent = (f"{r['exponent']:.3g}: {r['ms']:.0f} ms" for r in report["exponents"])
    yield "a row of the table by exponent: " + ", ".join(by_exponent)
    yield "and by columns: " + ", ".join(f"{r['columns']}: {r['ms']:.0f} ms" for r in report["sizes"])
    for row in report["tables"]:
        moved = row["write_and_read_ms"]
        yield (f"  {row['table']:17} {1e-3 * row['bytes']:6.0f} kB   bake {row['bake_ms']:7.0f} ms   write and read "
               f"{moved:5.1f} ms (x{row['bake_ms'] / moved:.0f}; evaluations alone x{row['least_ms'] / moved:.1f})")


def draw(report):
    """Plots error over time and over memory for the three methods, and a row's time over its size."""
    plt = plots._pyplot()
    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.8), layout="constrained")
    names = {"ours": "ours", "sobol": "Monte Carlo, Sobol", "grid": "plain grid"}
    for i, method in enumerate(names):
        for lobe, style in (("phong", "o-"), ("blinn", "s--")):
            rows = [r for r in report["albedo"] if r["method"] == method and r["lobe"] == lobe]
            for axis, key in zip(axes, ("ms_per_albedo", "peak_kb"), strict=False):
                axis.plot([r[key] for r in rows], [r["largest_error"] for r in rows], style, ms=4,
                          color=plots.VIEWS[i], label=f"{names[method]}, {lobe}")
    for axis, label in zip(axes, ("milliseconds per albedo", "peak kB of eight views"), strict=False):
        axis.axhline(report["bound"], color=plots.INK, lw=0.8, ls=(0, (4, 3)))
        axis.set(xscale="log", yscale="log", xlabel=label, ylabel="largest relative error, n from 1 to 100000")
    axes[0].legend(frameon=False, fontsize=8)
    axes[2].plot([r["exponent"] for r in report["exponents"]], [r["ms"] for r in report["exponents"]], "o-",
                 color=plots.VIEWS[0], ms=4, label="by exponent")
    axes[2].plot([r["columns"] for r in report["sizes"]], [r["ms"] for r in report["sizes"]], "s-",
                 color=plots.VIEWS[1], ms=4, label="by columns")
    axes[2].set(xscale="log", yscale="log", xlabel="exponent, or columns", ylabel="ms per row (phong_controlled)")
    axes[2].legend(frameon=False, fontsize=8)
    return figure
