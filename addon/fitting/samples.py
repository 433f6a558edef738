"""Samples of f at pairs of directions, from a model or from a table, and a model's errors at them.

The errors are those of perceptual fitting (Neumann, Neumann, Szirmay-Kalos, report on albedo pumping-up, section 1.1):
the relative error of f (N·L), which a point light shows, and that of the albedo, which a sky shows.
"""
import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..forms.albedo.tabulated import TABULATED
from ..models import quadrature
from ..models.channels import rgb
from ..models.geometry import half, view_at
from .match import half_angles

# Angles of the views, in degrees.
VIEWS = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0)
# The floor of relative errors, as a fraction of a view's peak.
FLOOR = 0.05
# A table's columns: angles, and values with one channel or with three.
ANGLES = ("theta_view", "theta_light", "phi")
COLUMNS = (("f",), ("f_r", "f_g", "f_b"))
# The range of a lobe's slope, to which the nodes are fitted.
_SHARPEST, _WIDEST = 0.002, 1.0


@dataclass(frozen=True)
class Samples:
    """Samples of f, one per row.

    - `view`, `light` (N, 3): unit vectors.
    - `value` (N, 3): f in 1/sr.
    - `group` (N,): the index of the row's view.
    - `weight` (N,): the solid angle times N·L, so that a view's rows add up to its albedo. It is 0 if the view has too
      few lights for an albedo.
    """

    view: np.ndarray
    light: np.ndarray
    value: np.ndarray
    group: np.ndarray
    weight: np.ndarray

    @property
    def cosine_weighted(self):
        """f (N·L), (N, 3)."""
        return self.value * self.light[:, 2:]

    @property
    def peaks(self):
        """The largest f (N·L) of each view, over all channels, (views,)."""
        peaks = np.zeros(self.group.max() + 1)
        np.maximum.at(peaks, self.group, self.cosine_weighted.max(axis=1))
        return peaks

    def albedos(self, value):
        """Albedo of f = `value` (N, 3) at each view that has weights: (integrable views, 3)."""
        sums = np.zeros((self.group.max() + 1, 3))
        np.add.at(sums, self.group, value * self.weight[:, None])
        return sums[self.integrable]

    @property
    def integrable(self):
        """Whether each view has weights, (views,)."""
        return np.bincount(self.group, self.weight) > 0.0


def of_model(model, values: dict, views=VIEWS, stretched: bool = False, polar: int = 6, azimuthal: int = 20) -> Samples:
    """Samples of a model with resolved `values`, at `views` in degrees from the normal. Lights are dense in its lobe.

    If the model has a tangent, or if `stretched`, the views lie along the tangent and across it. `stretched` is for
    comparison with another model that has a tangent. `polar` and `azimuthal` are those of
    `quadrature.hemisphere_nodes`.
    """
    # The lobe's slope sets the density of lights.
    narrowest = min(half_angles(model, values))
    # exp(-tan²β / w²) = 1/2.
    width = np.clip(np.tan(narrowest) / np.sqrt(np.log(2.0)), _SHARPEST, _WIDEST) if np.isfinite(narrowest) else _WIDEST
    # The views.
    stretched = stretched or knows_tangent(model)
    seen = view_at(np.maximum(np.cos(np.radians(views)), 1e-6))
    if stretched:
        seen = np.concatenate([seen, seen[:, [1, 0, 2]]])
    # The lights of each view, and all rows.
    nodes = [quadrature.hemisphere_nodes(view, width, not stretched, polar, azimuthal) for view in seen]
    group = np.repeat(np.arange(len(seen)), [len(light) for light, _ in nodes])
    light, weight = (np.concatenate(column) for column in zip(*nodes, strict=True))
    view = seen[group]
    return Samples(view, light, _value(model, view, light, values), group, weight)


def _value(model, view, light, values):
    """f (N, 3) in 1/sr, with tabulated albedos: a search needs hundreds of exponents."""
    return rgb(model.with_albedos(TABULATED).evaluate(view, light, **values))


