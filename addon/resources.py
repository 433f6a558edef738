"""The files that come with the package: tables, shaders, the manifest.

In a checkout and in Blender's extension they lie beside the package; `pip install` puts them into it.
"""
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
ROOT = PACKAGE.parent  # of a checkout or of the extension


def _found(name: str) -> Path:
    """A file or folder, inside the package or else beside it."""
    inside = PACKAGE / "data" / name
    return inside if inside.exists() else ROOT / name


LUTS, OSL, MANIFEST = _found("luts"), _found("osl"), _found("blender_manifest.toml")
