"""One file per family; importing this package fills the registry."""
from . import phong, blinn, disk  # noqa: F401, I001  (in the order that they are listed to users)
