"""Reflectance models in NumPy: the reference that tables, shaders and tests are held against. Never imports bpy."""
from . import models as _models  # noqa: F401  (fills the registry)
from .parameters import Parameter, exponent_of_roughness, roughness_of_exponent
from .registry import MODELS, Model, find_model
from .tables import TableError

__all__ = ["MODELS", "Model", "Parameter", "TableError", "exponent_of_roughness", "find_model", "roughness_of_exponent"]
