"""`plausible match`."""
import json
from dataclasses import asdict

import numpy as np

from ..backends.nodes import principled_fit
from ..cli import CommandError
from ..fitting import samples
from ..fitting.match import complete, match
from ..measure.specimen import settings
from ..models import MODELS, find_model

DESCRIPTION = ("Find the parameters with which a model's lobe is as wide as another's: seen along the normal, the "
               "normalized BRDF falls to half at the same angle of the half vector (Sawicki, Modeling the metallic "
               "reflection using appropriate BRDF model), along and across the tangent where the lobe is stretched. "
               "With --native, find the inputs of Blender's Principled BSDF that come nearest to a model, or to each "
               "model at its defaults, and their errors in % of the model's light: of the lobe, under a sun, and of "
               "the albedo, under a white sky, each a mean over views at 0, 30 and 60 degrees.")
VIEWS = (0.0, 45.0, 75.0)  # degrees from the normal, where both lobes are compared


def add_arguments(parser):
    parser.add_argument("--from", metavar="MODEL", dest="source", help="the model to match")
    parser.add_argument("--to", metavar="MODEL", dest="target", help="the model to find parameters for")
    parser.add_argument("--native", action="store_true", help="find inputs of Blender's Principled BSDF instead, for "
                        "the model of --from or for every model")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="a parameter of the --from model, as in `plausible furnace`; may be repeated")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    if arguments.native:
        _native(arguments)
        return
    if not (arguments.source and arguments.target):
        raise CommandError("name the models with --from and --to, or one with --from and --native")
    source, target = find_model(arguments.source), find_model(arguments.target)
    parameters = settings(source, arguments.assignments)
    found = match(source.id, parameters, target.id)
    seen = samples.of_model(source, complete(source, parameters), VIEWS, samples.knows_tangent(target))
    # The larger distance of the views along the tangent and, for stretched lobes, of those across it.
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


def _native(arguments):
    """Prints the inputs of the Principled BSDF for one model or all. Raises CommandError for wrong arguments."""
    if arguments.target:
        raise CommandError(f"--to {arguments.target} and --native cannot both be given")
    if arguments.assignments and not arguments.source:
        raise CommandError("--set needs the model that it is for: name it with --from")
    models = [find_model(arguments.source)] if arguments.source else list(MODELS.values())
    fits = [(model, principled_fit.fit(model, settings(model, arguments.assignments))) for model in models]
    if arguments.json:
        print(json.dumps([{"model": model.id, **asdict(inputs)} for model, inputs in fits], indent=2))
        return
    print(f"{'model':25}{'base color':>20}{'metallic':>10}{'roughness':>11}{'IOR':>6}{'aniso.':>8}{'turn':>6}"
          f"{'lobe':>9}{'albedo':>9}")
    for model, inputs in fits:
        color = ", ".join(f"{c:.2f}" for c in inputs.base_color)
        print(f"{model.id:25}{color:>20}{inputs.metallic:10.2f}{inputs.roughness:11.3f}{inputs.ior:6.2f}"
              f"{inputs.anisotropic:8.2f}{inputs.rotation:6.2f}{inputs.lobe_error:7.1f} %{inputs.albedo_error:7.1f} %")


def print_parameters(model, values):
    """Prints a line for each parameter in `values`, in the form of `--set`."""
    for parameter in model.parameters:
        if parameter.id in values:
            print(f"  {parameter.id}={shown(parameter, values[parameter.id])}")


def shown(parameter, value) -> str:
    """A value in the form of `--set`, numbers to six digits."""
    if parameter.kind == "enum":
        return parameter.items[value][0]
    if parameter.kind == "bool":
        return str(value).lower()
    if parameter.kind == "image":
        return value
    return ",".join(f"{number:.6g}" for number in np.atleast_1d(value))


def angles(pair) -> str:
    """Half-angles (degrees) along and across the tangent as text; one angle where both are equal."""
    words = [f"{angle:.4g}°" if np.isfinite(angle) else "none" for angle in pair]
    return words[0] if words[0] == words[1] else f"{words[0]} along and {words[1]} across the tangent"


def finite(numbers):
    """Numbers for JSON: None in place of each infinite number."""
    return [number if np.isfinite(number) else None for number in numbers]
