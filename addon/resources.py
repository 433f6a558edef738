"""The paths of the files that ship with the package: tables, shaders, the manifest.

In a checkout and in Blender's extension they lie beside the package. `pip install` puts them into its folder `data`.
"""
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
# The folder of the checkout or of the extension.
ROOT = PACKAGE.parent
# Whether the package is in a checkout of the project.
IS_CHECKOUT = (ROOT / "pyproject.toml").is_file()


def _resource(name: str) -> Path:
    """The path of the file or folder `name`: inside the package if it exists there, else beside the package."""
    inside = PACKAGE / "data" / name
    return inside if inside.exists() else ROOT / name


LUTS, OSL, MANIFEST = _resource("luts"), _resource("osl"), _resource("blender_manifest.toml")
