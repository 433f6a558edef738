"""The tables: which exist, where their files are, and reading them with every check before the first use.

A file is an RGBA float image between two marker rows. An albedo table has one row per exponent with a_0 .. a_3 in the
channels. The table of volumes has a block of such rows for every four radii, one in each channel. A marker
holds (-1, stamp, 0 at the top or 1 at the bottom, format): no albedo is negative, the stamp belongs to the table's
axes, and the third number tells a shader whether its texture call counts rows from the top or from the bottom.
"""
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import axes, disk, exr
from .axes import ColumnAxis, RowAxis, SineAxis

FORMAT = 1
PACKAGED = Path(__file__).resolve().parents[2] / "luts"
_folder = PACKAGED


class TableError(ValueError):
    """An albedo table is missing, stale or damaged; the message names the file and what to do."""


@dataclass(frozen=True)
class Table:
    """One albedo table: the chain of a lobe, plain or controlled, over (cos theta, exponent)."""

    lobe: str
    control: bool
    columns: ColumnAxis
    rows: RowAxis

    allowed = (0.0, 1.4)

    @property
    def name(self) -> str:
        return f"{self.lobe}_{'controlled' if self.control else 'plain'}"

    @property
    def height(self) -> int:
        """Rows of the image without markers."""
        return self.rows.rows

    @property
    def stamp(self) -> float:
        """A number in 0..1 that changes with the axes, the lobe or the format; exact in float32."""
        return (zlib.crc32(f"{FORMAT} {self!r}".encode()) % 65521) / 65536.0

    @property
    def path(self) -> Path:
        return _folder / f"{self.name}.exr"


@dataclass(frozen=True)
class VolumeTable:
    """Volume that a round lump about the origin keeps inside the disk, over (view, exponent, radius R).

    The disk's edge is 1 - sin theta away from the lump's centre. Columns are that distance in parts of R, as
    `ColumnAxis` for n + 1; so are rows. `layers` radii lie from 0 to 1, denser towards 1, where a lump is as round as
    the disk, and blend linearly.
    """

    columns: ColumnAxis
    rows: RowAxis
    layers: int

    name = "disk_volume"
    allowed = (0.0, 1.0 + 1e-6)

    stamp, path = Table.stamp, Table.path

    @property
    def height(self) -> int:
        """Rows of the image without markers."""
        return self.rows.rows * self.layers // 4

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
_loaded = {}


def folder() -> Path:
    """The folder that tables are read from and baked to."""
    return _folder


def use_folder(path=None):
    """Read and bake tables in `path`, or in the package's own `luts` again when None."""
    global _folder
    _folder = Path(path) if path else PACKAGED
    _loaded.clear()


def forget():
    """Read the files again at the next use: they have changed."""
    _loaded.clear()


def marked(table, nodes: np.ndarray) -> np.ndarray:
    """Image (rows + 2, columns, 4) float32 of a table: its nodes between the marker rows."""
    marker = np.empty((1, table.columns.columns, 4), np.float32)
    marker[...] = (-1.0, table.stamp, 0.0, FORMAT)
    bottom = marker.copy()
    bottom[..., 2] = 1.0
    return np.concatenate([marker, nodes.astype(np.float32), bottom])


def load(table) -> np.ndarray:
    """Nodes (rows, columns, 4) of a table, float64. Raises TableError that names the file and the cure."""
    if table.name not in _loaded:
        _loaded[table.name] = _checked(table)
    return _loaded[table.name]


def _checked(table) -> np.ndarray:
    cure = "run `plausible bake`, or Bake LUTs in the panel"
    try:
        image, _ = exr.read(table.path)
    except FileNotFoundError:
        raise TableError(f"{table.path}: albedo table is missing; {cure}") from None
    except OSError as error:
        raise TableError(f"{table.path}: albedo table cannot be read ({error.strerror}); {cure}") from None
    except exr.ExrError as error:
        raise TableError(f"{error}; {cure}") from None
    shape = (table.height + 2, table.columns.columns, 4)
    if image.shape != shape:
        raise TableError(f"{table.path}: albedo table is {image.shape}, expected {shape}: stale or resized; {cure}")
    if np.any(image[[0, -1]] != marked(table, image[1:-1])[[0, -1]]):
        raise TableError(f"{table.path}: albedo table is stale: its axes are not this version's; {cure}")
    nodes = image[1:-1].astype(np.float64)
    if not np.isfinite(nodes).all() or nodes.min() <= table.allowed[0] or nodes.max() > table.allowed[1]:
        raise TableError(f"{table.path}: albedo table holds impossible albedos; {cure}")
    return nodes


def albedos(lobe: str, control: bool, cos_theta, exponent: float) -> np.ndarray:
    """a_0 .. a_3 read bilinearly, shape (..., 4), for `cos_theta` (...,) and one exponent."""
    table = TABLES[f"{lobe}_{'controlled' if control else 'plain'}"]
    return axes.read(load(table), table.columns, table.rows, cos_theta, exponent)


def volumes(mu_view, exponent, radius) -> np.ndarray:
    """Volume (N,) of round lumps about the origin inside the disk at N·V = `mu_view`; all arguments (N,)."""
    table = TABLES[VolumeTable.name]
    nodes = load(table).reshape(-1, table.rows.rows, table.columns.columns, 4)
    distance = disk.room(np.asarray(mu_view))
    found, radii = np.empty(len(distance)), table.radii
    # Rows differ in exponent and radius alone, and both are mostly the same for all views.
    for n, r in np.unique(np.stack([exponent, radius], axis=-1), axis=0):
        chosen = (exponent == n) & (radius == r)
        column = np.minimum(distance[chosen] / r, 1.0)
        layer = min(int((1.0 - np.sqrt(1.0 - r)) * (table.layers - 1)), table.layers - 2)
        low, high = (axes.read(nodes[k // 4], table.columns, table.rows, column, n + 1.0)[..., k % 4]
                     for k in (layer, layer + 1))
        found[chosen] = low + (r - radii[layer]) / (radii[layer + 1] - radii[layer]) * (high - low)
    return found
