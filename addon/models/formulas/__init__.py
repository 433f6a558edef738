"""The models, one file per family. Importing this package fills the registry."""
from . import phong, blinn, disk, ward, cook_torrance, he_torrance, embrechts, ashikhmin_shirley, lafortune  # noqa: F401, I001  (in the order that they are listed to users)
from . import phong_variants, kajiya_kay, ndf_map, pumped  # noqa: F401, I001
