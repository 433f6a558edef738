"""Files that ship with the add-on: a preview of each model and of each preset, made by `plausible previews`, and the
asset library, made of these by `plausible assets`."""
from pathlib import Path

PREVIEWS = Path(__file__).resolve().parent / "previews"
LIBRARY = Path(__file__).resolve().parent / "plausible.blend"
PRESETS = "presets"  # the folder of theirs beside those of the models


def model_preview(model_id: str, folder: Path = PREVIEWS) -> Path:
    """The path of a model's preview, which may be missing."""
    return folder / f"{model_id}.png"


def preset_preview(name: str, folder: Path = PREVIEWS) -> Path:
    """The path of a preset's preview, which may be missing."""
    return folder / PRESETS / f"{name}.png"
