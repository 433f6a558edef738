"""Minimax fitting: minimizes the largest error by a sequence of linear programs in a trust region (Madsen, 1975)."""
import numpy as np

# The step of finite differences, as a fraction of a parameter's range.
STEP = 1e-5
# The trust region's first radius, and the radius at which the search ends.
RADIUS, LEAST_RADIUS = 0.1, 1e-6
# The search ends if the linear program predicts a smaller relative improvement than this.
GOOD = 1e-4
# Rows that each round adds to a linear program, and the largest number of rounds.
_ROWS, _ROUNDS = 100, 20


def minimise(residuals, start, steps: int = 60, progress=None):
    """Finds a local minimum of the largest |residuals(x)| in 0..1, from `start`. Returns (x, largest).

    `residuals(x)` returns the errors (m,) for x (n,), and is piecewise smooth. The search is deterministic. Its result
    is never worse than `start`. `progress(largest)` is called at each of at most `steps` steps. Needs SciPy.
    """
    x = np.array(start, dtype=np.float64)
    now = residuals(x)
    worst, radius = np.abs(now).max(), RADIUS
    if not np.isfinite(worst):
        return x, np.inf
    slope = None
    for _ in range(steps):
        # The best move of the linearized residuals.
        if slope is None:
            slope = _slope(residuals, x, now)
        move, predicted = _linear_program(now, slope, x, radius)
        if progress is not None:
            progress(worst)
        if worst - predicted <= GOOD * worst or radius < LEAST_RADIUS:
            break
        # The move is accepted if it improves. The radius follows the ratio of the true to the predicted improvement.
        moved = residuals(x + move)
        gained = (worst - np.abs(moved).max()) / (worst - predicted)
        if gained > 0.0:
            x, now, worst, slope = x + move, moved, np.abs(moved).max(), None
        radius = min(2.0 * radius, 0.5) if gained > 0.75 else radius / 3.0 if gained < 0.25 else radius
    return x, float(worst)


def _slope(residuals, x, now):
    """Derivatives (m, n) of the residuals `now` (m,) at x (n,), by differences away from the nearer bound."""
    slope = np.empty((len(now), len(x)))
    for i in range(len(x)):
        step = STEP if x[i] < 0.5 else -STEP
        slope[:, i] = (residuals(x + step * np.eye(len(x))[i]) - now) / step
    return slope


def _linear_program(now, slope, x, radius):
    """The move within `radius` and 0..1 that minimizes the largest |now + slope move|. Returns (move, largest)."""
    from scipy.optimize import linprog

    # Parameters without any effect stay as they are.
    idle = ~slope.any(axis=0)
    low = np.where(idle, 0.0, np.maximum(-radius, -x))
    high = np.where(idle, 0.0, np.minimum(radius, 1.0 - x))
    bounds = [*zip(low, high, strict=True), (0.0, None)]
    # A few rows determine the solution. Rows that exceed the predicted maximum after a move are added round by round.
    chosen, move, after = np.zeros(len(now), dtype=bool), np.zeros(len(x)), now
    for _ in range(_ROUNDS):
        size = np.where(chosen, 0.0, np.abs(after))
        chosen[np.argsort(-size, kind="stable")[:_ROWS]] = True
        a, b = slope[chosen], now[chosen]
        bound = -np.ones((len(b), 1))
        solution = linprog(np.append(np.zeros(len(x)), 1.0), np.block([[a, bound], [-a, bound]]),
                           np.concatenate([-b, b]), bounds=bounds, method="highs")
        if not solution.success:
            break
        move = solution.x[:-1]
        after = now + slope @ move
        if np.abs(after).max() <= solution.x[-1] * (1.0 + 1e-9) + 1e-12:
            break
    return move, float(np.abs(after).max())
