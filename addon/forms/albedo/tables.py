"""The albedo tables: their declarations, their files, and the reading of files, with all checks before the first use.

A file is an RGBA float image between two marker rows. An albedo table has one row per exponent, with a_0 .. a_3 in the
channels. The table of volumes has a block of such rows for every four radii, with one radius in each channel. The
pixels of a marker row are (-1, stamp, 0 at the top or 1 at the bottom, format). No albedo is negative. The stamp is a
hash of the table's axes. The third number tells a shader whether its texture call counts rows from the top or from the
bottom.

`TABLES` declares the standard axes. A bake may have more or fewer columns and rows, or a part of the exponents: the
file's metadata then have the axes, and `in_use` gives the table with the axes of its file.
"""
import json
import zlib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ...models import disk, exr
from ...models.errors import BrdfError, ParameterError
from ...models.parameters import MAX_EXPONENT, MIN_EXPONENT
from ...resources import LUTS
from . import axes
from .axes import ColumnAxis, RowAxis, SineAxis

FORMAT = 1
MARK = -1.0  # the first number of a marker
CHANNELS = 4  # albedos, or radii, in a pixel
# Metadata: the axes that may differ from the declared ones, the name of the resolution, and the measured error.
AXES, RESOLUTION, ERROR = "plausible:axes", "plausible:resolution", "plausible:error"
# Part of an exponent by which it may lie beyond a table's end: albedos change by no more than this there.
SLACK = 1e-4
_MOST = 4096  # largest number of columns or rows
PACKAGED = LUTS
_folder = PACKAGED


class TableError(BrdfError):
    """An albedo table is missing, stale or damaged. The message names the file and the cure.

    `path` is the file. `code` is "missing", "unreadable", "image" (not an image, or cut), "resized", "stale",
    "albedos" (impossible ones), "axes" (not the expected ones), "impossible" (axes), or "range" (an exponent beyond the
    table's range).
    """

    def __init__(self, message, code, path):
        self.path = Path(path)
        super().__init__(message, code)


@dataclass(frozen=True)
class Table:
    """One albedo table: the pump stages of a lobe, plain or controlled, over (cos theta, exponent)."""

    lobe: str
    control: bool
    columns: ColumnAxis
    rows: RowAxis

    allowed = (0.0, 1.4)  # albedos lie above the first number, and at most at the second

    @property
    def name(self) -> str:
        return f"{self.lobe}_{'controlled' if self.control else 'plain'}"

    @property
    def height(self) -> int:
        """Rows of the image without markers."""
        return self.rows.rows

    @property
    def span(self) -> tuple:
        """(least, largest) exponent of a reading."""
        return self.rows.lowest, self.rows.highest

    def told_axes(self) -> dict:
        """The axes that may differ from the declared ones, as a file's metadata have them."""
        return {"columns": self.columns.columns, "rows": self.rows.rows, "lowest": self.rows.lowest,
                "highest": self.rows.highest}

    def with_axes(self, columns, rows, lowest, highest):
        """This table with other axes. Raises ValueError, with the name, for a number that is not allowed."""
        return replace(self, columns=replace(self.columns, columns=_count("columns", columns, 3)),
                       rows=replace(self.rows, rows=_count("rows", rows, 2), **check_range(lowest, highest)))

    def covering(self, lowest: float, highest: float) -> tuple:
        """(lowest, highest) of the rows for readings at exponents from `lowest` to `highest`."""
        return lowest, highest

    @property
    def stamp(self) -> float:
        """A number in 0..1, a hash of axes, lobe and format; exact in float32."""
        return (zlib.crc32(f"{FORMAT} {self!r}".encode()) % 65521) / 65536.0

    @property
    def path(self) -> Path:
        return _folder / f"{self.name}.exr"


@dataclass(frozen=True)
class VolumeTable:
    """Volume inside the disk of a round lump about the origin, over (view, exponent n, radius R).

    The disk's edge is 1 - sin theta away from the lump's center. Columns are that distance in parts of R, as
    `ColumnAxis` for the exponent n + 1; rows are for n + 1 as well. `layers` radii lie from 0 to 1, denser towards 1,
    where a lump is as round as the disk. A reading between two radii is linear.
    """

    columns: ColumnAxis
    rows: RowAxis
    layers: int

    name = "disk_volume"
    allowed = (0.0, 1.0 + 1e-6)

    stamp, path, told_axes, with_axes = Table.stamp, Table.path, Table.told_axes, Table.with_axes

    @property
    def span(self) -> tuple:
        """(least, largest) exponent n of a reading; rows are for n + 1."""
        return self.rows.lowest - 1.0, self.rows.highest - (self.rows.highest < MAX_EXPONENT)

    def covering(self, lowest: float, highest: float) -> tuple:
        """See `Table.covering`."""
        return lowest, min(highest + 1.0, MAX_EXPONENT)

    @property
    def height(self) -> int:
        """Rows of the image without markers."""
        return self.rows.rows * self.layers // CHANNELS

    @property
    def radii(self) -> np.ndarray:
        """Radii of the layers, shape (layers,)."""
        return 1.0 - (1.0 - np.linspace(0.0, 1.0, self.layers)) ** 2


