"""Rows of the albedo tables, one per exponent."""
import numpy as np

from ...models import lobes, pump_stages
from . import axes

QUADRATURE = "Gauss-Legendre over light angle and azimuth, 16 nodes an interval x 36"
_LOBES = {lobe.id: lobe for lobe in (lobes.PHONG, lobes.BLINN, lobes.DISK)}
_SOURCES = {"disk": "Edwards et al., The halfway vector disk, eq. 20, made symmetric; Neumann et al. eq. 16, 20"}


def provenance(table) -> dict:
    """Metadata of the table's image: model, source, grid and quadrature."""
    return {
        "plausible:model": f"albedo chain a_0..a_3 of the {table.lobe} lobe, "
                           f"{'controlled' if table.control else 'plain'} pumping",
        "plausible:source": _SOURCES.get(
            table.lobe, "Neumann, Neumann, Szirmay-Kalos, Albedo pumping-up, eq. 6, 16, 20, 21"),
        "plausible:grid": f"columns {table.columns!r}, rows {table.rows!r}, one marker row above and below",
        "plausible:quadrature": QUADRATURE,
    }


def nodes(table, row) -> np.ndarray:
    """a_0 .. a_3 at the columns of one row, shape (columns, 4), by quadrature."""
    exponent = table.rows.exponents()[row]
    return pump_stages.albedos(_LOBES[table.lobe], exponent, table.columns.cosines(exponent), table.control)


def cell_errors(table, nodes, row, refined=False):
    """See `bake.cell_errors`."""
    lobe, exponents = _LOBES[table.lobe], table.rows.exponents()
    node_error, worst = 0.0, 0.0
    # The row's own nodes, by a finer quadrature.
    if refined:
        mu = table.columns.cosines(exponents[row])
        truth = pump_stages.albedos(lobe, exponents[row], mu, table.control, polar=28, azimuthal=56)
        node_error = float(np.abs(nodes[row] / truth - 1.0).max())
    # Half-way to the next row: at the columns, and between them.
    if row + 1 < len(exponents):
        exponent = float(np.sqrt(exponents[row] * exponents[row + 1]))
        corners = table.columns.cosines(exponent)
        inside = [corners[:-1] + share * np.diff(corners) for share in (0.25, 0.5, 0.75)]
        mu = np.concatenate([corners, *inside])
        truth = pump_stages.albedos(lobe, exponent, mu, table.control)
        worst = float(np.abs(axes.read(nodes, table.columns, table.rows, mu, exponent) / truth - 1.0).max())
    return node_error, worst
