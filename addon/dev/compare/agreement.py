"""Compares published statements with measurements of models, matched in width as Sawicki matches them."""
from dataclasses import dataclass

from ... import brdf
from . import lobes, properties, published
from .properties import OFF_SPECULAR_ANGLES, REFERENCE

# The paper does not give the surface of He-Torrance's model, and the results depend on it. The first surface is rough
# enough for the off-specular peak of figure 3; the second is the model's default.
SURFACES = ({"sigma": 0.2, "tau": 3.4}, {"sigma": 0.1, "tau": 1.7})
FIGURE_3 = OFF_SPECULAR_ANGLES.index(70.0)
NEGLIGIBLE = 1e-3  # error of a number that is 0 but for rounding or quadrature
NEARLY = 1.1  # times of a smaller ratio count as equal


@dataclass(frozen=True)
class Verdict:
    """A statement, its measurement as text, and whether they agree."""

    statement: published.Statement
    measured: str
    agrees: bool


def matched_rows(surface) -> dict:
    """{model: Row} of all models with statements, each as wide as He-Torrance's lobe on `surface`."""
    angle = lobes.half_angle(brdf.MODELS[REFERENCE], surface)
    parameters = {name: surface if name == REFERENCE else lobes.matched(brdf.MODELS[name], angle)
             for name in published.MODELS}
    return {name: properties.measure(brdf.MODELS[name], p, surface) for name, p in parameters.items()}


def verdicts(rows) -> list:
    """A Verdict for every statement, of `rows` {model: Row}."""
    return [judge(statement, rows) for statement in published.STATEMENTS]


def judge(statement, rows) -> Verdict:
    """The Verdict on a statement, from the measured `rows` {model: Row}."""
    row, says = rows[statement.model], statement.says
    if statement.about in ("conformity", "speed"):
        amount = {name: row.conformity if statement.about == "conformity" else row.cost for name, row in rows.items()}
        return Verdict(statement, f"{amount[row.model]:.3f}", _in_order(statement, amount))
    if statement.about == "distribution":
        error = min(row.distribution_errors.values())
        return Verdict(statement, f"{row.distribution}, error {error:.1%}", row.distribution == says)
    has_property, measured = _MEASURED[statement.about](row)
    return Verdict(statement, measured, has_property == says)


def _in_order(statement, amount):
    """Whether models with more pluses have a smaller `amount` {model: number}, and models with fewer a larger."""
    mine = amount[statement.model]
    slack = NEARLY if statement.about == "speed" else 1.0
    others = [s for s in published.STATEMENTS if s.about == statement.about and s.model != statement.model]
    better = all(mine <= slack * amount[s.model] for s in others if s.says < statement.says)
    return better and all(amount[s.model] <= slack * mine for s in others if s.says > statement.says)


def _off_specular(row):
    """(whether the peak lies beyond the mirror direction, its shift as text) at the light angle of figure 3."""
    shift = row.off_specular[FIGURE_3]
    if shift is None:
        return False, "unbounded at the horizon"
    return shift > 0.5, f"{shift:+.1f}° at {OFF_SPECULAR_ANGLES[FIGURE_3]:g}°"


# For each `about` of a statement: a function of the row, (whether the model has the property, the measurement as text).
_MEASURED = {
    "fresnel": lambda row: (row.fresnel > 1.0 + NEGLIGIBLE, f"x {row.fresnel:.1f} at 85°"),
    "reciprocity": lambda row: (row.reciprocity_error < NEGLIGIBLE, f"error {row.reciprocity_error:.0e}"),
    "energy": lambda row: (row.conserves, f"albedo {row.largest_albedo:.3f} at {row.largest_albedo_angle:g}°"),
    "off_specular": _off_specular,
    "spike": lambda row: (row.spike > 0.0, f"up to {row.spike:.2f}"),
    "wavelength": lambda row: (row.dispersion > 0.0, f"changes by {row.dispersion:.0%}"),
    "anisotropy": lambda row: (row.anisotropy > NEGLIGIBLE, f"changes by {row.anisotropy:.0%}"),
    "diffuse": lambda row: (row.diffuse == properties.NOT_LAMBERT, row.diffuse),
}
