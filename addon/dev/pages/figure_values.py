"""The values in the picture of a model's page: three of one parameter, chosen by eye."""
from dataclasses import dataclass, field

# The parameter that varies, its three values, and other parameters that are not at their defaults.
_BY_MODEL = {
    "disk_orthogonal": ("radius_v", (1.0, 0.4, 0.15), {"exponent": 5.0}),
    "edwards_empirical": ("radius_v", (1.0, 0.3, 0.1), {"base_color": (0.5, 0.5, 0.5)}),
    "edwards_fit": ("blend", (0.0, 0.5, 1.0), {"second_exponent": 2.0}),
    "ward": ("roughness_v", (0.15, 0.3, 0.6), {}),
    "ward_duer": ("roughness_v", (0.15, 0.3, 0.6), {}),
    "ward_bounded": ("roughness_v", (0.15, 0.3, 0.6), {}),
    "ashikhmin_shirley": ("exponent_v", (500.0, 50.0, 5.0), {"exponent_u": 50.0}),
    "he_torrance": ("sigma", (0.05, 0.1, 0.2), {}),
    "kajiya_kay": ("exponent", (3.0, 10.0, 30.0), {"base_color": (0.15, 0.15, 0.15)}),
    "lafortune": ("exponent_1", (5.0, 20.0, 80.0), {}),
    "ndf_map": ("rotation", (0.0, 0.05, 0.1), {}),
}
_BY_PARAMETER = {
    "pumps": (0.0, 1.0, 3.0), "exponent": (10.0, 50.0, 500.0), "roughness": (0.5, 0.3, 0.15),
    "smoothness": (2.0, 5.0, 15.0), "exponent_1": (20.0, 100.0, 500.0),
}


@dataclass(frozen=True)
class Shown:
    """`parameter` takes each of `values`; `others` {id: value} are the same for all three."""

    parameter: object
    values: tuple
    others: dict = field(default_factory=dict)

    @property
    def is_across(self) -> bool:
        """Whether to cut the lobes across the tangent, where this parameter changes them."""
        return self.parameter.id.endswith("_v")

    def settings(self) -> list:
        """The three {parameter id: value}."""
        return [{**self.others, self.parameter.id: value} for value in self.values]

    def label(self, value) -> str:
        """The caption of one value's ball."""
        return f"{self.parameter.label} = {value:g}"


def shown(model) -> Shown:
    """The values in a model's picture: those of _BY_MODEL, else numbers of pumps of a pumped model, else widths."""
    if model.id in _BY_MODEL:
        name, values, others = _BY_MODEL[model.id]
        return Shown(model.parameter(name), values, others)
    name = "pumps" if any(p.id == "pumps" for p in model.parameters) else model.width_parameter
    return Shown(model.parameter(name), _BY_PARAMETER[name])
