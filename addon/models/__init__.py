"""The models: formula, sampler, density, albedo by quadrature, and parameters. Each is declared once, in `formulas`."""
from . import formulas as _formulas  # noqa: F401  (fills the registry)
from .parameters import Parameter, exponent_of_roughness, roughness_of_exponent
from .registry import MODELS, Model, find_model

__all__ = ["MODELS", "Model", "Parameter", "exponent_of_roughness", "find_model", "roughness_of_exponent"]