def knows_tangent(model) -> bool:
    """Whether a model's lobe may depend on the view's azimuth."""
    return bool(model.axes) or getattr(model, "stretched", None) is not None


def errors(samples: Samples, model, values: dict, floor: float = FLOOR) -> tuple:
    """Errors of a model with resolved `values`: of f (N·L) at the rows, (N, 3), and of the albedo, (views, 3).

    Errors are differences of logarithms, by which the source describes vision. `floor` times the view's peak is added
    to both values of f (N·L), since otherwise a lobe's invisible flank would determine the largest error. See
    `largest`.
    """
    value = _value(model, samples.view, samples.light, values)
    least = np.maximum(floor * samples.peaks, 1e-9 * samples.peaks.max())[samples.group][:, None]
    return (np.log((value * samples.light[:, 2:] + least) / (samples.cosine_weighted + least)),
            np.log((samples.albedos(value) + 1e-9) / (samples.albedos(samples.value) + 1e-9)))


def largest(errors: tuple) -> tuple:
    """The largest relative errors of f (N·L) and of the albedo, from `errors`. None if there are no rows.

    An error is relative to the smaller of the two values, which for f (N·L) include the floor. An error of 1 is twice
    or half the value.
    """
    return tuple(float(np.expm1(np.abs(error).max())) if error.size else None for error in errors)


def apart(samples: Samples, model, values: dict):
    """The largest difference of f (N·L) at each view, as a fraction of the samples' peak at this view, (views,)."""
    value = _value(model, samples.view, samples.light, values) * samples.light[:, 2:]
    worst = np.zeros(samples.group.max() + 1)
    np.maximum.at(worst, samples.group, np.abs(value - samples.cosine_weighted).max(axis=1))
    return worst / samples.peaks


# Tables.

