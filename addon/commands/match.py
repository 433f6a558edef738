"""`plausible match`."""
import json

import numpy as np

from ..brdf import find_model
from ..fitting import samples
from ..fitting.match import complete, match
from ..verify.subject import settings

DESCRIPTION = ("Find the parameters with which a model's lobe is as wide as another's: seen along the normal, the "
               "normalised BRDF falls to half at the same angle of the half vector (Sawicki, Modeling the metallic "
               "reflection using appropriate BRDF model), along and across the tangent where the lobe is stretched.")
VIEWS = (0.0, 45.0, 75.0)  # degrees


def add_arguments(parser):
    parser.add_argument("--from", required=True, metavar="MODEL", dest="source", help="the model to be like")
    parser.add_argument("--to", required=True, metavar="MODEL", dest="target", help="the model to find parameters for")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="parameters of the first, as in `plausible furnace`; may be repeated")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    source, target = find_model(arguments.source), find_model(arguments.target)
    given = settings(source, arguments.assignments)
    found = match(source.id, given, target.id)
    seen = samples.of_model(source, complete(source, given), VIEWS, samples.knows_tangent(target))
    # One row of views along the tangent, and perhaps one across it.
    distances = samples.apart(seen, target, found.parameters).reshape(-1, len(VIEWS)).max(axis=0)
    if arguments.json:
        print(json.dumps({
            "source": found.source, "target": found.target, "parameters": found.parameters,
            "half_angles_deg": {"source": finite(found.wanted), "target": finite(found.half_angles)},
            "dropped": found.dropped, "held": found.held,
            "largest_difference_of_peak": [{"view_deg": view, "difference": float(d)}
                                           for view, d in zip(VIEWS, distances, strict=True)]}, indent=2))
        return
    print(f"{target.label} as wide as {source.label}")
    print_parameters(target, found.parameters)
    print(f"half-angle of {found.source}: {angles(found.wanted)}, of {found.target}: {angles(found.half_angles)}")
    for view, distance in zip(VIEWS, distances, strict=True):
        print(f"seen from {view:2.0f}°: f (N·L) differs by up to {100.0 * distance:.3g} % of the peak")
    if found.dropped:
        print(f"{found.target} has no {', '.join(found.dropped)}")
    if found.held:
        print(f"at the end of its range: {', '.join(found.held)}")


def print_parameters(model, values):
    """A line for each parameter, as `--set` takes it."""
    for parameter in model.parameters:
        if parameter.id in values:
            print(f"  {parameter.id}={shown(parameter, values[parameter.id])}")


def shown(parameter, value) -> str:
    """A value as `--set` takes it, numbers to six digits."""
    if parameter.kind == "enum":
        return parameter.items[value][0]
    if parameter.kind == "bool":
        return str(value).lower()
    if parameter.kind == "image":
        return value
    return ",".join(f"{number:.6g}" for number in np.atleast_1d(value))


def angles(pair) -> str:
    """Half-angles (degrees) along and across the tangent, one where both are the same."""
    words = [f"{angle:.4g}°" if np.isfinite(angle) else "none" for angle in pair]
    return words[0] if words[0] == words[1] else f"{words[0]} along and {words[1]} across the tangent"


def finite(numbers):
    """Numbers for JSON, None for those that are infinite."""
    return [number if np.isfinite(number) else None for number in numbers]
