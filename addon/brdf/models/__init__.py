"""One file per family; importing this package fills the registry."""
from . import blinn, phong  # noqa: F401
