"""Rows of the table of volumes: a lump's volume inside the disk, for four radii a row."""
import numpy as np

from ...models import disk
from . import axes


def provenance(table) -> dict:
    """Metadata of the table's image: model, source, grid and quadrature."""
    return {
        "plausible:model": "volume of a round lump about the origin inside the halfway vector disk",
        "plausible:source": "Edwards et al., The halfway vector disk for BRDF modeling, eq. 26 and last section",
        "plausible:grid": f"columns {table.columns!r}, rows {table.rows!r} of n + 1, {table.layers} radii, one "
                          "marker row above and below",
        "plausible:quadrature": "closed form along each direction, Gauss-Legendre over 41 x 8 directions",
    }


def volume(exponent, radius, columns, order=8) -> np.ndarray:
    """Volume (N,) of the lump of `radius` where the disk's edge is `columns` (N,) radii from the lump's center."""
    # For a lump of radius 0 the edge is straight; for a small lump it is nearly straight.
    return disk.volume_at(exponent, max(radius, 1e-4), columns, order)


def nodes(table, row) -> np.ndarray:
    """Volumes at the columns of one row for its four radii, shape (columns, 4)."""
    block, row = divmod(row, table.rows.rows)
    m = table.rows.exponents()[row]
    columns = table.columns.cosines(m)
    return np.stack([volume(m - 1.0, r, columns) for r in table.radii[4 * block: 4 * block + 4]], axis=-1)


def cell_errors(table, nodes, row, refined=False):
    """See `bake.cell_errors`. Cells lie between radii, too."""
    block, row_in_block = divmod(row, table.rows.rows)
    exponents = table.rows.exponents()
    image = nodes.reshape(-1, table.rows.rows, table.columns.columns, 4)
    node_error, worst = 0.0, 0.0
    m = exponents[row_in_block]
    for channel in range(4):
        layer = 4 * block + channel
        radius = table.radii[layer]
        # The row's own nodes, by a finer quadrature.
        if refined:
            truth = volume(m - 1.0, radius, table.columns.cosines(m), order=12)
            node_error = max(node_error, float(np.abs(image[block, row_in_block, :, channel] / truth - 1.0).max()))
        if row_in_block + 1 == len(exponents) or layer + 1 == table.layers:
            continue
        # Half-way to the next row and to the next radius: at the columns, and between them.
        between, middle = float(np.sqrt(m * exponents[row_in_block + 1])), 0.5 * (radius + table.radii[layer + 1])
        corners = table.columns.cosines(between)
        columns = np.concatenate([corners, 0.5 * (corners[1:] + corners[:-1])])
        low, high = (axes.read(image[k // 4], table.columns, table.rows, columns, between)[:, k % 4]
                     for k in (layer, layer + 1))
        truth = volume(between - 1.0, middle, columns)
        worst = max(worst, float(np.abs(0.5 * (low + high) / truth - 1.0).max()))
    return node_error, worst
