"""Reading between evenly laid nodes, by polynomials through six of them."""
import numpy as np

POINTS = 6


class Reader:
    """Reads nodes at places that are the same for many of them.

    `position` (...,) are numbers of nodes, with fractions, in a row of `count` nodes, of which the first has the number
    `first` of all; `count` and `first` are numbers, or one for each position.
    """

    def __init__(self, position, count, first=0):
        begin = np.clip(position.astype(int) - POINTS // 2 + 1, 0, count - POINTS)
        self._begin = first + begin
        self._weights = _lagrange(position - begin)

    def read(self, nodes) -> np.ndarray:
        """Values (...,) of nodes (N,)."""
        value = self._weights[0] * nodes[self._begin]
        for i, weight in enumerate(self._weights[1:], 1):
            value += weight * nodes[self._begin + i]
        return value


def _lagrange(t):
    """Weights (...,) of the nodes 0, 1, .. of a polynomial through them all, at `t` (...,)."""
    # Products of t - j over the nodes before each one, and over those after it.
    before, after = [np.ones_like(t)], [np.ones_like(t)]
    for j in range(POINTS - 1):
        before.append(before[-1] * (t - j))
        after.append(after[-1] * (t - (POINTS - 1 - j)))
    alone = [np.prod([float(i - j) for j in range(POINTS) if j != i]) for i in range(POINTS)]
    return [before[i] * after[POINTS - 1 - i] / alone[i] for i in range(POINTS)]
