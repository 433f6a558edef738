"""Files that ship with the add-on: a preview of each model and of each preset, made by `plausible previews`, and the
asset library, made of these by `plausible assets`."""
from pathlib import Path

PREVIEWS = Path(__file__).resolve().parent / "previews"
LIBRARY = Path(__file__).resolve().parent / "plausible.blend"


def preview(key: str, folder: Path = PREVIEWS) -> Path:
    """The path of the preview of a model or preset, by id, which may be missing."""
    return folder / f"{key}.png"
