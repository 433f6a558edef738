"""The version of this extension, as its manifest declares it."""
import tomllib
from pathlib import Path

_MANIFEST = Path(__file__).resolve().parents[1] / "blender_manifest.toml"
VERSION = tomllib.loads(_MANIFEST.read_text(encoding="utf-8"))["version"]


def parts(version: str) -> tuple:
    """The numbers of a version like "0.2.0", to compare by; () of what is none."""
    numbers = version.split(".")
    return tuple(int(number) for number in numbers) if all(number.isdecimal() for number in numbers) else ()
