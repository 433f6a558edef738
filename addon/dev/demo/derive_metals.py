"""Derive linear-RGB figures of metals from measured optical constants: what `addon/library/metals.py` holds.

    python -m addon.dev.demo.derive_metals FOLDER [--illuminant D65]

FOLDER holds the refractiveindex.info files named in SOURCES (CC0). Prints the table METALS as Python source. Needs
colour-science and scipy. For each metal the reflectance spectrum of a smooth surface in air, unpolarised light, is
integrated at every angle from 0 to 85 degrees through the CIE 1931 2-degree observer, taken to linear sRGB (Rec. 709
primaries) and divided by what a perfect mirror gives. The illuminant is D65, whose chromaticity is sRGB's white: a
mirror is then (1, 1, 1) with no chromatic adaptation between observer and screen, and its spectrum is the daylight
that an artist's "white" stands for. (With `--illuminant E` no channel moves by more than 0.02.)
A color outside the RGB gamut (gold's red is above 1) is clipped channel by channel to 0..1: a reflectance above 1
would create energy. Then one pair n, k per channel is fitted so that the conductor formula follows that channel over
the angles.
"""
import argparse
import re
import textwrap
import unicodedata
from pathlib import Path

import numpy as np

from ...models.fresnel import conductor

SOURCES = {
    "silver": ("Silver", "Ag-McPeak.yml"), "aluminium": ("Aluminium", "Al-McPeak.yml"),
    "gold": ("Gold", "Au-McPeak.yml"), "copper": ("Copper", "Cu-McPeak.yml"),
    "chromium": ("Chromium", "Cr-Johnson.yml"), "iron": ("Iron", "Fe-Johnson.yml"),
    "nickel": ("Nickel", "Ni-Johnson.yml"), "titanium": ("Titanium", "Ti-Johnson.yml"),
    "platinum": ("Platinum", "Pt-Rakic-LD.yml"), "tungsten": ("Tungsten", "W-Rakic-LD.yml"),
}
WAVELENGTHS = np.arange(380.0, 781.0, 1.0)  # nm
ANGLES = np.radians(np.arange(0.0, 85.5, 1.0))  # the fit's angles of incidence
COS_82 = 1.0 / 7.0  # where the dip of a metal's reflectance is measured: arccos(1/7) = 81.8 degrees


def read_constants(path):
    """Wavelengths (nm), n and k, each (N,), and the measurement's citation from one refractiveindex.info file.

    Raises ValueError when the file holds no table of n and k that covers the visible range.
    """
    text = Path(path).read_text(encoding="utf-8")
    rows = re.findall(r"^ {8}(\S+) (\S+) (\S+)\s*$", text, flags=re.MULTILINE)
    if "tabulated nk" not in text or not rows:
        raise ValueError(f"{path}: no table of n and k")
    wavelength, n, k = np.array(rows, dtype=np.float64).T
    if wavelength[0] > WAVELENGTHS[0] / 1000.0 or wavelength[-1] < WAVELENGTHS[-1] / 1000.0:
        raise ValueError(f"{path}: covers {wavelength[0]:g} to {wavelength[-1]:g} um, not the visible range")
    return wavelength * 1000.0, n, k, _citation(text)


def _citation(text):
    """The REFERENCES entry in one line, without its markup and without remarks in brackets, its DOI at the end."""
    entry = re.search(r"^REFERENCES: \|\n((?: {4}.*\n)+)", text, flags=re.MULTILINE).group(1)
    doi = re.search(r"doi\.org/([^\"]+)", entry)
    plain = re.sub(r"\[.*?\]|<[^>]+>", "", re.sub(r"\[<a.*?</a>\]", "", entry))
    return " ".join(plain.split()) + (f", doi:{doi.group(1)}" if doi else "")


def observer_weights(illuminant="D65"):
    """Matrix (3, wavelengths) from a reflectance at WAVELENGTHS to linear sRGB; each row sums to 1."""
    import colour

    shape = colour.SpectralShape(WAVELENGTHS[0], WAVELENGTHS[-1], 1.0)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    light = colour.SDS_ILLUMINANTS[illuminant].copy().align(shape)
    xyz = (cmfs.values * light.values[:, None]).T
    rgb = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB @ xyz
    return rgb / rgb.sum(axis=1, keepdims=True)


