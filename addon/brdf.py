"""The public interface: reflectance models in NumPy, the reference for tables, shaders and tests. Never imports bpy."""
from .forms.albedo.tables import TableError
from .models import MODELS, Model, Parameter, exponent_of_roughness, find_model, roughness_of_exponent

__all__ = ["MODELS", "Model", "Parameter", "TableError", "exponent_of_roughness", "find_model", "roughness_of_exponent"]
