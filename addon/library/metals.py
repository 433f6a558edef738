"""Metals: linear-sRGB reflectances and effective refractive indices from measured optical constants.

Derived by `python -m addon.dev.demo.derive_metals FOLDER` from n, k files of the refractiveindex.info database (CC0).
The data are reflectances of a smooth surface in air for unpolarized light. At every angle the spectrum is integrated
with the CIE 1931 2-degree observer under illuminant D65 (sRGB's white, so that a perfect mirror is 1, 1, 1). Channels
are clipped to 0..1. Gold's and copper's red are outside the gamut (up to 1.05) and become 1, which changes their hue a
little and creates no energy.

`ior` and `extinction` are fitted per channel. They are the constants of no wavelength, but fresnel.conductor with them
follows the integrated reflectance from 0 to 85 degrees within `fit_error` (absolute, worst channel and angle; 0.0018
for gold, 0.0007 or less for the others).
"""
from dataclasses import dataclass


@dataclass(frozen=True)
class Metal:
    """A metal's optical properties, each a linear-sRGB triple.

    - `f0`: the reflectance at normal incidence.
    - `f82`: the reflectance at arccos(1/7) = 81.8 degrees, where metals have a minimum.
    - `f90`: Schlick's edge color. Toward 90 degrees the reflectance of every metal tends to 1.
    - `ior`, `extinction`: n and k of the exact conductor formula.
    - `fit_error`: see above.
    - `reference`: the source of the measurement.
    """

    label: str
    f0: tuple
    f82: tuple
    ior: tuple
    extinction: tuple
    fit_error: float
    reference: str
    f90: tuple = (1.0, 1.0, 1.0)


MCPEAK = (
    "K. M. McPeak, S. V. Jayanti, S. J. P. Kress, S. Meyer, S. Iotti, A. Rossinelli, D. J. Norris. Plasmonic films "
    "can easily be better: Rules and recipes. ACS Photonics 2, 326-333 (2015), doi:10.1021/ph5004237"
)
JOHNSON = (
    "P. B. Johnson and R. W. Christy. Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd. "
    "Phys. Rev. B 9, 5056-5070 (1974), doi:10.1103/PhysRevB.9.5056"
)
RAKIC = (
    "A. D. Rakić, A. B. Djurišic, J. M. Elazar, M. L. Majewski. Optical properties of metallic films for vertical-"
    "cavity optoelectronic devices. Appl. Opt. 37, 5271-5283 (1998), doi:10.1364/AO.37.005271"
)

METALS = {
    "silver": Metal(
        label="Silver",
        f0=(0.9900, 0.9875, 0.9791), f82=(0.9884, 0.9889, 0.9877),
        ior=(0.0520, 0.0437, 0.0411), extinction=(4.4294, 3.5951, 2.6067),
        fit_error=0.0000, reference=MCPEAK,
    ),
    "aluminium": Metal(
        label="Aluminium",
        f0=(0.9062, 0.9162, 0.9225), f82=(0.8429, 0.8770, 0.9078),
        ior=(1.1953, 0.7653, 0.4659), extinction=(6.7918, 5.7801, 4.6803),
        fit_error=0.0004, reference=MCPEAK,
    ),
    "gold": Metal(
        label="Gold",  # the brightest channel, 1.053 at its highest, is clipped to 1
        f0=(1.0000, 0.7840, 0.3425), f82=(0.9996, 0.8879, 0.6243),
        ior=(0.0010, 0.3803, 1.6153), extinction=(5.5567, 2.2696, 1.7271),
        fit_error=0.0018, reference=MCPEAK,
    ),
    "copper": Metal(
        label="Copper",  # the brightest channel, 1.047 at its highest, is clipped to 1
        f0=(1.0000, 0.6871, 0.5619), f82=(1.0000, 0.8014, 0.7338),
        ior=(0.0010, 0.7970, 1.1130), extinction=(5.4843, 2.6386, 2.3861),
        fit_error=0.0007, reference=MCPEAK,
    ),
    "chromium": Metal(
        label="Chromium",
        f0=(0.5493, 0.5560, 0.5546), f82=(0.5613, 0.5697, 0.6192),
        ior=(3.2476, 3.1239, 2.2838), extinction=(3.2837, 3.3373, 3.1189),
        fit_error=0.0002, reference=JOHNSON,
    ),
    "iron": Metal(
        label="Iron",
        f0=(0.5297, 0.5131, 0.4943), f82=(0.5718, 0.5664, 0.5837),
        ior=(2.9203, 2.9234, 2.5478), extinction=(3.0772, 2.9369, 2.7509),
        fit_error=0.0001, reference=JOHNSON,
    ),
    "nickel": Metal(
        label="Nickel",
        f0=(0.6970, 0.6405, 0.5634), f82=(0.6823, 0.6729, 0.6665),
        ior=(2.0376, 1.9042, 1.7282), extinction=(4.2026, 3.5708, 2.8960),
        fit_error=0.0006, reference=JOHNSON,
    ),
    "titanium": Metal(
        label="Titanium",
        f0=(0.6190, 0.5793, 0.5423), f82=(0.6112, 0.6118, 0.6188),
        ior=(2.7502, 2.5085, 2.2412), extinction=(3.8477, 3.3974, 3.0133),
        fit_error=0.0005, reference=JOHNSON,
    ),
    "platinum": Metal(
        label="Platinum",
        f0=(0.6779, 0.6377, 0.5837), f82=(0.6553, 0.6593, 0.6625),
        ior=(2.3538, 2.0756, 1.8328), extinction=(4.2396, 3.6680, 3.0955),
        fit_error=0.0006, reference=RAKIC,
    ),
    "tungsten": Metal(
        label="Tungsten",
        f0=(0.5185, 0.4939, 0.4689), f82=(0.5305, 0.5335, 0.5296),
        ior=(3.6950, 3.4420, 3.3558), extinction=(2.9417, 2.7333, 2.5098),
        fit_error=0.0002, reference=RAKIC,
    ),
}
