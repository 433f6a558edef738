"""`plausible chi2`."""
import json

import numpy as np

from ... import models
from ...cli import CommandError
from ...measure import plots
from ...measure.specimen import settings
from ...statistics import chi_square

DESCRIPTION = ("Draw light directions with a model's sampler and compare their counts, cell by cell of the sphere, "
               "with the model's density: Pearson's chi-square test. Exit code 1 where the p value is below the "
               "significance.")


def add_arguments(parser):
    parser.add_argument("model", metavar="MODEL", help="a model, see `plausible list`")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="a number, true or false, a choice's name or r,g,b; may be repeated")
    parser.add_argument("--view", type=float, default=45.0, metavar="DEG",
                        help="view angle from the normal, 0 to 90 (default: %(default)s)")
    parser.add_argument("--azimuth", type=float, default=0.0, metavar="DEG",
                        help="view's azimuth from the tangent (default: %(default)s)")
    parser.add_argument("--samples", type=int, default=1_000_000, metavar="N",
                        help="directions that are counted (default: %(default)s)")
    parser.add_argument("--cells", type=int, nargs=2, default=[200, 100], metavar="N",
                        help="cells over azimuth and over cosine (default: 200 100)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the draws (default: %(default)s)")
    parser.add_argument("--significance", type=float, default=0.01, metavar="P",
                        help="p value below which the test fails (default: %(default)s)")
    parser.add_argument("--output", metavar="FILE.png", help="write a picture of both densities")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    model = models.find_model(arguments.model)
    parameters = settings(model, arguments.assignments)
    _check(arguments)
    polar, azimuth = np.radians([arguments.view, arguments.azimuth])
    view = [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
    result = chi_square.of_model(model, parameters, view, arguments.samples, arguments.seed, arguments.cells)
    passes = result.p_value >= arguments.significance
    title = ", ".join([model.label, f"{arguments.view:g}°", *(t.replace("=", " = ") for t in arguments.assignments)])
    if arguments.output:
        result.draw(arguments.output, title)
    if arguments.json:
        print(json.dumps({
            "model": model.id, "parameters": parameters, "view_deg": arguments.view, "azimuth_deg": arguments.azimuth,
            "samples": arguments.samples, "seed": arguments.seed, "cells": list(result.counts.shape),
            "p_value": result.p_value, "fine": result.fine._asdict(), "coarse": result.coarse._asdict(),
            "integral": result.integral, "strays": result.strays, "undrawn": list(result.undrawn), "passes": passes,
        }, indent=2))
    else:
        _print(title, result, passes)
    return 0 if passes else 1


def _check(arguments):
    """Raises CommandError or ValueError for arguments out of range."""
    if not 0.0 <= arguments.view <= 90.0:
        raise CommandError(f"--view: {arguments.view:g} is outside 0 .. 90")
    if not np.isfinite(arguments.azimuth):
        raise CommandError(f"--azimuth: {arguments.azimuth:g} is no angle")
    if arguments.seed < 0:
        raise CommandError(f"--seed: {arguments.seed} is not 0 or more")
    if not 0.0 < arguments.significance < 1.0:
        raise CommandError(f"--significance: {arguments.significance:g} is outside 0 .. 1")
    if arguments.output:
        plots.check(arguments.output)


def _print(title, result, passes):
    drawn = int(result.counts.sum() + result.undrawn[0])
    print(f"{title}: {drawn} directions in {' x '.join(map(str, result.counts.shape))} cells")
    for name, test in (("fine", result.fine), ("coarse", result.coarse)):
        print(f"{name:7} chi-square {test.statistic:9.1f}, {test.degrees:5d} degrees of freedom, p {test.p_value:.4g}")
    print(f"the density's integral over the sphere is {result.integral:.6f}; nothing was drawn "
          f"{result.undrawn[0]:.0f} times; where the density is 0, {result.strays} times")
    print(f"p value {result.p_value:.4g}: {'ok' if passes else 'FAILED'}")
