"""The extension's zip: the files that the manifest allows, in an archive that is equal for equal files."""
import re
import tomllib
import zipfile
from fnmatch import fnmatchcase
from pathlib import Path

from ...forms.files import replacing
from ...resources import ROOT

MANIFEST = "blender_manifest.toml"
_TIMESTAMP = (1980, 1, 1, 0, 0, 0)  # a zip's earliest time: the clock must not change the archive
# Files without which the extension does not work.
_NEEDED = ("__init__.py", "LICENSE", "addon/__init__.py")


class PackageError(ValueError):
    """The source folder is not this extension, or its manifest has an entry that is not understood."""


def read_manifest(root: Path = ROOT) -> dict:
    """The manifest of the source folder `root`, a dict. Raises PackageError where it is missing or malformed."""
    path = Path(root) / MANIFEST
    try:
        manifest = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise PackageError(f"{path} is missing: {root} is not the extension's source folder") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise PackageError(f"{path}: {error}") from None
    for key in ("id", "version"):
        if not re.fullmatch(r"[\w.-]+", str(manifest.get(key, ""))):
            raise PackageError(f"{path}: {key} is {manifest.get(key)!r}; the zip is named by it")
    if not isinstance(manifest.get("build", {}), dict):
        raise PackageError(f"{path}: build is {manifest['build']!r}, where a table is expected")
    return manifest


def file_name(manifest: dict) -> str:
    """Name of the zip, the same as by Blender's own builder."""
    return f"{manifest['id']}-{manifest['version']}.zip"


def is_excluded(path: str, is_folder: bool, patterns) -> bool:
    """Whether a manifest's `paths_exclude_pattern` exclude `path` (relative, with forward slashes).

    These rules of a .gitignore are supported: `name`, `name/` (folders only), `/name` (at the top only), wildcards
    within a name, and `!` for exceptions. The last matching pattern decides. Raises PackageError for any other pattern.
    """
    excluded = False
    for pattern in patterns:
        name = pattern.removeprefix("!")
        at_top, folders_only = name.startswith("/"), name.endswith("/")
        name = name.strip("/")
        if not name or "/" in name or "**" in name:
            raise PackageError(f"{MANIFEST}: exclude pattern {pattern!r} is not understood")
        if (folders_only and not is_folder) or (at_top and "/" in path):
            continue
        if fnmatchcase(path.rpartition("/")[2], name):
            excluded = not pattern.startswith("!")
    return excluded


def files(root: Path = ROOT) -> list:
    """Files of the zip, relative to `root`, sorted. Raises PackageError where a needed file is missing."""
    root = Path(root)
    patterns = read_manifest(root).get("build", {}).get("paths_exclude_pattern", [])
    names, folders = [MANIFEST], [root]
    while folders:
        for entry in folders.pop().iterdir():
            path = entry.relative_to(root).as_posix()
            if path == MANIFEST or is_excluded(path, entry.is_dir(), patterns):
                continue
            if entry.is_dir():
                folders.append(entry)
            else:
                names.append(path)
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise PackageError(f"{root}: {', '.join(missing)} missing")
    return sorted(names)


def build(folder: Path, root: Path = ROOT) -> Path:
    """Writes the extension's zip into `folder`; returns its path. Only a complete zip replaces an older one.

    Raises PackageError as `files`.
    """
    names = files(root)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / file_name(read_manifest(root))
    with replacing(path) as beside, zipfile.ZipFile(beside, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in names:
            # Unix, rw-r--r--: equal on every system.
            entry = zipfile.ZipInfo(name, _TIMESTAMP)
            entry.compress_type, entry.create_system, entry.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            archive.writestr(entry, (Path(root) / name).read_bytes())
    return path
