"""`plausible bake`."""
import json
import sys
import time

import numpy as np

from ..backends.osl import estimator
from ..cli import CommandError
from ..forms.albedo import bake, sizes, tables
from ..forms.rows import error as rows_error
from ..forms.rows import grid, row_bake
from ..library import star
from ..measure.specimen import settings
from ..models import find_model
from ..models.parameters import MAX_EXPONENT, MIN_EXPONENT

DESCRIPTION = ("Compute the albedo tables. A canceled run leaves the old tables whole. With --weights, bake the lobe "
               "rows of a model that has no shader of its own, as creating a material does, and print their error.")


def add_arguments(parser):
    parser.add_argument("table", nargs="*", metavar="TABLE",
                        help=f"of {', '.join(tables.TABLES)}; all when none is given")
    parser.add_argument("--models", nargs="+", metavar="MODEL",
                        help=f"only the tables of these models, of {', '.join(m.id for m in sizes.readers())}")
    parser.add_argument("--resolution", choices=list(sizes.RESOLUTIONS), default="standard",
                        help="; ".join(f"{name}: {r.help}" for name, r in sizes.RESOLUTIONS.items())
                        .replace("%", "%%") + " (default: %(default)s)")
    parser.add_argument("--range", nargs=2, type=float, default=(MIN_EXPONENT, MAX_EXPONENT),
                        metavar=("FROM", "TO"), help="range of exponents of the tables; the number of rows stays, so a "
                        "shorter range is finer. Materials outside render striped (default: 1 100000)")
    parser.add_argument("--check", action="store_true",
                        help="write nothing; measure every table's error again, and fail where one is stale or wrong")
    parser.add_argument("--base-lobes", action="store_true",
                        help="fit the shaders' base lobes instead (noise, blur and speed; needs SciPy)")
    parser.add_argument("--weights", metavar="MODEL",
                        help="write nothing; bake the lobe rows of this model, and print their size and error")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="a parameter of the --weights model; may be repeated")
    parser.add_argument("--drive", action="append", default=[], metavar="PARAMETER=FROM:TO",
                        help="bake the --weights model over a range of a parameter, as if a texture drives it; may "
                        "be repeated")
    parser.add_argument("--star", action="store_true", help="draw the default image of ndf_map instead")
    parser.add_argument("--output", metavar="DIR", help="folder of the tables (the package's luts by default)")
    parser.add_argument("--workers", type=int, metavar="N", help="processes (one a core by default)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    for name in arguments.table:
        if name not in tables.TABLES:
            raise CommandError(f"no table {name!r}; there are {', '.join(tables.TABLES)}")
    if arguments.models:
        if arguments.table:
            raise CommandError(f"name tables or --models, not both: got {arguments.table[0]} and {arguments.models[0]}")
        arguments.table = sizes.tables_of(arguments.models)
    # Nothing is computed before all arguments are valid.
    size = sizes.Size(arguments.resolution, *arguments.range)
    if arguments.workers is not None and arguments.workers < 1:
        raise CommandError(f"--workers: {arguments.workers} is less than 1")
    if arguments.output:
        tables.use_folder(arguments.output)
    if arguments.weights:
        return _state_weights(arguments)
    if arguments.star:
        print(star.write(tables.folder()))
        return None
    if arguments.base_lobes:
        return _fit_base_lobes(arguments)
    return _check(arguments) if arguments.check else _bake(arguments, size)


def _progress(done, total, name):
    """Updates a line of progress on a terminal."""
    if sys.stderr.isatty():
        print(f"\r{100 * done // max(total, 1):3d} %  {name:20}", end="\n" if done == total else "", file=sys.stderr)


def _bake(arguments, size):
    """Bakes the tables and prints their sizes and errors."""
    start = time.monotonic()
    for done, total, name in bake.bake(arguments.table, arguments.workers, size):
        _progress(done, total, name)
    seconds = time.monotonic() - start
    baked = [tables.in_use(name) for name in arguments.table or tables.TABLES]
    errors = {table.name: tables.stated_error(table.name) for table in baked}
    if arguments.json:
        print(json.dumps({"seconds": round(seconds, 2), "written": [str(table.path) for table in baked],
                          "interpolation_errors": errors, "axes": {table.name: table.told_axes() for table in baked}}))
        return
    for table in baked:
        low, high = table.span
        print(f"{table.path}: {table.columns.columns} x {table.height}, exponents {low:g} to {high:g}, "
              f"within {100.0 * errors[table.name]:.2g} % between nodes")
    print(f"baked and measured in {seconds:.1f} s")


def _fit_base_lobes(arguments):
    """Fits the bells and the base lobes, and prints the paths of their files. Raises CommandError without SciPy."""
    try:
        from ..forms import bells
        from ..forms.base_lobes import fit

        start = time.monotonic()
        for done, total in bells.fit():
            _progress(done, total, "bells")
        for done, total in fit.fit(arguments.workers):
            _progress(done, total, "base lobes")
    except ModuleNotFoundError:
        raise CommandError("fitting base lobes needs SciPy: pip install 'plausible-brdf[bake]'") from None
    print(f"{tables.folder() / bells.FILE}\n{tables.folder() / fit.FILE}\nfitted in {time.monotonic() - start:.1f} s")


def _state_weights(arguments):
    """Bakes the lobe rows of a model and prints their size and error. Raises CommandError for a wrong model."""
    model = find_model(arguments.weights)
    if not estimator.is_baked(model):
        raise CommandError(f"{model.id} has a shader of its own, and nothing to bake")
    values = settings(model, arguments.assignments)
    if arguments.drive:
        return _state_ranges(arguments, model, values)
    start = time.monotonic()
    rows = row_bake.bake(model, values)
    seconds = time.monotonic() - start
    errors = rows_error.error(model, values)
    report = {"model": model.id, "seconds": round(seconds, 2), "rows": len(rows), "numbers": rows.numbers,
              "left": float(np.median(rows.residual.share)), "theta": np.degrees(errors.theta).round(1).tolist(),
              "lobe": errors.lobe.tolist(), "albedo": errors.albedo.tolist()}
    if arguments.json:
        print(json.dumps(report))
        return
    print(f"{model.label}: {report['rows']} views, {report['numbers']} numbers, baked in {seconds:.1f} s\n"
          f"residual, for kernels: {100.0 * report['left']:.2g} % of the light at the median view\n"
          "errors between baked views, before the kernels' blur:\n  view    lobe   albedo")
    for angle, lobe, albedo in zip(report["theta"], errors.lobe, errors.albedo, strict=True):
        print(f"{angle:5.1f}° {100.0 * lobe:6.2f} % {100.0 * albedo:+6.2f} %")


def _state_ranges(arguments, model, values):
    """Bakes a model over ranges of parameters and prints the steps, the size and the error."""
    driven = dict(_driven(model, text) for text in arguments.drive)
    start = time.monotonic()
    baked = grid.bake(model, values, driven, tell=lambda done, total: _progress(done, total, model.label))
    seconds = time.monotonic() - start
    lobe, albedo = rows_error.largest(model, values, driven)
    report = {"model": model.id, "seconds": round(seconds, 2), "sets": len(baked.stored), "numbers": baked.numbers,
              "steps": {span.parameter.id: [float(np.max(span.value(i))) for i in range(span.steps)]
                        for span in baked.ranges}, "lobe": lobe, "albedo": albedo}
    if arguments.json:
        print(json.dumps(report))
        return
    for name, steps in report["steps"].items():
        print(f"{name}: {', '.join(f'{value:.4g}' for value in steps)}")
    print(f"{model.label}: {report['sets']} sets of lobe rows, {report['numbers']} numbers, baked in {seconds:.1f} s\n"
          "between views, and halfway between steps, up to 80°, before the blur of kernels: lobes within "
          f"{100.0 * lobe:.2g} %, their light within {100.0 * albedo:.2g} %")


def _driven(model, text):
    """Parses PARAMETER=FROM:TO to (parameter, (least, most)). Raises CommandError."""
    name, _, span = text.partition("=")
    try:
        least, most = map(float, span.split(":"))
    except ValueError:
        raise CommandError(f"--drive: {text!r} is not PARAMETER=FROM:TO") from None
    try:
        return name, grid.check(model.parameter(name), least, most)
    except ValueError as error:
        raise CommandError(f"--drive: {error}") from None


def _check(arguments):
    """Measures the tables' errors again and prints the verdicts. Returns the exit code, 1 where a table fails."""
    reports = []
    for done, total, name, report in bake.check(arguments.table, arguments.workers):
        _progress(done, total, name)
        if report:
            reports.append(report)
    if arguments.json:
        print(json.dumps({"tables": reports, "node_bound": bake.NODE_BOUND,
                          "interpolation_bound": bake.INTERPOLATION_BOUND}, indent=2))
    else:
        for report in reports:
            verdict = "ok" if report["ok"] else "FAILED"
            print(f"{verdict:6} {report['table']:18} " + (report.get("message") or
                  f"nodes {report['node_error']:.1e} (bound {bake.NODE_BOUND:g}), "
                  f"interpolation {report['interpolation_error']:.1e} (bound {report['interpolation_bound']:g})"))
    return 0 if all(report["ok"] for report in reports) else 1
