"""Interpolation between evenly spaced nodes, by polynomials through six of them."""
import numpy as np

# The number of nodes that a polynomial passes through.
POINTS = 6


class Reader:
    """Interpolates any values at nodes to positions that are fixed at construction.

    `position` (...,) is a fractional index, 0 .. count - 1, in a row of `count` nodes. The row begins at the index
    `first` of the nodes passed to `read`. `count` and `first` are numbers, or arrays with one entry per position.
    """

    def __init__(self, position, count, first=0):
        begin = np.clip(position.astype(int) - POINTS // 2 + 1, 0, count - POINTS)
        self._begin = first + begin
        self._weights = _lagrange(position - begin)

    def read(self, nodes) -> np.ndarray:
        """Values (...,) at the positions, from values `nodes` (N,) at the nodes."""
        value = self._weights[0] * nodes[self._begin]
        for i, weight in enumerate(self._weights[1:], 1):
            value += weight * nodes[self._begin + i]
        return value


def _lagrange(t):
    """Lagrange's weights at `t` (...,) of the nodes 0 .. POINTS - 1: a list of POINTS arrays (...,)."""
    # Products of t - j over the nodes j before each node, and over the nodes after it.
    before, after = [np.ones_like(t)], [np.ones_like(t)]
    for j in range(POINTS - 1):
        before.append(before[-1] * (t - j))
        after.append(after[-1] * (t - (POINTS - 1 - j)))
    alone = [np.prod([float(i - j) for j in range(POINTS) if j != i]) for i in range(POINTS)]
    return [before[i] * after[POINTS - 1 - i] / alone[i] for i in range(POINTS)]
