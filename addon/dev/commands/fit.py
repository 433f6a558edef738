"""`plausible fit`."""
import json
import sys
from pathlib import Path

from ...cli import CommandError, require
from ...commands.match import print_parameters
from ...fitting import fit, samples
from ...measure.specimen import settings
from ...models import find_model
from .figures import write

DESCRIPTION = ("Find the parameters with which a model comes nearest to another model or to measured data: the largest "
               "relative error of f (N·L) and of the albedo together is least (perceptual fitting, Neumann, Neumann, "
               "Szirmay-Kalos). Errors are relative to the smaller of both values, for f (N·L) plus --floor times its "
               "peak at that view: 100 % is twice or half as much.")


def add_arguments(parser):
    parser.add_argument("model", metavar="MODEL", help="the model to find parameters for")
    target = parser.add_mutually_exclusive_group(required=True)
    target.add_argument("--to", metavar="MODEL", dest="target", help="the model to match")
    target.add_argument("--table", type=Path, metavar="FILE.csv",
                        help="the data to match: columns theta_view, theta_light, phi (degrees; phi is 180 on the "
                             "mirror's side) and f or f_r, f_g, f_b (1/sr), named in a header line; # begins a comment")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="parameters of the --to model, as in `plausible furnace`; may be repeated")
    parser.add_argument("--with", action="append", default=[], metavar="PARAMETER=VALUE", dest="own",
                        help="parameters of MODEL itself to begin with; may be repeated")
    parser.add_argument("--free", nargs="+", metavar="PARAMETER",
                        help="parameters to fit (default: all numbers but wavelength, scattering and rotation, and the "
                             "base color; colors stay gray where the target is)")
    parser.add_argument("--views", type=float, nargs="+", metavar="DEG",
                        help="view angles from the normal, 0 to 85, of the --to model (default: 0 to 60 by tens)")
    parser.add_argument("--floor", type=float, default=samples.FLOOR, metavar="PART",
                        help="part of the peak that is added to values before they are compared (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--output", type=Path, metavar="DIR", help="draw lobes and albedo there, as PNG and SVG")


def run(arguments):
    _check(arguments)
    model = find_model(arguments.model)
    given = {"own": settings(model, arguments.own), "free": arguments.free, "floor": arguments.floor,
             "progress": _progress()}
    try:
        if arguments.table is not None:
            found = fit.to_table(model.id, arguments.table, **given)
        else:
            target = find_model(arguments.target)
            parameters = settings(target, arguments.assignments)
            found = fit.to_model(model.id, target.id, parameters, arguments.views or samples.VIEWS, **given)
    finally:
        if sys.stderr.isatty():
            print(file=sys.stderr)
    files = _draw(arguments, found) if arguments.output else []
    if arguments.json:
        print(json.dumps({**_report(arguments, found), "files": [str(path) for path in files]}, indent=2))
    else:
        _print(arguments, found, files)


def _check(arguments):
    """Raises CommandError for wrong arguments, before a search of some seconds."""
    for name, given in (("--set", arguments.assignments), ("--views", arguments.views)):
        if arguments.table is not None and given:
            raise CommandError(f"{name} goes with --to, not with --table")
    require("scipy", "bake")
    if arguments.output is not None:
        require("matplotlib", "demo")
        arguments.output.mkdir(parents=True, exist_ok=True)


def _progress():
    """A function (largest error) that updates one line on a terminal; None elsewhere."""
    if not sys.stderr.isatty():
        return None
    return lambda error: print(f"\rfit: largest error {percent(error):12}", end="", file=sys.stderr, flush=True)


def percent(error) -> str:
    """A relative error as text."""
    if error is None:
        return "unknown"
    return f"{100.0 * error:.3g} %" if error >= 1e-5 else "< 0.001 %"


def _draw(arguments, found):
    from ..figures import fit as figures

    name = f"fit_{found.model.id}_to_{arguments.target or arguments.table.stem}"
    return list(write(figures.draw(found, title(arguments, found)), arguments.output, name))


def title(arguments, found) -> str:
    """The figure's title: the model and its target."""
    return f"{found.model.label} fitted to {found.target[0].label if found.target else arguments.table.name}"


def _report(arguments, found):
    def both(errors):
        return errors and dict(zip(("f_cosine", "albedo"), errors, strict=True))

    return {
        "model": found.model.id, "target": arguments.target or str(arguments.table), "free": found.free,
        "target_parameters": found.target and found.target[1], "floor": arguments.floor,
        "matched": {"parameters": found.start, "largest_relative_error": both(found.start_errors),
                    "between": both(found.start_between)},
        "fitted": {"parameters": found.parameters, "largest_relative_error": both(found.errors),
                   "between": both(found.between)},
    }


def _print(arguments, found, files):
    print(title(arguments, found))
    print_parameters(found.model, found.parameters)
    print("largest relative error   f (N·L)      albedo")
    rows = [("matched by width", found.start_errors), ("fitted", found.errors)]
    if found.between:
        rows.append(("fitted, at other views", found.between))
    for label, errors in rows:
        print(f"  {label:22} {percent(errors[0]):12} {percent(errors[1])}")
    for path in files:
        print(path)
