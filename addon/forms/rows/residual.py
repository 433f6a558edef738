"""The residual of a row: the formula minus its base, in cells of about equal energy."""
import numpy as np

from .lobe_rows import Residual
from .view_slice import RINGS, ViewSlice, half_vectors

FINE = 0.35  # share of the cells' edges that are spaced without regard to energy
_PARTS = 4  # samples of a cell each way, for the share of its lights above the horizon


def cut(view_slice: ViewSlice, density, albedo: float) -> Residual:
    """The residual of a row with the `density` (RINGS, turns, channels), as `ViewSlice.density`.

    `albedo` is its albedo in the strongest channel. Rings, and the cells of a ring, are narrow where that channel has
    energy, and nowhere very wide: a cell's energy is even over the cell.
    """
    # The rings, from the cumulative energy.
    energy = view_slice.area[..., None] * density
    before = np.concatenate([np.zeros((1, *energy.shape[1:])), np.cumsum(energy, axis=0)])  # (RINGS + 1, turns, c)
    strongest = before[-1].sum(axis=0).argmax()
    edges2 = _squared_ring_edges(view_slice, before[..., strongest].sum(axis=1))
    # The cells of each ring, from the energies up to the ring's edges, (turns, edges, channels).
    inside = np.stack([[np.interp(edges2, view_slice.ring_edges**2, before[:, t, c]) for t in range(energy.shape[1])]
                       for c in range(energy.shape[2])], axis=-1)
    rings = [_cut_ring(view_slice.layout, ring, strongest) for ring in np.diff(inside, axis=1).transpose(1, 0, 2)]
    ring_edges, cell_edges = np.sqrt(edges2), np.array([edges for edges, _ in rings])
    # Energies per cell as `Residual` has them.
    energies = np.array([energies for _, energies in rings])
    energies = energies * view_slice.layout.cell_rings * view_slice.layout.cell_turns
    energies = energies / _lit_share(view_slice, ring_edges, cell_edges)[..., None]
    return Residual(albedo, albedo / max(*view_slice.albedo, 1e-12), ring_edges, cell_edges, energies)


def _squared_ring_edges(view_slice, before):
    """Squared edges (cell_rings + 1,) of the cells' rings.

    `before` (RINGS + 1,) is the energy inside each edge of the slice's rings.
    """
    if not before[-1] > 0.0:
        before = np.linspace(0.0, 1.0, RINGS + 1)
    share = (1.0 - FINE) * before / before[-1] + FINE * np.linspace(0.0, 1.0, RINGS + 1)
    return np.interp(np.linspace(0.0, 1.0, view_slice.layout.cell_rings + 1), share, view_slice.ring_edges**2)


def _cut_ring(layout, ring, strongest):
    """(edges (cell_turns + 1,) in radians, energies (cell_turns, channels)) of a ring's cells.

    `ring` (turns, channels) are the energies around it, and `strongest` is a channel.
    """
    phi = np.linspace(0.0, layout.around, len(ring) + 1)
    before = np.concatenate([np.zeros((1, ring.shape[1])), np.cumsum(ring, axis=0)])
    total = before[-1, strongest]
    share = before[:, strongest] / total if total > 0.0 else phi / phi[-1]
    share = (1.0 - FINE) * share + FINE * phi / phi[-1]
    edges = np.interp(np.linspace(0.0, share[-1], layout.cell_turns + 1), share, phi)
    return edges, np.diff([np.interp(edges, phi, before[:, c]) for c in range(ring.shape[1])], axis=1).T


def _lit_share(view_slice, ring_edges, cell_edges):
    """Share of each cell (rings, turns) whose lights are above the horizon: only that part can have kernels."""
    within = (np.arange(_PARTS) + 0.5) / _PARTS
    size2 = ring_edges[:-1, None] ** 2 + np.diff(ring_edges**2)[:, None] * within
    phi = cell_edges[:, :-1, None] + np.diff(cell_edges, axis=1)[..., None] * within
    half = half_vectors(view_slice.layout, np.sqrt(size2)[:, None, :, None], phi[:, :, None, :])
    above = 2.0 * (half @ view_slice.view) * half[..., 2] > view_slice.view[2]
    return np.maximum(above.mean(axis=(2, 3)), 1.0 / _PARTS**2)
