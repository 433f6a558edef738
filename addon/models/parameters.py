"""Groups of parameters that models share.

Each is declared once, here; sockets, panel, command line, pages and tests derive from the declaration.
"""
import math

from .parameter import COLOR, GEOMETRY, LOBE, RETROREFLECTION, SAMPLING, Parameter  # noqa: F401 (sections, beside these)

# The range of exponents of the models with albedo tables.
MIN_EXPONENT, MAX_EXPONENT = 1.0, 100000.0
# Smaller roughnesses are clamped to this one.
LEAST_ROUGHNESS = 1e-4
# The half-vector power with the exponent BECKMANN_POWER / alpha² - BECKMANN_POWER is as wide as Beckmann's lobe.
BECKMANN_POWER = 2.0


def exponent_of_roughness(roughness: float) -> float:
    """Exponent n = 2/alpha^2 - 2 with alpha = roughness^2, clamped to the range of exponents.

    The half-vector power cos^n is then as wide as a Beckmann lobe of width alpha (Walter et al. 2007, section 5.2).
    """
    alpha = max(float(roughness), LEAST_ROUGHNESS) ** 2
    return min(max(BECKMANN_POWER / (alpha * alpha) - BECKMANN_POWER, MIN_EXPONENT), MAX_EXPONENT)


def roughness_of_exponent(exponent: float) -> float:
    """Roughness r in 0..1 with exponent_of_roughness(r) = exponent. The exponent is 0 or more."""
    return (BECKMANN_POWER / (float(exponent) + BECKMANN_POWER)) ** 0.25


# The width of a Phong or Blinn lobe, by exponent or by roughness.
SHAPE = (
    Parameter("exponent", "Exponent", "float", 20.0, "Exponent n of the lobe: larger is sharper",
              MIN_EXPONENT, MAX_EXPONENT, logarithmic=True),
    Parameter("use_roughness", "Use Roughness", "bool", False, "Give the lobe's width by roughness, not by exponent"),
    Parameter("roughness", "Roughness", "float", 0.55,
              "Roughness r with alpha = r², n = 2/alpha² - 2, held to exponents from 1 to 100000"),
)
# The correction of pumped models.
PUMPING = (
    Parameter("pumps", "Pumps", "float", 1.0,
              "How often the albedo is pumped up; fractions pump in part. 0 is the plain model", 0.0, 4.0),
    Parameter("control", "Controlled", "bool", True,
              "Keep the mirror image from getting brighter than what it mirrors (controlled pumping)"),
)
# A color with a choice of the Fresnel factor.
COLOUR = (
    Parameter("base_color", "Color", "color", (1.0, 1.0, 1.0), "Reflectance at normal incidence, linear RGB", 0.0, 1.0),
    Parameter("fresnel_type", "Fresnel", "enum", 0,
              "How the color changes with the angle between view and half vector", 0, 2,
              items=(("constant", "Constant", "The same color at every angle"),
                     ("schlick", "Schlick", "From Color at normal incidence to Edge Color at grazing"),
                     ("conductor", "Conductor", "Exact reflectance of a metal from its n and k"))),
    Parameter("f90", "Edge Color", "color", (1.0, 1.0, 1.0), "Reflectance at grazing incidence (Schlick)", 0.0, 1.0),
    Parameter("ior", "Refractive Index n", "color", (0.2, 0.92, 1.1), "Real part of the complex index (Conductor)",
              0.0, 20.0),
    Parameter("extinction", "Extinction k", "color", (3.9, 2.45, 2.14), "Imaginary part of the index (Conductor)",
              0.0, 40.0),
)
# Parameters of the renderer's estimator. Every model has them.
ESTIMATOR = (
    Parameter("shading_normal", "Normal", "vector", (0.0, 0.0, 0.0), "Shading normal; unlinked it is the surface's own",
              -math.inf, math.inf, evaluated=False),
    Parameter("samples", "Samples per Hit", "int", 4,
              "Directions drawn at each hit for the residual of the base lobes: more is less noise and more time",
              1, 8, evaluated=False),
    Parameter("light_spread", "Light Spread", "float", 1.0,
              "Width of the kernel around each drawn direction; 0 is as narrow as can be: exact, and grainy",
              0.0, 2.0, evaluated=False),
)


