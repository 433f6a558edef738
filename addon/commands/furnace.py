"""`plausible furnace`, and the functions that it shares with `plausible goniometer`."""
import json
import sys

import numpy as np

from .. import measure
from ..cli import CommandError
from ..measure import plots, specimen
from ..models.channels import rgb

DESCRIPTION = ("Render a material under a white sky and compare its albedo with the formula. Exit code 1 where they "
               "differ by more than the tolerance plus five standard errors.")
ANGLES = (0.0, 20.0, 40.0, 60.0, 70.0, 80.0, 85.0)  # of the view, degrees


def add_arguments(parser):
    add_subject(parser)
    parser.add_argument("--angles", type=float, nargs="+", metavar="DEG", default=list(ANGLES),
                        help="view angles from the normal, 0 to 89 (default: %(default)s)")
    add_measuring(parser, samples=1024)
    parser.add_argument("--tolerance", type=float, default=2e-3, metavar="ALBEDO",
                        help="allowed error of the albedo, in addition to the noise (default: %(default)s)")


def run(arguments):
    subject = find_subject(arguments)
    angles = np.array(arguments.angles)
    measured, noise = measure.furnace(subject.material, angles, arguments.samples, arguments.resolution, arguments.seed,
                                     progress("furnace", arguments.progress))
    # Only a material with a formula has a reference.
    comparison = curve = None
    if subject.model is not None:
        reference = subject.albedo(np.cos(np.radians(angles)))
        comparison = measure.compare(measured, reference, noise, arguments.tolerance)
        fine = np.linspace(0.0, 89.5, 180)
        curve = fine, rgb(subject.albedo(np.cos(np.radians(fine))))
    if arguments.output:
        plots.furnace(arguments.output, f"White furnace: {subject.title}", angles, measured, noise, comparison, curve)
    if arguments.json:
        print(json.dumps(_report(arguments, subject, angles, measured, noise, comparison), indent=2))
    else:
        _print(subject, angles, measured, noise, comparison)
    return exit_code(comparison)


def _report(arguments, subject, angles, measured, noise, comparison):
    rows = [{"angle_deg": float(angle), "measured": m.tolist(), "noise": s.tolist()}
            for angle, m, s in zip(angles, measured, noise, strict=True)]
    add_verdicts(rows, comparison)
    return {**describe(arguments, subject), "quantity": "albedo", "tolerance": arguments.tolerance, "rows": rows,
            **summary(comparison)}


def _print(subject, angles, measured, noise, comparison):
    print(f"{subject.title}\nangle   albedo                    noise    " + ("error     verdict" if comparison else ""))
    words = comparison.verdicts() if comparison else [""] * len(angles)
    for i, angle in enumerate(angles):
        error = f"{largest(comparison.error[i]):+9.1e} {words[i]}" if comparison else ""
        print(f"{angle:5.1f}°  {triple(measured[i]):25} {noise[i].max():7.1e} {error}")


# Shared by the commands of both instruments.

def add_subject(parser):
    """Adds the arguments that name the material to measure."""
    parser.add_argument("model", nargs="?", metavar="MODEL", help="a model, see `plausible list`")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="a number, true or false, a choice's name or r,g,b; may be repeated")
    parser.add_argument("--blend", metavar="FILE", help="measure a material of this .blend file instead of a model")
    parser.add_argument("--material", metavar="NAME", help="name of the material in the file")


def add_measuring(parser, samples):
    """Adds the arguments of the render and of the results."""
    parser.add_argument("--samples", type=int, default=samples, metavar="N",
                        help="samples per pixel (default: %(default)s)")
    parser.add_argument("--resolution", type=int, default=16, metavar="N",
                        help="pixels across; each is an independent measurement (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the noise (default: %(default)s)")
    parser.add_argument("--output", metavar="FILE.png", help="write a plot")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--progress", action="store_true",
                        help="print the progress to standard error in lines, even if that is no terminal")


def find_subject(arguments) -> specimen.Specimen:
    """The material that the arguments name. Raises CommandError, one line, for wrong arguments."""
    from_file = arguments.blend is not None or arguments.material is not None
    if from_file == (arguments.model is not None):
        raise CommandError("give either a MODEL or both --blend FILE and --material NAME")
    if from_file and (arguments.blend is None or arguments.material is None):
        raise CommandError("--blend FILE and --material NAME go together")
    if from_file and arguments.assignments:
        raise CommandError("--set goes with a MODEL, not with a material of a file")
    if not arguments.tolerance > 0.0:
        raise CommandError(f"--tolerance: {arguments.tolerance} is not a positive number")
    # A wrong output path fails before minutes of rendering.
    try:
        if arguments.output:
            plots.check(arguments.output)
        if from_file:
            return specimen.of_file(arguments.blend, arguments.material)
        return specimen.of_model(arguments.model, arguments.assignments)
    except (ValueError, OSError) as error:
        raise CommandError(str(error)) from error


def progress(name, always=False, what="render"):
    """A function (done, total) that reports progress on standard error, counting in `what`.

    On a terminal it updates one line. Elsewhere it prints nothing, or, with `always`, a line at each call.
    """
    def show(done, total):
        if always:
            print(f"{name}: {what} {done} of {total}", file=sys.stderr, flush=True)
        elif sys.stderr.isatty():
            print(f"\r{name}: {what} {done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)

    return show


def describe(arguments, subject) -> dict:
    """The head of a JSON report: the material, Blender, and the settings of the render."""
    import bpy

    return {"subject": subject.title, "model": subject.model.id if subject.model else None,
            "parameters": subject.parameters, "blender": bpy.app.version_string, "samples": arguments.samples,
            "resolution": arguments.resolution, "seed": arguments.seed}


def add_verdicts(rows, comparison):
    """Adds reference, error and verdict to the JSON `rows` where there is a `comparison`."""
    if comparison is not None:
        columns = zip(rows, comparison.reference, comparison.error, comparison.verdicts(), strict=True)
        for row, reference, error, word in columns:
            row.update(reference=reference.tolist(), error=error.tolist(), verdict=word)


def summary(*comparisons) -> dict:
    """The foot of a JSON report: largest error and worst verdict, None where no comparison exists."""
    known = [c for c in comparisons if c is not None]
    if not known:
        return {"largest_error": None, "verdict": None}
    words = [c.verdict for c in known]
    worst = next(word for word in (measure.comparison.FAILED, measure.comparison.NOISY, measure.comparison.OK)
                 if word in words)
    return {"largest_error": max(c.largest for c in known), "verdict": worst}


def exit_code(*comparisons) -> int:
    """0 where every existing comparison is OK, else 1."""
    return 0 if summary(*comparisons)["verdict"] in (None, measure.comparison.OK) else 1


def largest(channels) -> float:
    """The channel of the largest absolute value, with its sign."""
    return float(channels[np.abs(channels).argmax()])


def triple(channels) -> str:
    """RGB as text: one number where all channels are equal."""
    distinct = channels[:1] if np.ptp(channels) < 1e-7 else channels
    return " ".join(f"{value:.5f}" for value in distinct)
