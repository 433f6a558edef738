"""A row of lobe rows as osl/include/weights.h shows it, and Beckmann's facets written anew."""
import numpy as np


class Row:
    """A row as osl/include/weights.h shows it."""

    def __init__(self, baked, index):
        row = baked.row(index)
        self.layout, self.view = baked.layout, baked.layout.view_directions()[index]
        self.facets, self.diffuse = row.facets, row.diffuse
        self.rings, self.turns = row.residual.ring_edges, row.residual.cell_edges
        self.energies = row.residual.energies

    def base(self, light):
        """f (N·L) of the base, (N, 3): Beckmann's microfacets with Smith's masking."""
        total = light[:, 2:] / np.pi * self.diffuse
        for (x, y), widths, color in self.facets.each():
            for side in ((y, -y) if y and self.layout.azimuths == 1 else (y,)):
                total = total + beckmann((x, side), widths, self.view, light)[:, None] * color
        return total

    def kernels(self, count=30000):
        """Lights (N, 3) that the shader draws, on a lattice over its numbers, and the energy of each (N, channels)."""
        layout = self.layout
        k = np.arange(count)
        u, v = (k + 0.5) / len(k), (k * 0.6180339887498949) % 1.0
        side = np.ones(len(k))
        if layout.azimuths == 1:
            side, v = np.where(v < 0.5, 1.0, -1.0), (2.0 * v) % 1.0
        ring, turn = layout.cell_rings * u, layout.cell_turns * v
        i, j = ring.astype(int), turn.astype(int)
        s = np.sqrt(self.rings[i] ** 2 * (1.0 - ring + i) + self.rings[i + 1] ** 2 * (ring - i))
        phi = side * (self.turns[i, j] * (1.0 - turn + j) + self.turns[i, j + 1] * (turn - j))
        x, y = s * np.cos(phi) * layout.stretch[0], s * np.sin(phi) * layout.stretch[1]
        h = np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)
        light = 2.0 * (h @ self.view)[:, None] * h - self.view
        return light, np.where(light[:, 2:] > 0.0, self.energies[i, j], 0.0) / len(k)


def beckmann(slopes, widths, view, light):
    """f (N·L) (N,) of Beckmann's facets about the normal of `slopes`, of `widths` along and across."""
    n = np.array([*slopes, 1.0])
    n /= np.linalg.norm(n)
    t = np.cross([0.0, 1.0, 0.0], n)
    t /= np.linalg.norm(t)
    frame = np.stack([t, np.cross(n, t), n])
    v, light = frame @ view, light @ frame.T
    h = light + v
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    d = np.exp(-((h[:, 0] / widths[0]) ** 2 + (h[:, 1] / widths[1]) ** 2) / np.maximum(h[:, 2], 1e-9) ** 2)
    d /= np.pi * widths[0] * widths[1] * np.maximum(h[:, 2], 1e-3) ** 4

    def masking(w):
        a = w[..., 2] / np.maximum(np.hypot(w[..., 0] * widths[0], w[..., 1] * widths[1]), 1e-9)
        # Cycles uses the rational form of Walter et al., within 1 % of the form with erf.
        return np.where(a < 1.6, (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)

    value = d / (4.0 * v[2] * (1.0 + masking(v) + masking(np.maximum(light, [-2.0, -2.0, 1e-6]))))
    return np.where((v[2] > 0.0) & (light[:, 2] > 0.0) & (h[:, 2] > 0.0), value, 0.0)