TABLES = {
    table.name: table
    for table in (
        Table("phong", False, ColumnAxis(144, 5.0, 0.0), RowAxis(64, 0.10, 0.5)),
        Table("phong", True, ColumnAxis(144, 5.0, 0.0), RowAxis(104, 0.10, 0.5)),
        Table("blinn", False, ColumnAxis(192, 2.0, 3.0), RowAxis(96, 0.07, 0.85)),
        Table("blinn", True, ColumnAxis(192, 2.0, 3.0), RowAxis(264, 0.14, 0.75)),
        Table("disk", False, SineAxis(96, 0.3, 30.0), RowAxis(64, 0.10, 0.5)),
        VolumeTable(ColumnAxis(72, 1.0, 0.0), RowAxis(40, 0.10, 0.5), 12),
    )
}
_loaded = {}  # {name: (table with its file's axes, nodes, metadata)}


def _count(name, value, least) -> int:
    """`value`. Raises ValueError unless it is a whole number from `least` to _MOST."""
    if type(value) is not int or not least <= value <= _MOST:
        raise ValueError(f"{name}: {value!r} is no whole number from {least} to {_MOST}")
    return value


def check_range(lowest, highest) -> dict:
    """{"lowest", "highest"} of a range of exponents. Raises ParameterError for a range that is not allowed.

    A range ends at no less than twice its beginning: rows that are too close would differ by rounding alone.
    """
    ends = float(lowest), float(highest)
    if not MIN_EXPONENT <= ends[0] <= 0.5 * ends[1] <= 0.5 * MAX_EXPONENT:
        raise ParameterError("range", "range", ends, f"{ends[0]:g} .. {ends[1]:g} is not allowed: exponents go from "
                             f"{MIN_EXPONENT:g} to {MAX_EXPONENT:g}, and a range ends at no less than twice its "
                             "beginning", (MIN_EXPONENT, MAX_EXPONENT))
    return {"lowest": ends[0], "highest": ends[1]}


def folder() -> Path:
    """The folder of the tables' files, for reading and for bakes."""
    return _folder


def use_folder(path=None):
    """Set the folder of the tables' files to `path`, or, if None, to the package's own `luts`."""
    global _folder
    _folder = Path(path) if path else PACKAGED
    _loaded.clear()


def forget():
    """Forget the contents of the files, which have changed: the next use reads them again."""
    _loaded.clear()


def marked(table, nodes: np.ndarray) -> np.ndarray:
    """Image (rows + 2, columns, 4) float32 of a table: its nodes between the marker rows."""
    marker = np.empty((1, table.columns.columns, 4), np.float32)
    marker[...] = (MARK, table.stamp, 0.0, FORMAT)
    bottom = marker.copy()
    bottom[..., 2] = 1.0
    return np.concatenate([marker, nodes.astype(np.float32), bottom])


def in_use(name: str):
    """The table `name` with the axes of its file. Raises TableError as `load`."""
    return _file(name)[0]


def load(table) -> np.ndarray:
    """Nodes (rows, columns, 4) of a table, float64. Raises TableError, with the file and the cure."""
    stored, nodes, _ = _file(table.name)
    if stored != table:
        raise TableError(f"{table.path}: albedo table has the axes {stored.told_axes()}, where {table.told_axes()} are "
                         f"wanted; {_CURE}", "axes", table.path)
    return nodes


def resolution(name: str) -> str:
    """The resolution in the file of the table `name`, a key of `sizes.RESOLUTIONS`. Raises TableError as `load`."""
    return _file(name)[2].get(RESOLUTION, "standard")


def stated_error(name: str) -> float | None:
    """Largest relative error between nodes as stated in the table's file; None where it states none."""
    words = _file(name)[2].get(ERROR, "").split()
    try:
        return float(words[1])
    except (IndexError, ValueError):
        return None


_CURE = "run `plausible bake`, or Bake LUTs in the panel"