# Lumps on the halfway vector disk (Edwards et al. 2006).


def _lump_exponent(name, label, default, text):
    return Parameter(name, label, "float", default, text, 0.0, MAX_EXPONENT, logarithmic=True)


def _radius(name, label, default, text):
    return Parameter(name, label, "float", default, text, 0.01, 1.0)


LUMP = (
    _lump_exponent("exponent", "Exponent", 20.0, "Exponent n of the lump: 0 is a flat disk, larger is sharper"),
    _radius("radius_u", "Radius U", 1.0, "Radius of the lump along the tangent, in parts of the disk's"),
    _radius("radius_v", "Radius V", 1.0, "Radius of the lump across the tangent, in parts of the disk's"),
)
ROTATION = (Parameter("rotation", "Rotation", "float", 0.0, "Turn of the lumps about the normal; 1 is a full turn"),)
EDGE = (
    Parameter("base_color", "Color", "color", (1.0, 1.0, 1.0), "Reflectance at normal incidence, linear RGB"),
    Parameter("f90", "Edge Color", "color", (1.0, 1.0, 1.0), "Reflectance at grazing incidence"),
)
# Edwards' empirical model: a specular and a retroreflective lump over a diffuse part.
EMPIRICAL = (
    Parameter("diffuse_color", "Diffuse Color", "color", (0.3, 0.3, 0.3), "Color of what the surface lets in"),
    Parameter("base_color", "Specular Color", "color", (0.04, 0.04, 0.04),
              "Reflectance at normal incidence F0; at grazing it is 1", 0.0, 1.0),
    *LUMP,
    Parameter("retro", "Retroreflection", "float", 0.0, "Share k of what is reflected that goes back to its source"),
    _lump_exponent("retro_exponent", "Retro Exponent", 100.0, "Exponent of the lump that reflects back"),
    _radius("retro_radius_u", "Retro Radius U", 1.0, "Radius, along the tangent, of the lump that reflects back"),
    _radius("retro_radius_v", "Retro Radius V", 1.0, "Radius, across the tangent, of the lump that reflects back"),
    Parameter("vary_exponents", "Vary with Angle", "bool", False, "Change the exponents towards grazing"),
    _lump_exponent("grazing_exponent", "Grazing Exponent", 100.0, "Exponent of the lump where it is seen at grazing"),
    _lump_exponent("retro_grazing_exponent", "Retro Grazing Exponent", 100.0,
                   "Exponent of the lump that reflects back where it is seen at grazing"),
)
# Edwards' model for measured data: two lumps over a diffuse part.
DATA_FIT = (
    Parameter("diffuse_color", "Diffuse Color", "color", (0.1, 0.1, 0.1), "Color of what the surface lets in"),
    Parameter("base_color", "Specular Color", "color", (0.5, 0.5, 0.5), "Reflectance at normal incidence F0", 0.0, 1.0),
    Parameter("f90", "Edge Color", "color", (1.0, 1.0, 1.0), "Reflectance at grazing incidence", 0.0, 1.0),
    _lump_exponent("exponent", "Exponent", 50.0, "Exponent n of the first lump: 0 is a flat disk, larger is sharper"),
    _radius("radius", "Radius", 0.8, "Radius of the first lump, in parts of the disk's"),
    Parameter("blend", "Blend", "float", 0.3, "Share k of the second lump"),
    _lump_exponent("second_exponent", "Second Exponent", 10.0, "Exponent of the second lump"),
    _radius("second_radius", "Second Radius", 0.8, "Radius of the second lump, in parts of the disk's"),
    Parameter("renormalize", "Renormalize", "bool", True,
              "Make up for the volume that the lumps lose where they leave the disk: no light is lost"),
)
# The direction of stretched lobes and of images.
TANGENT = (
    Parameter("tangent", "Tangent", "vector", (0.0, 0.0, 0.0),
              "Direction that Radius U is measured along; unlinked it runs around the object's z axis",
              -math.inf, math.inf, evaluated=False),
)
# A lobe from an image.
IMAGE = (
    Parameter("image", "Image", "image", "", "Picture of the highlight: the hemisphere of half vectors from above, the "
              "tangent to the right. Only proportions count; empty it is a star", -math.inf, math.inf),
    Parameter("rotation", "Rotation", "float", 0.0, "Turn of the image about the normal; 1 is a full turn"),
)