def of_table(path) -> Samples:
    """Samples from a CSV file with the columns theta_view, theta_light, phi (degrees) and f or f_r, f_g, f_b (1/sr).

    The header names the columns, in any order. phi is the light's azimuth relative to the view's, 180 in the mirror
    direction. Lines that begin with # are comments. A view has an albedo if its lights fill a grid of theta_light and
    phi, with theta_light from at most 10 to at least 80 degrees. Raises OSError if the file cannot be read, and
    ValueError, with file, line and value, if its contents are wrong.
    """
    # The columns, in radians and 1/sr.
    rows, names = _read(Path(path))
    table = np.array(rows)
    view, light, phi = (np.radians(table[:, names.index(name)]) for name in ANGLES)
    value = rgb(table[:, len(ANGLES):].squeeze(axis=1) if len(names) == len(ANGLES) + 1 else table[:, len(ANGLES):])
    if not value.any():
        raise ValueError(f"{path}: every value of f is 0")
    # Views, and weights of the views whose lights fill a grid.
    _, group = np.unique(view, return_inverse=True)
    weight = np.zeros(len(view))
    for number in range(group.max() + 1):
        chosen = group == number
        weight[chosen] = _solid_angles(light[chosen], phi[chosen])
    # Directions.
    across = np.sin(light)[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    return Samples(view_at(np.cos(view)), np.concatenate([across, np.cos(light)[:, None]], axis=1), value, group,
                   weight * np.cos(light))


def _read(path):
    """Rows of numbers and the names of their columns, the angles first."""
    # Lines with content, numbered from 1.
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not a text file") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1)
             if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise ValueError(f"{path}: there is no header line")
    # The header's columns.
    head, *body = csv.reader(line for _, line in lines)
    head = [name.strip() for name in head]
    names = next((ANGLES + columns for columns in COLUMNS if set(ANGLES + columns) == set(head)), None)
    if names is None or len(head) != len(names):
        raise ValueError(f"{path}, line {lines[0][0]}: expected the columns {', '.join(ANGLES)} and f or f_r, f_g, "
                         f"f_b, got {', '.join(head)}")
    # The rows, with the angles first.
    if not body:
        raise ValueError(f"{path}: there are no rows")
    numbers = (number for number, _ in lines[1:])
    order = [head.index(name) for name in names]
    return [_row(f"{path}, line {number}", row, names, order) for number, row in zip(numbers, body, strict=True)], names


def _row(where, row, names, order):
    """The numbers of a row of texts, in the `order` of columns. `where` is the file and line, for messages."""
    if len(row) != len(names):
        raise ValueError(f"{where}: expected {len(names)} values, got {len(row)}")
    return [_number(where, name, row[i]) for name, i in zip(names, order, strict=True)]


def _number(where, name, text):
    """The number `text` of the column `name`. Raises ValueError if it is no number or is outside the column's range."""
    try:
        number = float(text)
    except ValueError:
        raise ValueError(f"{where}: {name}: expected a number, got {text.strip()!r}") from None
    if name == "phi":
        low, high, allowed = -360.0, 360.0, "-360 .. 360"
    elif name in ANGLES:
        low, high, allowed = 0.0, math.nextafter(90.0, 0.0), "0 .. 90 (90 itself is not allowed)"
    else:
        low, high, allowed = 0.0, math.nextafter(math.inf, 0.0), "0 .. (finite)"
    if not low <= number <= high:
        raise ValueError(f"{where}: {name}: {number:g} is outside {allowed}")
    return number


def _solid_angles(theta, phi):
    """Solid angles (N,) of one view's rows by the trapezoidal rule, or zeros if the rows do not fill a grid."""
    # A grid has one row for each pair of a polar angle and an azimuth.
    turn = np.round(np.mod(phi, 2.0 * np.pi), 9)
    polar, i = np.unique(theta, return_inverse=True)
    around, j = np.unique(turn, return_inverse=True)
    filled = len(np.unique(i * len(around) + j)) == len(theta) == len(polar) * len(around)
    if not filled or len(polar) < 5 or len(around) < 5 or polar[0] > np.radians(10.0) or polar[-1] < np.radians(80.0):
        return np.zeros(len(theta))
    # The azimuths cover one side of the plane of incidence, which then counts twice, or the whole turn.
    if around[0] == 0.0 and abs(around[-1] - np.pi) < 1e-6:
        arc = 2.0 * _trapezoids(around)
    else:
        gaps = np.diff(around, append=around[0] + 2.0 * np.pi)
        arc = 0.5 * (gaps + np.roll(gaps, 1))
        if gaps.max() > 0.5 * np.pi:
            return np.zeros(len(theta))
    return (_trapezoids(polar) * np.sin(polar))[i] * arc[j]


def _trapezoids(x):
    """Weights (N,) of the trapezoidal rule with nodes `x` (N,), ascending."""
    gaps = np.diff(x)
    return 0.5 * (np.append(gaps, 0.0) + np.insert(gaps, 0, 0.0))


def half_angle(samples: Samples) -> float:
    """Half-angle (radians) of a table at the view nearest to the normal. `match.half_angle` is that of a model.

    The normalized f is interpolated between rows at neighboring angles of the half vector. The half-angle is infinite
    if f does not fall to half.
    """
    # f over the half vector's angle, relative to its value at the smallest angle.
    chosen = samples.group == samples.group[samples.view[:, 2].argmax()]
    lean = half(samples.view[chosen], samples.light[chosen])[:, 2]
    beta = np.arccos(np.clip(lean, -1.0, 1.0))
    f = samples.value[chosen].max(axis=1)
    order = np.argsort(beta, kind="stable")
    beta, f = beta[order], f[order] / max(f[order][0], 1e-300)
    # Interpolation between the first value of at most 1/2 and the value before it.
    fallen = np.nonzero(f <= 0.5)[0]
    if not len(fallen) or not fallen[0]:
        return np.inf
    i = fallen[0]
    return float(np.interp(0.5, [f[i], f[i - 1]], [beta[i], beta[i - 1]]))
