"""`plausible portable`."""
import json
from pathlib import Path

from ...cli import CommandError
from ...portability import portable

DESCRIPTION = ("Copy a .blend, and nothing else, to an empty read-only folder, render it small in a separate Blender "
               "that has an empty user profile and no extension, and compare that pixel by pixel with the file as it "
               "renders in its place. Prints what would be missing elsewhere. Pictures are rendered on the CPU, "
               "without denoising, adaptive sampling or compositing. Exit code 1 where a picture differs, a Blender "
               "cannot render it, something would be missing, or another version's picture is far from the first's.")


def add_arguments(parser):
    parser.add_argument("blend", metavar="FILE.blend", help="the file; its active scene is rendered")
    parser.add_argument("--frame", type=int, metavar="N", help="the frame (default: the file's current frame)")
    parser.add_argument("--blender", nargs="+", metavar="PATH", action="extend",
                        help="a Blender executable, or a Python that has bpy, of any version; each of several renders "
                        "the file in both places, and is compared with the first (default: this Python)")
    parser.add_argument("--size", type=int, default=96, metavar="N",
                        help="pixels of the picture's longer side (default: %(default)s)")
    parser.add_argument("--samples", type=int, default=8, metavar="N",
                        help="samples per pixel (default: %(default)s)")
    parser.add_argument("--tolerance", type=float, default=0.05, metavar="PART",
                        help="how far another version's picture may be from the first's: the mean difference of "
                        "squares of 8 x 8 pixels, in parts of the mean color (default: %(default)s)")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    if not Path(arguments.blend).is_file():
        raise CommandError(f"no file {arguments.blend}")
    blenders = arguments.blender or [portable.own_blender()]
    probes = [portable.travel(arguments.blend, blender, arguments.frame, arguments.size, arguments.samples)
                for blender in blenders]
    findings = list(dict.fromkeys(finding for probe in probes for finding in probe.findings))
    alike = all(_is_near(portable.difference(probes[0].in_place, probe.alone), arguments.tolerance)
                for probe in probes if not probe.error and not probes[0].error)
    good = alike and all(j.identical and not j.written for j in probes) and not any(f.grave for f in findings)
    if arguments.json:
        print(json.dumps(_report(arguments, probes, findings, good), indent=2))
    else:
        _print(arguments, probes, findings)
    return 0 if good else 1


def _is_near(apart, tolerance):
    return apart is not None and apart.coarse <= tolerance


def _report(arguments, probes, findings, good):
    return {"file": arguments.blend, "bytes": Path(arguments.blend).stat().st_size, "samples": arguments.samples,
            "portable": good, "journeys": [_journey(probe, probes[0]) for probe in probes],
            "findings": [vars(finding) for finding in findings]}


def _journey(probe, first):
    entry = {"blender": probe.blender, "version": probe.version, "error": probe.error or None}
    if probe.error:
        return entry
    apart = portable.difference(probe.in_place, probe.alone)
    from_first = None if first.error or first is probe else portable.difference(first.in_place, probe.alone)
    return {**entry, "scene": probe.scene, "frame": probe.frame, "size": list(probe.alone.shape[1::-1]),
            "identical": probe.identical, "difference": _numbers(apart), "written_beside": probe.written,
            "difference_from_first": _numbers(from_first)}


def _numbers(difference):
    return None if difference is None else vars(difference)


def _print(arguments, probes, findings):
    size = Path(arguments.blend).stat().st_size / 1e6
    print(f"{arguments.blend}: {size:.2f} MB, {arguments.samples} samples")
    for probe in probes:
        print(f"Blender {probe.version or probe.blender}: {_verdict(probe)}")
        first = probes[0]
        if probe is not first and not probe.error and not first.error:
            apart = portable.difference(first.in_place, probe.alone)
            far = "" if _is_near(apart, arguments.tolerance) else ": this is another picture"
            print(f"  against {first.version}: {_apart(apart)}{far}")
        for name in probe.written:
            print(f"  wrote {name} beside the copy")
    for title, grave in (("would be missing or otherwise elsewhere:", True), ("to know:", False)):
        chosen = [finding for finding in findings if finding.grave == grave]
        if chosen:
            print(title, *(f"  {finding.subject}: {finding.text}" for finding in chosen), sep="\n")
    if not any(finding.grave for finding in findings) and any(not probe.error for probe in probes):
        print("nothing would be missing")


def _verdict(probe):
    if probe.error:
        return probe.error
    height, width, _ = probe.alone.shape
    picture = f"scene {probe.scene!r}, frame {probe.frame}, {width} x {height} pixels"
    if probe.identical:
        return f"{picture}: alone it renders identically, bit for bit"
    return f"{picture}: alone it differs: {_apart(portable.difference(probe.in_place, probe.alone))}"


def _apart(apart):
    if apart is None:
        return "pictures of unlike size"
    return (f"{apart.pixels} pixels differ, the largest by {apart.largest:.3g}, in the mean by "
            f"{100.0 * apart.mean:.3g} % (squares of 8 x 8: {100.0 * apart.coarse:.3g} %); light "
            f"{100.0 * (apart.light - 1.0):+.3g} %")