# The literature's models.

# The range of slopes. Narrower lobes would be mirrors to a renderer.
_WIDTH = {"minimum": 0.01, "maximum": 1.0}
SLOPE = (Parameter("roughness", "Slope m", "float", 0.2, "Slope m of the microfacets, √2 times its root mean square",
                   **_WIDTH),)
SLOPES = (
    Parameter("roughness_u", "Slope U", "float", 0.15, "Slope m_x of the microfacets along the tangent", **_WIDTH),
    Parameter("roughness_v", "Slope V", "float", 0.15, "Slope m_y of the microfacets across the tangent", **_WIDTH),
)
SPECULAR = (Parameter("base_color", "Specular Color", "color", (1.0, 1.0, 1.0),
                      "Reflectance of the specular part, at normal incidence, linear RGB"),)
DIFFUSE = (Parameter("diffuse_color", "Diffuse Color", "color", (0.0, 0.0, 0.0), "Reflectance of the diffuse part"),)
EXPONENT = (Parameter("exponent", "Exponent", "float", 50.0, "Exponent of the lobe: larger is sharper", 1.0, 10000.0,
                      logarithmic=True),)
POWERS = (
    Parameter("exponent_u", "Exponent U", "float", 50.0, "Exponent of the lobe along the tangent", 1.0, 10000.0,
              logarithmic=True),
    Parameter("exponent_v", "Exponent V", "float", 50.0, "Exponent of the lobe across the tangent", 1.0, 10000.0,
              logarithmic=True),
)
# Embrechts' model.
SMOOTHNESS = (
    Parameter("smoothness", "Smoothness s", "float", 5.0, "Smoothness s, one over the slope of the surface", 1.0,
              100.0),
    Parameter("scattering", "Scattering", "float", 1.0, "Share a_sc of the light that is scattered about the mirror "
              "direction"),
)
# He and Torrance's model: the surface's statistics and the light's wavelength.
SURFACE = (
    Parameter("sigma", "Height σ₀", "float", 0.1, "Root mean square height of the surface in micrometres", 0.01, 1.0),
    Parameter("tau", "Correlation τ", "float", 1.7, "Correlation length of the surface in micrometres", 0.2, 20.0),
    Parameter("wavelength", "Wavelength", "float", 0.55, "Wavelength of the light in micrometres", 0.38, 0.78),
)
NORMALIZE = (Parameter("normalized", "Normalized", "bool", True, "Scale the lobe so that its light does not depend on "
                       "the exponent"),)


def _lobe_of_sum(i, weight, exponent):
    return (
        Parameter(f"weight_{i}", f"Weight {i}", "float", weight, f"Share of lobe {i}"),
        Parameter(f"exponent_{i}", f"Exponent {i}", "float", exponent, f"Exponent of lobe {i}: larger is sharper", 1.0,
                  10000.0, logarithmic=True),
    )


LOBES = _lobe_of_sum(1, 0.5, 300.0) + _lobe_of_sum(2, 0.3, 40.0) + _lobe_of_sum(3, 0.1, 5.0)


def _cosine_lobe(i, weight, exponent, cxy, cz):
    return (
        *_lobe_of_sum(i, weight, exponent),
        Parameter(f"cxy_{i}", f"C_xy {i}", "float", cxy, f"How lobe {i} follows the mirror direction: -1 as a mirror, "
                  "more towards grazing where it is larger than C_z, 1 back to the light", -1.2, 1.2),
        Parameter(f"cz_{i}", f"C_z {i}", "float", cz, f"How upright lobe {i} is", -1.2, 1.2),
    )


COSINE_LOBES = (_cosine_lobe(1, 0.7, 20.0, -1.01, 0.98) + _cosine_lobe(2, 0.1, 5.0, -0.5, 1.0)
                + _cosine_lobe(3, 0.05, 10.0, 0.9, 1.0))
