"""Writes the models' pages into a folder, and finds outdated pages."""
from pathlib import Path

from ...forms.files import replace_text
from ...models import MODELS
from ...resources import ROOT
from . import model_page

DOCS = ROOT / "docs"
MODEL_PAGES = DOCS / "models"


def texts() -> dict:
    """{file name: text} of the index and of every model's page."""
    pages = {model_page.file_name(model): model_page.page(model) for model in MODELS.values()}
    return {model_page.INDEX: model_page.index(), **pages}


def write(folder: Path = MODEL_PAGES) -> list:
    """Write all pages into `folder`; returns their paths. A file is replaced only by a whole one."""
    folder.mkdir(parents=True, exist_ok=True)
    pages = texts()
    for name, text in pages.items():
        replace_text(folder / name, text)
    return [folder / name for name in pages]


def outdated(folder: Path = MODEL_PAGES) -> list:
    """Names of pages in `folder` that are missing, differ from `texts`, or belong to no model."""
    today = texts()
    found = {path.name: path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.md"))}
    return sorted(name for name in today.keys() | found.keys() if today.get(name) != found.get(name))
