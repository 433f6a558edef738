"""What a model is compared with: values of f at pairs of directions, of another model or of a table, and the errors.

The errors are those of perceptual fitting (Neumann, Neumann, Szirmay-Kalos, report on albedo pumping-up, section 1.1):
relative ones of f (N·L), seen under a point light, and of the albedo, seen under a sky.
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

VIEWS = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0)  # degrees
FLOOR = 0.05  # of the peak: less is compared with this
ANGLES = ("theta_view", "theta_light", "phi")
COLUMNS = (("f",), ("f_r", "f_g", "f_b"))
_SHARPEST, _WIDEST = 0.002, 1.0  # slopes that nodes are made for


@dataclass(frozen=True)
class Samples:
    """Rows of `view`, `light` (N, 3), `value` f (N, 3) in 1/sr and `group` (N,), a number for each view.

    `weight` (N,) is the solid angle times N·L with which rows add up to the albedo of their view; 0 in views whose
    lights are too few for that.
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
        """Albedo of f = `value` (N, 3) at each view that has weights: (views, 3)."""
        sums = np.zeros((self.group.max() + 1, 3))
        np.add.at(sums, self.group, value * self.weight[:, None])
        return sums[self.integrable]

    @property
    def integrable(self):
        """Which views have weights, (views,)."""
        return np.bincount(self.group, self.weight) > 0.0


def of_model(model, values: dict, views=VIEWS, stretched: bool = False, polar: int = 6, azimuthal: int = 20) -> Samples:
    """A model with resolved `values`, at `views` (degrees from the normal), the lights dense where its lobe is.

    `stretched`: it is to be compared with a model that knows a tangent, so that views along and across it are taken, as
    where it knows one itself. `polar` and `azimuthal` as in `quadrature.hemisphere_nodes`.
    """
    narrowest = min(half_angles(model, values))
    # exp(-tan²β / w²) = 1/2.
    width = np.clip(np.tan(narrowest) / np.sqrt(np.log(2.0)), _SHARPEST, _WIDEST) if np.isfinite(narrowest) else _WIDEST
    stretched = stretched or knows_tangent(model)
    seen = view_at(np.maximum(np.cos(np.radians(views)), 1e-6))
    if stretched:
        seen = np.concatenate([seen, seen[:, [1, 0, 2]]])
    parts = [quadrature.hemisphere_nodes(view, width, not stretched, polar, azimuthal) for view in seen]
    group = np.repeat(np.arange(len(seen)), [len(light) for light, _ in parts])
    light, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    view = seen[group]
    return Samples(view, light, _value(model, view, light, values), group, weight)


def _value(model, view, light, values):
    """f (N, 3), from tables where it is pumped: a search asks for hundreds of exponents."""
    return rgb(model.with_albedos(TABULATED).evaluate(view, light, **values))


def knows_tangent(model) -> bool:
    """Whether a model's lobe may depend on the azimuth of the view."""
    return bool(model.axes) or getattr(model, "stretched", None) is not None


def errors(samples: Samples, model, values: dict, floor: float = FLOOR) -> tuple:
    """Errors of a model with resolved `values`: of f (N·L) at all rows (N, 3), and of the albedo (views, 3).

    They are differences of logarithms, of which the source speaks as that of vision, with `floor` times the peak of the
    view added to both values of f (N·L): without, a flank that nobody sees would decide. See `largest`.
    """
    value = _value(model, samples.view, samples.light, values)
    least = np.maximum(floor * samples.peaks, 1e-9 * samples.peaks.max())[samples.group][:, None]
    return (np.log((value * samples.light[:, 2:] + least) / (samples.cosine_weighted + least)),
            np.log((samples.albedos(value) + 1e-9) / (samples.albedos(samples.value) + 1e-9)))


def largest(errors: tuple) -> tuple:
    """The largest relative error of f (N·L), and of the albedo; None where there is none.

    Relative to the smaller of both values, for f (N·L) plus the floor's part of the peak: 1 is twice or half as much.
    """
    return tuple(float(np.expm1(np.abs(error).max())) if error.size else None for error in errors)


def apart(samples: Samples, model, values: dict):
    """The largest difference of f (N·L) at each view in parts of the samples' peak there, (views,)."""
    value = _value(model, samples.view, samples.light, values) * samples.light[:, 2:]
    worst = np.zeros(samples.group.max() + 1)
    np.maximum.at(worst, samples.group, np.abs(value - samples.cosine_weighted).max(axis=1))
    return worst / samples.peaks


# Tables.

