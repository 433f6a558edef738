"""How large a bake is: the models whose tables are baked, how fine these are, and for which exponents.

A reading between nodes errs by the square of their distance, so half the columns and rows mean four times the error.
"""
from dataclasses import dataclass

from ...models import MODELS, find_model
from ...models.errors import ParameterError
from ...models.parameters import MAX_EXPONENT, MIN_EXPONENT
from . import tables, tabulated


@dataclass(frozen=True)
class Resolution:
    """`factor` multiplies columns and rows of the declared axes; a table of volumes keeps its radii.

    `bound` is what the relative error between nodes stays within over the whole range of exponents, and `cost` the time
    of a bake in parts of the standard one; both are measured (tests/test_sizes.py).
    """

    label: str
    factor: float
    bound: float
    cost: float

    @property
    def help(self) -> str:
        within = f"albedos within {100.0 * self.bound:.2g} %"
        if self.factor == 1.0:
            return within
        return (f"{'inexact: ' if self.factor < 1.0 else ''}{within}, {self.factor**2:.2g} times the numbers, "
                f"{self.cost:.2g} times the time")


RESOLUTIONS = {
    "draft": Resolution("Draft", 0.5, 5e-3, 0.4),
    "standard": Resolution("Standard", 1.0, 1e-3, 1.0),
    "fine": Resolution("Fine", 1.5, 7e-4, 1.7),
}


@dataclass(frozen=True)
class Size:
    """What a bake is told of its tables' axes: a name of RESOLUTIONS, and the exponents that they are for.

    Raises ValueError that names what is wrong.
    """

    resolution: str = "standard"
    lowest: float = MIN_EXPONENT
    highest: float = MAX_EXPONENT

    def __post_init__(self):
        if self.resolution not in RESOLUTIONS:
            raise ParameterError("resolution", "choice", self.resolution,
                                 f"{self.resolution!r} is not one of {', '.join(RESOLUTIONS)}", RESOLUTIONS)
        tables.check_range(self.lowest, self.highest)

    @property
    def is_whole(self) -> bool:
        """Whether it covers all exponents that there are."""
        return self.lowest == MIN_EXPONENT and self.highest == MAX_EXPONENT


STANDARD = Size()


def sized(table, size: Size):
    """A declared table with the axes that `size` asks for."""
    chosen = RESOLUTIONS[size.resolution]
    told = table.told_axes()
    told["columns"], told["rows"] = (round(chosen.factor * told[axis]) for axis in ("columns", "rows"))
    told["lowest"], told["highest"] = table.covering(size.lowest, size.highest)
    return table.with_axes(**told)


def bound(resolution: str, standard: float) -> float:
    """What the error between nodes must be within at a resolution, where `standard` is that of the standard one."""
    chosen = RESOLUTIONS.get(resolution, RESOLUTIONS["standard"])
    return standard * chosen.bound / RESOLUTIONS["standard"].bound


def readers() -> list:
    """The models that read tables."""
    return [model for model in MODELS.values() if tabulated.tables_of(model)]


def tables_of(model_ids) -> list:
    """Names of the tables that these models read. Raises ValueError for a model that reads none, or is none."""
    names = []
    for model_id in model_ids:
        model = find_model(model_id)
        if not tabulated.tables_of(model):
            raise ValueError(f"{model_id} reads no table; those that do are {', '.join(m.id for m in readers())}")
        names += tabulated.tables_of(model)
    return list(dict.fromkeys(names))


def seconds_of(table) -> float:
    """About how long a bake of a table and the measurement of its error take on one core of 2020."""
    inner, each = (200, 3.5e-4 if getattr(table, "control", False) else 2.2e-4)  # nodes of a chain between its stages
    return 1.5 * each * table.height * (inner + table.columns.columns)


def bytes_of(table) -> int:
    """How much a table's numbers take up in a file; compiled into a shader they are text of three times that."""
    return 16 * table.height * table.columns.columns
