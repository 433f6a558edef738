"""Checks before and after the extension is packed: tables, shaders, and Blender's own validator."""
import importlib.util
import subprocess
import sys
from pathlib import Path

from ...forms.albedo import tables
from ...models import MODELS
from .archive import PackageError


def check_tables():
    """Loads every albedo table. Raises tables.TableError that names the first missing, stale or damaged file.

    A table of another resolution or range counts as stale: it serves only the user who baked it.
    """
    for table in tables.TABLES.values():
        tables.load(table)


def check_shaders():
    """Compiles every model's shader; returns their number, or the reason (str) why this Python cannot compile any.

    Raises RuntimeError, the compiler's error, where a shader has errors.
    """
    if importlib.util.find_spec("bpy") is None:
        return "bpy is not installed"
    from ...blender.backend import osl

    reason = osl.unavailable()
    if reason:
        return reason
    for model in MODELS.values():
        osl.check_model(model)
    return len(MODELS)


def validator():
    """Path of Blender's official extension tool; None where bpy or the tool is missing."""
    spec = importlib.util.find_spec("bpy")
    if spec is None or not spec.submodule_search_locations:
        return None
    for folder in spec.submodule_search_locations:
        for path in sorted(Path(folder).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")):
            return path
    return None


def validate(path: Path):
    """Validates the zip at `path` with the official tool; returns False where this Python has no such tool.

    Raises PackageError with the tool's output where the tool rejects the zip.
    """
    tool = validator()
    if tool is None:
        return False
    tags = tool.parents[3] / "modules/_bpy_internal/extensions/tags.py"
    command = [sys.executable, str(tool), "validate", str(path), *([f"--valid-tags={tags}"] if tags.exists() else [])]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode:
        raise PackageError(f"{path}: Blender's validator rejects it:\n{result.stdout}{result.stderr}".rstrip())
    return True
