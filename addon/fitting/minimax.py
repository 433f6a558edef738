"""The smallest largest error: a sequence of linear programmes in a trust region (Madsen, 1975)."""
import numpy as np

STEP = 1e-5  # of finite differences, in parts of a range
RADIUS, LEAST_RADIUS = 0.1, 1e-6
GOOD = 1e-4  # relative improvement that ends the search when no more is promised
_ROWS, _ROUNDS = 100, 20


def minimise(residuals, start, steps: int = 60, progress=None):
    """`start` moved within 0..1 to where the largest |residuals(x)| is least nearby: (x, largest).

    `residuals(x)` of x (n,) gives the errors (m,), smooth but for edges. Deterministic; the result is never worse than
    `start`. `progress(largest)` is called at each of at most `steps` steps. Needs SciPy.
    """
    x = np.array(start, dtype=np.float64)
    now = residuals(x)
    worst, radius = np.abs(now).max(), RADIUS
    if not np.isfinite(worst):
        return x, np.inf
    slope = None
    for _ in range(steps):
        if slope is None:
            slope = _slope(residuals, x, now)
        move, promised = _programme(now, slope, x, radius)
        if progress is not None:
            progress(worst)
        if worst - promised <= GOOD * worst or radius < LEAST_RADIUS:
            break
        there = residuals(x + move)
        gained = (worst - np.abs(there).max()) / (worst - promised)
        if gained > 0.0:
            x, now, worst, slope = x + move, there, np.abs(there).max(), None
        radius = min(2.0 * radius, 0.5) if gained > 0.75 else radius / 3.0 if gained < 0.25 else radius
    return x, float(worst)


def _slope(residuals, x, now):
    """Derivatives (m, n), by steps away from the nearer bound."""
    slope = np.empty((len(now), len(x)))
    for i in range(len(x)):
        step = STEP if x[i] < 0.5 else -STEP
        slope[:, i] = (residuals(x + step * np.eye(len(x))[i]) - now) / step
    return slope


def _programme(now, slope, x, radius):
    """The move within `radius` and 0..1 that minimises the largest |now + slope move|, and that: (move, largest)."""
    from scipy.optimize import linprog

    idle = ~slope.any(axis=0)  # what changes nothing stays
    low = np.where(idle, 0.0, np.maximum(-radius, -x))
    high = np.where(idle, 0.0, np.minimum(radius, 1.0 - x))
    bounds = [*zip(low, high, strict=True), (0.0, None)]
    # Few rows decide, and which is not known: those that a move leaves above its promise join them.
    chosen, move, after = np.zeros(len(now), dtype=bool), np.zeros(len(x)), now
    for _ in range(_ROUNDS):
        size = np.where(chosen, 0.0, np.abs(after))
        chosen[np.argsort(-size, kind="stable")[:_ROWS]] = True
        a, b = slope[chosen], now[chosen]
        bound = -np.ones((len(b), 1))
        found = linprog(np.append(np.zeros(len(x)), 1.0), np.block([[a, bound], [-a, bound]]),
                        np.concatenate([-b, b]), bounds=bounds, method="highs")
        if not found.success:
            break
        move = found.x[:-1]
        after = now + slope @ move
        if np.abs(after).max() <= found.x[-1] * (1.0 + 1e-9) + 1e-12:
            break
    return move, float(np.abs(after).max())
