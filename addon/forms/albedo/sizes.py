"""The size of an albedo bake: the models, the tables' resolution, and the range of exponents.

The error between nodes goes with the square of their distance: half the columns and rows have four times the error.
"""
from dataclasses import dataclass

from ...models import MODELS, find_model
from ...models.errors import ParameterError
from ...models.parameters import MAX_EXPONENT, MIN_EXPONENT
from . import tables, tabulated


@dataclass(frozen=True)
class Resolution:
    """`factor` multiplies columns and rows of the declared axes; the radii of a table of volumes do not change.

    `bound` is the largest relative error between nodes over the whole range of exponents. `cost` is the time of a bake
    in parts of the standard one. Both are measured (tests/test_sizes.py).
    """

    label: str
    factor: float
    bound: float
    cost: float

    @property
    def help(self) -> str:
        """A phrase on error, numbers and time, for --help texts and tooltips."""
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
    """The axes of baked tables: `resolution`, a key of RESOLUTIONS, and the range of exponents, `lowest` to `highest`.

    Raises ParameterError, a ValueError, for an unknown resolution or a range that is not allowed.
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
        """Whether the range covers all allowed exponents."""
        return self.lowest == MIN_EXPONENT and self.highest == MAX_EXPONENT


STANDARD = Size()


def sized(table, size: Size):
    """A declared table with the axes of `size`."""
    chosen = RESOLUTIONS[size.resolution]
    axes = table.told_axes()
    axes["columns"], axes["rows"] = (round(chosen.factor * axes[axis]) for axis in ("columns", "rows"))
    axes["lowest"], axes["highest"] = table.covering(size.lowest, size.highest)
    return table.with_axes(**axes)


def bound(resolution: str, standard: float) -> float:
    """The bound of the error between nodes at a resolution, where `standard` is the bound at the standard one."""
    chosen = RESOLUTIONS.get(resolution, RESOLUTIONS["standard"])
    return standard * chosen.bound / RESOLUTIONS["standard"].bound


def readers() -> list:
    """The models that read tables."""
    return [model for model in MODELS.values() if tabulated.tables_of(model)]


def tables_of(model_ids) -> list:
    """Names of the tables that these models read. Raises ValueError for an unknown model, or one without tables."""
    names = []
    for model_id in model_ids:
        model = find_model(model_id)
        if not tabulated.tables_of(model):
            raise ValueError(f"{model_id} reads no table; those that do are {', '.join(m.id for m in readers())}")
        names += tabulated.tables_of(model)
    return list(dict.fromkeys(names))


def seconds_of(table) -> float:
    """An estimate of the seconds for a table's bake and the measurement of its error, on one core of 2020."""
    # Nodes between the pumps' stages, and seconds for a node.
    inner, seconds = (200, 3.5e-4 if getattr(table, "control", False) else 2.2e-4)
    return 1.5 * seconds * table.height * (inner + table.columns.columns)


def bytes_of(table) -> int:
    """Bytes of a table's numbers in a file; compiled into a shader they are text of three times that size."""
    return 16 * table.height * table.columns.columns
