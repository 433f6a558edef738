"""`plausible compare`."""
import json
from dataclasses import asdict

from ... import brdf
from ...measure.specimen import settings
from ..compare import agreement, properties, published

DESCRIPTION = ("Compute the properties of models from their formulas, and compare them with the statements of "
               "Sawicki's comparison of BRDF models.")
TITLES = {
    "fresnel": "Fresnel's factor", "reciprocity": "reciprocity", "energy": "energy conservation",
    "off_specular": "off-specular peak", "distribution": "half vectors", "conformity": "conformity with HTSG",
    "spike": "mirror spike", "wavelength": "depends on wavelength", "anisotropy": "anisotropy",
    "diffuse": "diffuse, not Lambert", "speed": "speed",
}
LEGEND = """\
half     angle of the half vector where f, seen from above, is one half
recipr.  largest |f(V,L) - f(L,V)| over the larger
albedo   the largest, and where; ! passes 1
peak     of f beyond the mirror direction, light at {angles}; hor: at the horizon; inf: unbounded there
Fresnel  growth of a color of 4 % to 85°, where there is a choice by Schlick
aniso.   largest change of f as view and light turn by 90°, slopes or exponents unequal
spike    largest reflectance of the mirror on top of f; wave: change of f when the wavelength grows by a fifth
D        distribution of half vectors at normal incidence, and its error: Beckmann's, a power of the cosine, or neither
HTSG     difference from He-Torrance's lobes, matched in width, in parts of those; - where none matches
time     of the NumPy reference's evaluate, in parts of Phong's"""

ABOUT_PUBLISHED = """\
Sawicki, Modeling the metallic reflection using appropriate BRDF model, table 1 and text. The paper does not give its
surface: all models are as wide as He-Torrance's on one rough enough for the peak of figure 3, and on the model's
default. Conformity is the difference called HTSG above, speed the time; what agrees of both is their order."""


def add_arguments(parser):
    parser.add_argument("models", nargs="*", metavar="MODEL", help="models, see `plausible list` (default: all)")
    parser.add_argument("--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
                        help="a parameter of all MODELs, as in `plausible furnace`; omits the published statements")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments):
    models = [brdf.find_model(name) for name in dict.fromkeys(arguments.models or brdf.MODELS)]
    given = [settings(model, arguments.assignments) for model in models]
    rows = [properties.measure(model, p) for model, p in zip(models, given, strict=True)]
    judged = [] if arguments.assignments else _judged({model.id for model in models})
    if arguments.json:
        print(json.dumps({"models": [{**asdict(row), "conserves": row.conserves} for row in rows],
                          "published": [_as_json(verdicts) for verdicts in judged]}, indent=2))
        return
    _print_rows(rows)
    if judged:
        _print_judged(judged)


def _judged(models):
    """[[a Verdict on each surface]] of the statements about the models, a set of ids."""
    if not models.intersection(published.MODELS):
        return []
    by_surface = [agreement.verdicts(agreement.matched_rows(surface)) for surface in agreement.SURFACES]
    return [pair for pair in zip(*by_surface, strict=True) if pair[0].statement.model in models]


def _as_json(verdicts):
    statement = verdicts[0].statement
    return {**asdict(statement), "measured": [
        {**surface, "measured": verdict.measured, "agrees": verdict.agrees}
        for surface, verdict in zip(agreement.SURFACES, verdicts, strict=True)]}


def _print_rows(rows):
    angles = ", ".join(f"{angle:g}°" for angle in properties.OFF_SPECULAR_ANGLES)
    peaks = "peak at " + " ".join(f"{angle:g}°" for angle in properties.OFF_SPECULAR_ANGLES)
    print(f"{'model':24} {'half':>6} {'recipr.':>7} {'albedo':>16} {peaks:>21} {'Fresnel':>7} {'aniso.':>6} "
          f"{'diffuse':11} {'spike':>5} {'wave':>5}  {'D':14} {'HTSG':>5} {'time':>5}")
    for row in rows:
        albedo = f"{row.largest_albedo:.4f} at {row.largest_albedo_angle:4g}°{' ' if row.conserves else '!'}"
        peaks = "".join(f"{_peak(shift, angle):>7}"
                        for shift, angle in zip(row.off_specular, properties.OFF_SPECULAR_ANGLES, strict=True))
        conformity = "-" if row.conformity is None else f"{row.conformity:.2f}"
        law = f"{row.distribution} {min(row.distribution_errors.values()):.1%}"
        print(f"{row.model:24} {row.half_angle:5.1f}° {_small(row.reciprocity_error):>7} {albedo:>16} {peaks:>21} "
              f"{_gain(row.fresnel):>7} {_small(row.anisotropy):>6} {row.diffuse:11} {_small(row.spike):>5} "
              f"{_small(row.dispersion):>5}  {law:14} {conformity:>5} {row.cost:5.1f}")
    print(f"\n{LEGEND.format(angles=angles)}")


def _print_judged(judged):
    named = [f"σ₀ {surface['sigma']:g} µm, τ {surface['tau']:g} µm" for surface in agreement.SURFACES]
    print(f"\n{ABOUT_PUBLISHED}\n")
    print(f"{'model':18} {'property':22} {'published':10} {named[0] + ':':30} {'agrees':8} {named[1] + ':':30} agrees")
    for verdicts in judged:
        statement = verdicts[0].statement
        results = " ".join(f"{v.measured:30} {'yes' if v.agrees else 'NO':8}" for v in verdicts)
        print(f"{statement.model:18} {TITLES[statement.about]:22} {_published(statement):10} {results}".rstrip())
        remark = published.REMARKS.get((statement.model, statement.about))
        if remark and not all(v.agrees for v in verdicts):
            print(f"{'':18} {remark}")


def _published(statement):
    """A statement's value as text."""
    says = statement.says
    if isinstance(says, str):
        return says
    if isinstance(says, bool):
        return "yes" if says else "no"
    return "+" * says or "-"


def _small(x):
    """A number from 0 up as text, "-" where it is 0 but for rounding."""
    return f"{x:.2f}" if x > 1e-6 else "-"


def _gain(x):
    return f"x{x:.1f}" if x > 1.0 + 1e-6 else "-"


def _peak(shift, light_angle):
    if shift is None:
        return "inf"
    if light_angle + shift > 89.99:
        return "hor"
    return f"{shift:+.1f}" if abs(shift) > 0.02 else "0"