def _file(name):
    """(table with its file's axes, nodes, metadata); the file is read once."""
    if name not in _loaded:
        _loaded[name] = _checked(TABLES[name])
    return _loaded[name]


def check_file(name: str, path):
    """Raise TableError, as `load` does, where the file `path` cannot be the table `name`."""
    _checked(TABLES[name], Path(path))


def _checked(declared, path=None):
    """(table with its file's axes, nodes, metadata). Raises TableError as `load`."""
    # An image that can be read.
    path = path or declared.path
    try:
        image, metadata = exr.read(path)
    except FileNotFoundError:
        raise TableError(f"{path}: albedo table is missing; {_CURE}", "missing", path) from None
    except OSError as error:
        raise TableError(f"{path}: albedo table cannot be read ({error.strerror}); {_CURE}", "unreadable",
                         path) from None
    except exr.ExrError as error:
        raise TableError(f"{error}; {_CURE}", "image", path) from None
    # Its shape and markers are those of its axes.
    table = _as_told(declared, metadata, path)
    shape = (table.height + 2, table.columns.columns, 4)
    if image.shape != shape:
        raise TableError(f"{path}: albedo table is {image.shape}, expected {shape}: stale or resized; {_CURE}",
                         "resized", path)
    if np.any(image[[0, -1]] != marked(table, image[1:-1])[[0, -1]]):
        raise TableError(f"{path}: albedo table is stale: its axes are not this version's; {_CURE}", "stale", path)
    # Its numbers are albedos.
    nodes = image[1:-1].astype(np.float64)
    if not np.isfinite(nodes).all() or nodes.min() <= table.allowed[0] or nodes.max() > table.allowed[1]:
        raise TableError(f"{path}: albedo table holds impossible albedos; {_CURE}", "albedos", path)
    return table, nodes, metadata


def _as_told(declared, metadata, path):
    """A declared table with the axes in its file's metadata, if these have any."""
    if AXES not in metadata:
        return declared
    try:
        return declared.with_axes(**json.loads(metadata[AXES]))
    except (TypeError, ValueError) as error:
        raise TableError(f"{path}: albedo table tells impossible axes ({error}); {_CURE}", "impossible", path) from None


def covers(span, exponent: float) -> bool:
    """Whether an exponent is within the range `span`, (least, largest), up to SLACK."""
    return span[0] * (1.0 - SLACK) <= exponent <= span[1] * (1.0 + SLACK)


def require(name: str, exponents):
    """The table `name`, as `in_use`. Raises TableError where one of the `exponents` is beyond its range."""
    table = in_use(name)
    for exponent in (np.min(exponents), np.max(exponents)) if np.size(exponents) else ():
        if not covers(table.span, exponent):
            low, high = table.span
            raise TableError(f"exponent: {exponent:g} is outside {low:g} .. {high:g}, for which {table.path} is baked; "
                             "bake it for more exponents (`plausible bake --range`, or Bake LUTs in the panel)",
                             "range", table.path)
    return table


def albedos(lobe: str, control: bool, cos_theta, exponent: float) -> np.ndarray:
    """a_0 .. a_3 read bilinearly, shape (..., 4), for `cos_theta` (...,) and one exponent.

    Raises TableError as `load`, and where the exponent is beyond the range of the table in use.
    """
    table = require(f"{lobe}_{'controlled' if control else 'plain'}", exponent)
    return axes.read(load(table), table.columns, table.rows, cos_theta, exponent)


def volumes(mu_view, exponent, radius) -> np.ndarray:
    """Volume (N,) inside the disk of round lumps about the origin at N·V = `mu_view`; all arguments are (N,).

    Raises TableError as `albedos`.
    """
    table = require(VolumeTable.name, exponent)
    nodes = load(table).reshape(-1, table.rows.rows, table.columns.columns, 4)
    distance = disk.room(np.asarray(mu_view))
    volume, radii = np.empty(len(distance)), table.radii
    # One reading for each pair of exponent and radius, which are mostly the same for all views.
    for n, r in np.unique(np.stack([exponent, radius], axis=-1), axis=0):
        chosen = (exponent == n) & (radius == r)
        column = np.minimum(distance[chosen] / r, 1.0)
        layer = min(int((1.0 - np.sqrt(1.0 - r)) * (table.layers - 1)), table.layers - 2)
        low, high = (axes.read(nodes[k // CHANNELS], table.columns, table.rows, column, n + 1.0)[..., k % CHANNELS]
                     for k in (layer, layer + 1))
        volume[chosen] = low + (r - radii[layer]) / (radii[layer + 1] - radii[layer]) * (high - low)
    return volume
