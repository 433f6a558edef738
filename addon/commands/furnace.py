"""`plausible furnace`."""
import json
import sys

import numpy as np

from .. import measure
from ..cli import CommandError
from ..measure import plots, specimen
from ..models.channels import rgb

DESCRIPTION = ("Render a material under a white sky and compare its albedo with the formula. Exit code 1 where they "
               "differ by more than the tolerance and five standard errors.")
ANGLES = (0.0, 20.0, 40.0, 60.0, 70.0, 80.0, 85.0)


def add_arguments(parser):
    add_subject(parser)
    parser.add_argument("--angles", type=float, nargs="+", metavar="DEG", default=list(ANGLES),
                        help="view angles from the normal, 0 to 89 (default: %(default)s)")
    add_measuring(parser, samples=1024)
    parser.add_argument("--tolerance", type=float, default=2e-3, metavar="ALBEDO",
                        help="allowed error of the albedo beside the noise (default: %(default)s)")


def run(arguments):
    thing = find_subject(arguments)
    angles = np.array(arguments.angles)
    measured, noise = measure.furnace(thing.material, angles, arguments.samples, arguments.resolution, arguments.seed,
                                     progress("furnace", arguments.progress))
    comparison = curve = None
    if thing.model is not None:
        reference = thing.albedo(np.cos(np.radians(angles)))
        comparison = measure.compare(measured, reference, noise, arguments.tolerance)
        fine = np.linspace(0.0, 89.5, 180)
        curve = fine, rgb(thing.albedo(np.cos(np.radians(fine))))
    if arguments.output:
        plots.furnace(arguments.output, f"White furnace: {thing.title}", angles, measured, noise, comparison, curve)
    if arguments.json:
        print(json.dumps(_report(arguments, thing, angles, measured, noise, comparison), indent=2))
    else:
        _print(thing, angles, measured, noise, comparison)
    return exit_code(comparison)


def _report(arguments, thing, angles, measured, noise, comparison):
    rows = [{"angle_deg": float(angle), "measured": m.tolist(), "noise": s.tolist()}
            for angle, m, s in zip(angles, measured, noise, strict=True)]
    add_verdicts(rows, comparison)
    return {**describe(arguments, thing), "quantity": "albedo", "tolerance": arguments.tolerance, "rows": rows,
            **summary(comparison)}


def _print(thing, angles, measured, noise, comparison):
    print(f"{thing.title}\nangle   albedo                    noise    " + ("error     verdict" if comparison else ""))
    words = comparison.verdicts() if comparison else [""] * len(angles)
    for i, angle in enumerate(angles):
        error = f"{largest(comparison.error[i]):+9.1e} {words[i]}" if comparison else ""
        print(f"{angle:5.1f}°  {triple(measured[i]):25} {noise[i].max():7.1e} {error}")


# What both instruments' commands share.

def add_subject(parser):
    """Arguments that say what is measured."""
    parser.add_argument("model", nargs="?", metavar="MODEL", help="a model, see `plausible list`")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="a number, true or false, a choice's name or r,g,b; may be repeated")
    parser.add_argument("--blend", metavar="FILE", help="measure a material of this .blend file instead of a model")
    parser.add_argument("--material", metavar="NAME", help="name of the material in the file")


def add_measuring(parser, samples):
    """Arguments that say how it is measured and where results go."""
    parser.add_argument("--samples", type=int, default=samples, metavar="N",
                        help="samples per pixel (default: %(default)s)")
    parser.add_argument("--resolution", type=int, default=16, metavar="N",
                        help="pixels across; each is a measurement of its own (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the noise (default: %(default)s)")
    parser.add_argument("--output", metavar="FILE.png", help="write a plot")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--progress", action="store_true",
                        help="tell on standard error how far it is, in lines, also where that is no terminal")


def find_subject(arguments) -> specimen.Specimen:
    """The material that the arguments name. Raises CommandError in one line for what is wrong with them."""
    from_file = arguments.blend is not None or arguments.material is not None
    if from_file == (arguments.model is not None):
        raise CommandError("give either a MODEL or both --blend FILE and --material NAME")
    if from_file and (arguments.blend is None or arguments.material is None):
        raise CommandError("--blend FILE and --material NAME go together")
    if from_file and arguments.assignments:
        raise CommandError("--set goes with a MODEL, not with a material of a file")
    if not arguments.tolerance > 0.0:
        raise CommandError(f"--tolerance: {arguments.tolerance} is not a positive number")
    try:
        if arguments.output:
            plots.check(arguments.output)
        if from_file:
            return specimen.of_file(arguments.blend, arguments.material)
        return specimen.of_model(arguments.model, arguments.assignments)
    except (ValueError, OSError) as error:
        raise CommandError(str(error)) from error


def progress(name, always=False, what="render"):
    """A function (done, total) that keeps one line on a terminal up to date; elsewhere it says nothing, or, where
    `always` is set, a line each time. `what` is what is counted."""
    def show(done, total):
        if always:
            print(f"{name}: {what} {done} of {total}", file=sys.stderr, flush=True)
        elif sys.stderr.isatty():
            print(f"\r{name}: {what} {done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)

    return show


def describe(arguments, thing) -> dict:
    """The head of a JSON report: what was measured with what."""
    import bpy

    return {"subject": thing.title, "model": thing.model.id if thing.model else None,
            "parameters": thing.parameters, "blender": bpy.app.version_string, "samples": arguments.samples,
            "resolution": arguments.resolution, "seed": arguments.seed}


def add_verdicts(rows, comparison):
    """Add reference, error and verdict to the JSON `rows` where there is a `comparison`."""
    if comparison is not None:
        columns = zip(rows, comparison.reference, comparison.error, comparison.verdicts(), strict=True)
        for row, reference, error, word in columns:
            row.update(reference=reference.tolist(), error=error.tolist(), verdict=word)


def summary(*comparisons) -> dict:
    """The foot of a JSON report."""
    known = [c for c in comparisons if c is not None]
    if not known:
        return {"largest_error": None, "verdict": None}
    words = [c.verdict for c in known]
    worst = next(word for word in (measure.comparison.FAILED, measure.comparison.NOISY, measure.comparison.OK)
                 if word in words)
    return {"largest_error": max(c.largest for c in known), "verdict": worst}


def exit_code(*comparisons) -> int:
    """0 where every comparison there is went well, else 1."""
    return 0 if summary(*comparisons)["verdict"] in (None, measure.comparison.OK) else 1


def largest(channels) -> float:
    """The channel that is largest in size, with its sign."""
    return float(channels[np.abs(channels).argmax()])


def triple(channels) -> str:
    """RGB as text: one number where all are the same."""
    distinct = channels[:1] if np.ptp(channels) < 1e-7 else channels
    return " ".join(f"{value:.5f}" for value in distinct)
