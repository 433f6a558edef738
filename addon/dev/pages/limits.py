"""The entries of README's Limits about a model, which its page quotes."""

from ...backends.osl import estimator
from ...forms.albedo import tabulated
from ...models.disk_model import DiskModel
from ...models.lobes import DISK
from ...resources import ROOT

README = ROOT / "README.md"
HEADING = "## Limits"


def made_of_lumps(model):
    """Whether a model is made of lumps on the halfway vector disk."""
    return isinstance(model, DiskModel) or getattr(model, "lobe", None) is DISK


# The beginning of an entry, and the models that it is about. All other entries are about every model.
_ABOUT = {
    "A lamp of no size": lambda model: estimator.base_family(model) is not None and not estimator.is_baked(model),
    "The fitted base ends below zero": lambda model: estimator.base_family(model) == "blinn",
    "Super-metals": lambda model: model.id == "pumped_blinn",
    "A pumped material takes": lambda model: model.id in ("pumped_phong", "pumped_blinn"),
    "Lumps:": made_of_lumps,
    "Lumps narrower": made_of_lumps,
    "Materials carry the tables": lambda model: bool(tabulated.tables_of(model)),
    "Models that are baked": lambda model: estimator.is_baked(model),
    "Pumped formulas": lambda model: estimator.is_baked(model) and model.id.startswith("pumped_"),
    "NDF maps": lambda model: model.id == "ndf_map",
}


def entries(text: str) -> list:
    """The entries of the list under HEADING in a Markdown `text`, each without its dash and in one line.

    Raises ValueError where there is no such list.
    """
    _, heading, after = text.partition(f"\n{HEADING}\n")
    section = after.partition("\n## ")[0].strip()
    if not heading or not section.startswith("- "):
        raise ValueError(f"README has no list under {HEADING!r}")
    return [" ".join(entry.split()) for entry in section.removeprefix("- ").split("\n- ")]


def limits_of(model, text: str | None = None) -> list:
    """The entries of README, or of `text`, that are about this model and not about all.

    Raises ValueError that names a beginning in _ABOUT with which no entry begins, or more than one.
    """
    limits = entries(README.read_text(encoding="utf-8") if text is None else text)
    chosen = []
    for beginning, is_about in _ABOUT.items():
        matching = [entry for entry in limits if entry.startswith(beginning)]
        if len(matching) != 1:
            raise ValueError(f"README's Limits have {len(matching)} entries that begin with {beginning!r}, expected 1: "
                             "say in addon/dev/pages/limits.py which models it is about")
        if is_about(model):
            chosen += matching
    return chosen