def of_table(path) -> Samples:
    """The rows of a CSV file: columns theta_view, theta_light, phi (degrees) and f or f_r, f_g, f_b (1/sr), by name.

    phi is the azimuth of the light from that of the view, 180 on the mirror's side. Lines that begin with # are
    comments. A view whose lights fill a grid of theta_light, from at most 10 to at least 80 degrees, and phi has an
    albedo. Raises OSError where the file cannot be read, ValueError with file, line and value for what is wrong in it.
    """
    rows, names = _read(Path(path))
    table = np.array(rows)
    view, light, phi = (np.radians(table[:, names.index(name)]) for name in ANGLES)
    value = rgb(table[:, len(ANGLES):].squeeze(axis=1) if len(names) == len(ANGLES) + 1 else table[:, len(ANGLES):])
    if not value.any():
        raise ValueError(f"{path}: every value of f is 0")
    _, group = np.unique(view, return_inverse=True)
    weight = np.zeros(len(view))
    for number in range(group.max() + 1):
        chosen = group == number
        weight[chosen] = _solid_angles(light[chosen], phi[chosen])
    across = np.sin(light)[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    return Samples(view_at(np.cos(view)), np.concatenate([across, np.cos(light)[:, None]], axis=1), value, group,
                   weight * np.cos(light))


def _read(path):
    """Rows of numbers and the names of their columns, the angles first."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not a text file") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1)
             if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise ValueError(f"{path}: there is no header line")
    head, *body = csv.reader(line for _, line in lines)
    head = [name.strip() for name in head]
    names = next((ANGLES + each for each in COLUMNS if set(ANGLES + each) == set(head)), None)
    if names is None or len(head) != len(names):
        raise ValueError(f"{path}, line {lines[0][0]}: expected the columns {', '.join(ANGLES)} and f or f_r, f_g, "
                         f"f_b, got {', '.join(head)}")
    if not body:
        raise ValueError(f"{path}: there are no rows")
    numbers = (number for number, _ in lines[1:])
    order = [head.index(name) for name in names]
    return [_row(f"{path}, line {number}", row, names, order) for number, row in zip(numbers, body, strict=True)], names


def _row(where, row, names, order):
    if len(row) != len(names):
        raise ValueError(f"{where}: expected {len(names)} values, got {len(row)}")
    return [_number(where, name, row[i]) for name, i in zip(names, order, strict=True)]


def _number(where, name, text):
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
    """Solid angle of each of a view's rows (N,) by the trapezoidal rule; zeros where they fill no grid."""
    turn = np.round(np.mod(phi, 2.0 * np.pi), 9)
    polar, i = np.unique(theta, return_inverse=True)
    around, j = np.unique(turn, return_inverse=True)
    filled = len(np.unique(i * len(around) + j)) == len(theta) == len(polar) * len(around)
    if not filled or len(polar) < 5 or len(around) < 5 or polar[0] > np.radians(10.0) or polar[-1] < np.radians(80.0):
        return np.zeros(len(theta))
    if around[0] == 0.0 and abs(around[-1] - np.pi) < 1e-6:  # one side of the plane of incidence
        arc = 2.0 * _trapezoids(around)
    else:
        gaps = np.diff(around, append=around[0] + 2.0 * np.pi)
        arc = 0.5 * (gaps + np.roll(gaps, 1))
        if gaps.max() > 0.5 * np.pi:
            return np.zeros(len(theta))
    return (_trapezoids(polar) * np.sin(polar))[i] * arc[j]


def _trapezoids(x):
    """Weights of the trapezoidal rule at `x`."""
    gaps = np.diff(x)
    return 0.5 * (np.append(gaps, 0.0) + np.insert(gaps, 0, 0.0))


def half_angle(samples: Samples) -> float:
    """Half-angle (radians) of a table, at its view nearest to the normal, as `match.half_angle` is of a model.

    The normalised f is read between rows at neighbouring angles of the half vector. Infinite where it does not fall.
    """
    chosen = samples.group == samples.group[samples.view[:, 2].argmax()]
    lean = half(samples.view[chosen], samples.light[chosen])[:, 2]
    beta = np.arccos(np.clip(lean, -1.0, 1.0))
    f = samples.value[chosen].max(axis=1)
    order = np.argsort(beta, kind="stable")
    beta, f = beta[order], f[order] / max(f[order][0], 1e-300)
    fallen = np.nonzero(f <= 0.5)[0]
    if not len(fallen) or not fallen[0]:
        return np.inf
    i = fallen[0]
    return float(np.interp(0.5, [f[i], f[i - 1]], [beta[i], beta[i - 1]]))
