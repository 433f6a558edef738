"""Sawicki's statements about the models, as data; nothing here is measured.

Source: D. Sawicki, "Modeling the metallic reflection using appropriate BRDF model": table 1, and its text where that
speaks of Phong's and Ward's models. Pluses are given as their number, "-" as 0 of them or False.
"""
from dataclasses import dataclass

TABLE, TEXT = "table 1", "text"


@dataclass(frozen=True)
class Statement:
    """The published value `says` of a model's property `about`: a bool, a number of pluses, or a distribution."""

    model: str
    about: str
    says: object
    source: str


_COLUMNS = ("he_torrance", "embrechts", "cook_torrance", "ashikhmin_shirley")
_ROWS = {
    "fresnel": (True, True, True, True),
    "reciprocity": (True, True, True, True),
    "energy": (True, True, True, True),
    "off_specular": (True, True, True, True),
    "distribution": ("Beckmann", "Beckmann", "Beckmann", "power"),
    "conformity": (None, 1, 1, 2),
    "spike": (True, True, False, False),
    "wavelength": (True, False, False, False),
    "anisotropy": (False, False, False, True),
    "diffuse": (False, True, False, True),
    "speed": (0, 1, 2, 3),
}
STATEMENTS = (
    *(Statement(model, about, says, TABLE) for about, row in _ROWS.items()
      for model, says in zip(_COLUMNS, row, strict=True) if says is not None),
    Statement("ward", "reciprocity", True, TEXT),
    Statement("ward", "energy", True, TEXT),  # for slopes below 0.2
    Statement("ward", "fresnel", False, TEXT),
    Statement("ward", "anisotropy", True, TEXT),
    Statement("ward", "off_specular", False, TEXT),
    Statement("phong_original", "energy", False, TEXT),
    Statement("phong_original", "off_specular", False, TEXT),
)
MODELS = tuple(dict.fromkeys(statement.model for statement in STATEMENTS))

# Reasons for differences, and limits of the measurements.
REMARKS = {
    ("he_torrance", "energy"): "of a surface that absorbs nothing: the absorption of a metal hides as much",
    ("he_torrance", "off_specular"): "the sum of both cosines sets the phase: smooth surfaces lean inwards",
    ("he_torrance", "distribution"): "Beckmann's facets are the limit of rough surfaces; smooth ones diffract, into a "
    "sharper core with wider tails",
    ("ashikhmin_shirley", "conformity"): "depends on the surface that He-Torrance is given",
    ("cook_torrance", "conformity"): "depends on the surface that He-Torrance is given",
    ("embrechts", "conformity"): "depends on the surface that He-Torrance is given",
    ("embrechts", "spike"): "the source does not give its form, and the model here has none",
    ("embrechts", "diffuse"): "the source does not give its form, and the model here has Lambert's",
    ("phong_original", "energy"): "k_s = 1 reflects 2π/(n+2) at the normal: above 1 for n < 4.3 only",
}
