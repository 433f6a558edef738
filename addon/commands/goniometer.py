"""`plausible goniometer`."""
import json

import numpy as np

from .. import measure
from ..measure import plots
from ..models.channels import rgb
from ..models.geometry import view_at
from . import furnace

DESCRIPTION = ("Render a material under a sun of no size, light by light, and compare the lobe with the formula. Exit "
               "code 1 where they differ by more than the tolerance plus five standard errors.")
VIEWS = (0.0, 40.0, 60.0, 80.0)  # degrees from the normal
LIMIT = 85.0  # degrees from the normal: the lowest sun


def add_arguments(parser):
    furnace.add_subject(parser)
    parser.add_argument("--view", type=float, nargs="+", metavar="DEG", default=list(VIEWS),
                        help="view angles from the normal, 0 to 89 (default: %(default)s)")
    parser.add_argument("--angles", type=float, nargs="+", metavar="DEG",
                        help="light angles from -85 to 85: in the plane of incidence from the normal, positive on the "
                             "mirror's side; off the plane from the mirror direction (default: 31 over the lobe)")
    furnace.add_measuring(parser, samples=64)
    parser.add_argument("--tolerance", type=float, default=0.02, metavar="PART",
                        help="allowed error of f (N·L), in addition to the noise, in parts of its peak "
                             "(default: %(default)s)")


def run(arguments):
    if arguments.angles is not None and max(map(abs, arguments.angles)) > LIMIT:
        raise furnace.CommandError(f"--angles: the light angles go from -{LIMIT:g} to {LIMIT:g} degrees")
    subject = furnace.find_subject(arguments)
    # A sweep in the plane of incidence and one across it, for each view.
    plans = [(view, plane) for view in arguments.view for plane in ("incidence", "across")]
    sweeps = [_sweep(arguments, subject, view, plane, f"sweep {i + 1} of {len(plans)}, view at {view:g}°")
              for i, (view, plane) in enumerate(plans)]
    if arguments.output:
        plots.goniometer(arguments.output, f"Goniometer: {subject.title}", sweeps)
    comparisons = [sweep["comparison"] for sweep in sweeps]
    if arguments.json:
        print(json.dumps({
            **furnace.describe(arguments, subject), "quantity": "f(V, L)(N·L) [1/sr]", "tolerance": arguments.tolerance,
            "sweeps": [_report(sweep) for sweep in sweeps], "verdict": furnace.summary(*comparisons)["verdict"],
            "largest_error_of_peak": max((s["worst"] for s in sweeps if s["comparison"]), default=None),
        }, indent=2))
    else:
        _print(subject, sweeps)
    return furnace.exit_code(*comparisons)


def _lights(view, plane, angles):
    """Unit lights (N, 3) at `angles` (N,) along the arc of a sweep."""
    return measure.in_plane(angles) if plane == "incidence" else measure.across_lobe(view, angles)


def _theory(subject, view, plane, angles):
    """The formula's f (N·L), (N, 3)."""
    lights = _lights(view, plane, angles)
    return rgb(subject.evaluate(view_at(np.cos(np.radians(view))), lights)) * lights[:, 2:]


def _spread(subject, view, plane):
    """31 light angles: where the lobe exceeds 0.3 % of its peak, or over all angles where no formula is known."""
    if subject.model is None:
        return np.linspace(-LIMIT, LIMIT, 31)
    fine = np.linspace(-LIMIT, LIMIT, 6801)
    value = _theory(subject, view, plane, fine).max(axis=1)
    lit = fine[value > 0.003 * value.max()]
    margin = 0.1 * (lit.max() - lit.min()) + 0.2
    return np.linspace(max(lit.min() - margin, -LIMIT), min(lit.max() + margin, LIMIT), 31)


def _sweep(arguments, subject, view, plane, label):
    """Measures the lobe along one arc of lights; returns a sweep for `plots.goniometer`. All values are f (N·L)."""
    angles = _spread(subject, view, plane) if arguments.angles is None else np.array(arguments.angles)
    lights = _lights(view, plane, angles)
    f, noise = measure.goniometer(subject.material, view, lights, arguments.samples, arguments.resolution,
                                 arguments.seed, furnace.progress(label, arguments.progress))
    measured, noise = f * lights[:, 2:], noise * lights[:, 2:]
    sweep = {"view_deg": view, "plane": plane, "angles_deg": angles, "lights": lights, "measured": measured,
             "noise": noise, "curve": None, "comparison": None}
    if subject.model is not None:
        fine = np.linspace(angles.min(), angles.max(), 721)
        curve, reference = (_theory(subject, view, plane, a) for a in (fine, angles))
        # The tolerance is a part of the whole lobe's peak, so that rows of a faint flank do not fail by tiny errors.
        peak = float(max(curve.max(), reference.max(), 1e-12))
        comparison = measure.compare(measured, reference, noise, arguments.tolerance * peak)
        sweep.update(curve=(fine, curve), peak=peak, comparison=comparison, worst=comparison.largest / peak)
    return sweep


def _report(sweep):
    rows = [{"angle_deg": float(angle), "light": light.tolist(), "measured": m.tolist(), "noise": s.tolist()}
            for angle, light, m, s in zip(sweep["angles_deg"], sweep["lights"], sweep["measured"], sweep["noise"],
                                          strict=True)]
    furnace.add_verdicts(rows, sweep["comparison"])
    return {"view_deg": sweep["view_deg"], "plane": sweep["plane"], "peak": sweep.get("peak"), "rows": rows,
            **furnace.summary(sweep["comparison"])}


def _print(subject, sweeps):
    print(f"{subject.title}: f (N·L) in 1/sr")
    for sweep in sweeps:
        comparison = sweep["comparison"]
        head = f"view {sweep['view_deg']:4.1f}°, {sweep['plane']:9}"
        if comparison is None:
            print(head)
            for angle, value, noise in zip(sweep["angles_deg"], sweep["measured"], sweep["noise"], strict=True):
                print(f"  light {angle:6.1f}°  {furnace.triple(value):25} noise {noise.max():.1e}")
        else:
            print(f"{head}  peak {sweep['peak']:9.4f}  largest error {100.0 * sweep['worst']:7.3f} % of it, "
                  f"noise {100.0 * sweep['noise'].max() / sweep['peak']:6.3f} %  {comparison.verdict}")
