"""The version of this extension, as its manifest declares it."""
import tomllib

from .resources import MANIFEST as _MANIFEST


def _read() -> str:
    """The manifest's version. Raises ImportError that names the file and the cure where there is none to read."""
    try:
        version = tomllib.loads(_MANIFEST.read_text(encoding="utf-8"))["version"]
    except (OSError, ValueError, KeyError) as error:
        raise ImportError(f"{_MANIFEST} cannot be read ({error}): install the extension again") from None
    if not parts(str(version)):
        raise ImportError(f"{_MANIFEST}: version is {version!r}, no numbers with points between: install it again")
    return version


def parts(version: str) -> tuple:
    """The numbers of a version like "0.2.0", to compare by; () of what is none."""
    numbers = version.split(".")
    return tuple(int(number) for number in numbers) if all(number.isdecimal() for number in numbers) else ()


VERSION = _read()
