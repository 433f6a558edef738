"""The version of this extension, read from its manifest."""
import tomllib

from .resources import MANIFEST as _MANIFEST


def _read() -> str:
    """The manifest's version. Raises ImportError, which names the file and the remedy, if it cannot be read."""
    try:
        version = tomllib.loads(_MANIFEST.read_text(encoding="utf-8"))["version"]
    except (OSError, ValueError, KeyError) as error:
        raise ImportError(f"{_MANIFEST} cannot be read ({error}): install the extension again") from None
    if not parts(str(version)):
        raise ImportError(f"{_MANIFEST}: version is {version!r}, expected numbers separated by points: "
                          "install the extension again")
    return version


def parts(version: str) -> tuple:
    """The numbers of a version like "0.2.0", for comparison: (0, 2, 0). () if `version` is no such text."""
    numbers = version.split(".")
    return tuple(int(number) for number in numbers) if all(number.isdecimal() for number in numbers) else ()


VERSION = _read()