def reflectance_curves(wavelength, n, k, weights, cos_theta):
    """Observer-integrated linear RGB reflectance, shape (angles, 3), not clipped."""
    from scipy.interpolate import PchipInterpolator

    n, k = (PchipInterpolator(wavelength, values)(WAVELENGTHS) for values in (n, k))
    return conductor(cos_theta, n, k) @ weights.T


def fit_constants(curve, cos_theta, most_extinction=20.0):
    """n, k of one channel whose conductor formula follows `curve` (angles,), and the largest error left.

    Many pairs share one normal reflectance; the angles in between tell them apart. Where a channel is clipped to 1
    nothing does, so k is held below `most_extinction`. Several starts: the sum of squares has more than one valley.
    """
    from scipy.optimize import least_squares

    def residual(nk):
        return conductor(cos_theta, nk[:1], nk[1:])[:, 0] - curve

    bounds = ([1e-3, 1e-2], [20.0, most_extinction])
    starts = np.clip([(0.1, 4.0), (0.3, 2.0), (1.0, 5.0), (2.0, 3.5), (1.2, 2.2)], 0.02, 0.99 * most_extinction)
    fits = [least_squares(residual, start, bounds=bounds, xtol=1e-12, ftol=1e-12, gtol=1e-12) for start in starts]
    best = min(fits, key=lambda fit: fit.cost)
    pair = np.round(best.x, 4)
    return pair, float(np.abs(residual(pair)).max())


def derive(path, weights):
    """Figures of one metal: a dict with f0, f82, ior, extinction (3,), fit_error, overshoot and reference."""
    wavelength, n, k, reference = read_constants(path)
    curves = reflectance_curves(wavelength, n, k, weights, np.cos(ANGLES))
    ends = np.clip(reflectance_curves(wavelength, n, k, weights, np.array([1.0, COS_82])), 0.0, 1.0)
    clipped = np.clip(curves, 0.0, 1.0)
    visible = (wavelength >= WAVELENGTHS[0]) & (wavelength <= WAVELENGTHS[-1])
    most = 1.1 * k[visible].max()  # the best k may lie a little above what was measured: it stands for a whole band
    pairs, errors = zip(*(fit_constants(channel, np.cos(ANGLES), most) for channel in clipped.T), strict=True)
    ior, extinction = np.array(pairs).T
    return {
        "f0": ends[0], "f82": ends[1], "ior": ior, "extinction": extinction, "fit_error": max(errors),
        "overshoot": float(np.abs(curves - clipped).max()), "reference": reference,
    }


def _constant_name(reference):
    """McPEAK's paper is MCPEAK: the first author's surname."""
    surname = re.match(r"(?:\S+\. )*([^\s,]+)", reference).group(1)
    return unicodedata.normalize("NFKD", surname).encode("ascii", "ignore").decode().upper()


def _reference_text(reference):
    lines = textwrap.wrap(reference, 112, drop_whitespace=False)
    return f"{_constant_name(reference)} = (\n" + "".join(f'    "{line}"\n' for line in lines) + ")"


def _metal_text(name, label, figures):
    f0, f82, ior, extinction = (
        "(" + ", ".join(f"{x:.4f}" for x in figures[key]) + ")" for key in ("f0", "f82", "ior", "extinction"))
    clip = figures["overshoot"]
    note = f"  # the brightest channel, {1.0 + clip:.3f} at its highest, is clipped to 1" if clip >= 5e-5 else ""
    return (f'    "{name}": Metal(\n        label="{label}",{note}\n        f0={f0}, f82={f82},\n'
            f"        ior={ior}, extinction={extinction},\n"
            f'        fit_error={figures["fit_error"]:.4f}, reference={_constant_name(figures["reference"])},\n    ),')


def main(argv=None):
    parser = argparse.ArgumentParser(prog="derive_metals", description=__doc__.splitlines()[0])
    parser.add_argument("folder", help="folder of the refractiveindex.info files")
    parser.add_argument("--illuminant", default="D65", choices=("D65", "E"))
    arguments = parser.parse_args(argv)
    weights = observer_weights(arguments.illuminant)
    metals = {name: derive(Path(arguments.folder) / file, weights) for name, (_, file) in SOURCES.items()}
    for reference in dict.fromkeys(figures["reference"] for figures in metals.values()):
        print(_reference_text(reference))
    print("\nMETALS = {")
    for name, figures in metals.items():
        print(_metal_text(name, SOURCES[name][0], figures))
    print("}")


if __name__ == "__main__":
    main()
