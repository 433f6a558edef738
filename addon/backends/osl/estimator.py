"""How OSL renders each model: with a shader of its own on base lobes or bells, or with lobe rows for its values."""
from ...models.formula_model import FormulaModel
from ...models.lobe_model import LobeModel
from ...models.lobes import DISK


def is_baked(model) -> bool:
    """Whether the shader renders lobe rows, which are baked for the parameters' values; see forms/rows."""
    return isinstance(model, FormulaModel)


def base_family(model) -> str | None:
    """The family of base lobes that the model's own shader uses, see forms/base_lobes; None where it has none."""
    return model.lobe.id if isinstance(model, LobeModel) and model.lobe is not DISK else None
