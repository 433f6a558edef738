"""Axes of the albedo tables: the positions of the nodes, and the interpolation between them.

Rows are even in n^-density over the table's range of exponents; the whole range is 1 to 100000. They are nearly
logarithmic, but denser towards small n, where controlled pumping begins to have an effect. Between two rows a reading
is linear in n^-law, the law of the grazing albedo at large n.

Columns: an albedo changes within angles of the lobe's width 1/sqrt(n) from grazing (Blinn's also from the normal). So
the nodes are dense there, at every exponent in the same proportion. Between two columns a reading is linear in the law
that the plain albedo approaches: mu for Phong, far from grazing; mu^2 for Blinn, with a linear part at grazing; the
sine of the angle for the reciprocal disk, whose albedo has a cusp at the normal.
"""
from dataclasses import dataclass

import numpy as np

from ...models.parameters import MAX_EXPONENT, MIN_EXPONENT


@dataclass(frozen=True)
class ColumnAxis:
    """Columns of one lobe's tables: `columns` of them, with densities `grazing` and `normal` at both ends.

    With `normal` = 0: mu = sinh(t asinh(k)) / k, k = grazing sqrt(n), t = i / (columns - 1).
    Otherwise cot(theta) = sinh(t asinh(k c)) / k with c = normal sqrt(n) and t = i / (columns - 2): as dense towards
    the normal as towards grazing. The last column is the normal itself.
    """

    columns: int
    grazing: float
    normal: float

    def _scales(self, exponent):
        """(k, asinh of k or of k c), see the class."""
        k = self.grazing * np.sqrt(exponent)
        return k, np.arcsinh(k * (self.normal * np.sqrt(exponent) if self.normal else 1.0))

    def cosines(self, exponent: float) -> np.ndarray:
        """N·V of the columns, shape (columns,), ascending from 0 to 1."""
        k, span = self._scales(exponent)
        if not self.normal:
            mu = np.sinh(np.linspace(0.0, span, self.columns)) / k
            mu[-1] = 1.0
            return mu
        z = np.sinh(np.linspace(0.0, span, self.columns - 1)) / k
        return np.append(z / np.sqrt(1.0 + z * z), 1.0)

    def position(self, cos_theta, exponent: float) -> np.ndarray:
        """Column number of each cosine, N·V: the cell's index plus the position in the cell, 0..1."""
        # The cell, by the inverse of `cosines`.
        mu = np.clip(np.asarray(cos_theta, dtype=np.float64), 0.0, 1.0)
        k, span = self._scales(exponent)
        if not self.normal:
            t = np.arcsinh(k * mu) / span * (self.columns - 1)
        else:
            z = mu / np.sqrt(np.maximum(1.0 - mu * mu, 1e-300))
            t = np.minimum(np.arcsinh(k * z) / span, 1.0) * (self.columns - 2)
        i = np.minimum(t.astype(int), self.columns - 2)
        # The position in it, by the law.
        q = self._law(self.cosines(exponent), k)
        return i + np.clip((self._law(mu, k) - q[i]) / (q[i + 1] - q[i]), 0.0, 1.0)

    def _law(self, mu, k):
        """The function of mu in which a reading between two columns is linear."""
        return mu * (mu + 1.0 / k) if self.normal else mu


@dataclass(frozen=True)
class SineAxis(ColumnAxis):
    """Columns as with `normal`; a reading is linear in the sine of the angle."""

    def _law(self, mu, k):
        return -np.sqrt(1.0 - mu * mu)


@dataclass(frozen=True)
class RowAxis:
    """Rows of one table: row j is at n^-density = a - (a - b) j / (rows - 1).

    a is that of the exponent `lowest`, and b that of `highest`. A reading between two rows is linear in n^-`law`.
    """

    rows: int
    density: float
    law: float
    lowest: float = MIN_EXPONENT
    highest: float = MAX_EXPONENT

    def __repr__(self):
        """The text of a call, without a whole range. A table's stamp depends on this text."""
        end = "" if self.is_whole else f", lowest={self.lowest!r}, highest={self.highest!r}"
        return f"RowAxis(rows={self.rows!r}, density={self.density!r}, law={self.law!r}{end})"

    @property
    def is_whole(self) -> bool:
        """Whether the rows cover all allowed exponents."""
        return (self.lowest, self.highest) == (MIN_EXPONENT, MAX_EXPONENT)

    def _start_and_step(self):
        """(a, (a - b) / (rows - 1)), see the class."""
        start = self.lowest**-self.density
        return start, (start - self.highest**-self.density) / (self.rows - 1)

    def exponents(self) -> np.ndarray:
        """Exponents of the rows, shape (rows,), ascending from `lowest` to `highest`."""
        start, step = self._start_and_step()
        n = (start - np.arange(self.rows) * step) ** (-1.0 / self.density)
        n[0], n[-1] = self.lowest, self.highest
        return n

    def position(self, exponent: float) -> float:
        """Row number of an exponent, clamped to the range: the cell's index plus the position in the cell, 0..1."""
        n = min(max(float(exponent), self.lowest), self.highest)
        start, step = self._start_and_step()
        j = min(max(int((start - n**-self.density) / step), 0), self.rows - 2)
        low, high = [(start - row * step) ** (self.law / self.density) for row in (j, j + 1)]
        return j + min(max((n**-self.law - low) / (high - low), 0.0), 1.0)


def read(nodes: np.ndarray, columns: ColumnAxis, rows: RowAxis, cos_theta, exponent: float) -> np.ndarray:
    """Bilinear reading (..., channels) of `nodes` (rows, columns, channels) at `cos_theta` (...,) and an `exponent`."""
    y = rows.position(exponent)
    j = min(int(y), rows.rows - 2)
    # A column has another cosine in the next row, but the same position on the lobe: rows blend at equal columns.
    row = nodes[j] + (y - j) * (nodes[j + 1] - nodes[j])
    x = columns.position(cos_theta, exponent)
    i = np.minimum(x.astype(int), columns.columns - 2)
    return row[i] + (x - i)[..., None] * (row[i + 1] - row[i])
