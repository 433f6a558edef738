"""A parameter of a model: what it is called, of which kind it is, and which values it takes."""
import math
import os
from dataclasses import dataclass

import numpy as np

from . import images
from .errors import ParameterError

# Sections that parameters are shown in, in nodes, panels and pages.
LOBE, RETROREFLECTION, COLOR, GEOMETRY, SAMPLING = "Lobe", "Retroreflection", "Color", "Geometry", "Sampling"


@dataclass(frozen=True)
class Parameter:
    """One input of a model.

    `kind` is "float", "int", "bool", "enum" (an int, the index among `items`), "color" (a tuple of linear RGB),
    "vector" (a tuple of three) or "image" (the path of a file, as text). `id` names it in code and files, `label` and
    `help` are shown; `items` are (name, label, help) each. Numbers, and each channel of a colour, are within `minimum`
    .. `maximum`. `evaluated` is False for a parameter of the renderer's estimator only, which the formula does not
    have. `logarithmic` is True for exponents: a lobe's width goes with 1 over the root of them.
    """

    id: str
    label: str
    kind: str
    default: object
    help: str
    minimum: float = 0.0
    maximum: float = 1.0
    unit: str = ""
    items: tuple = ()
    evaluated: bool = True
    logarithmic: bool = False

    @property
    def section(self) -> str:
        """Where it is shown: one of LOBE, RETROREFLECTION, COLOR, GEOMETRY, SAMPLING, by what it is."""
        if self.kind == "vector":
            return GEOMETRY
        if not self.evaluated:
            return SAMPLING
        if self.kind in ("color", "enum"):
            return COLOR
        return RETROREFLECTION if self.id.startswith("retro") else LOBE

    @property
    def can_be_driven(self) -> bool:
        """Whether a model that is baked for the parameter can be so over a range of it."""
        return self.evaluated and self.kind not in ("image", "vector")

    @property
    def is_whole(self) -> bool:
        """Whether it is a switch, a choice or a count, with nothing between its values."""
        return self.kind in ("bool", "int", "enum")

    @property
    def is_width(self) -> bool:
        """Whether it scales a lobe: equal ratios of it are equal steps."""
        return self.kind == "float" and self.minimum > 0.0

    def usual_range(self, value) -> tuple:
        """(least, most) of a driven parameter that has the `value` where nothing drives it: a first guess."""
        if self.is_width:
            times = 4.0 if self.logarithmic else 2.0
            low, high = value / times, value * times
        elif self.kind == "color" and self.maximum > 1.0:
            low, high = 0.5 * min(value), max(2.0 * max(value), 1.0)
        else:
            low, high = self.minimum, self.maximum
        return max(low, self.minimum), min(high, self.maximum)

    def check(self, value):
        """`value` in the parameter's type. Raises ParameterError that names the value and what is allowed."""
        if self.kind in ("color", "vector"):
            return self._check_triple(value)
        if self.kind == "image":
            return self._check_path(value)
        if self.kind == "enum" and isinstance(value, str):
            names = [item[0] for item in self.items]
            if value not in names:
                raise ParameterError(self.id, "choice", value, f"{value!r} is not one of {', '.join(names)}", names)
            return names.index(value)
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise ParameterError(self.id, "type", value, f"expected a number, got {value!r}") from None
        if not math.isfinite(number) or not self.minimum <= number <= self.maximum:
            raise self._outside(number, f"{number:g}")
        if self.kind == "float":
            return number
        if number != int(number):
            raise ParameterError(self.id, "type", number, f"expected a whole number, got {number:g}")
        return bool(number) if self.kind == "bool" else int(number)

    def clamp(self, value):
        """Clamps `value`, of the parameter's type, to the range; NaN becomes the default. A path stays as it is."""
        if self.kind == "image":
            return value
        if self.kind in ("color", "vector"):
            return tuple(min(max(c, self.minimum), self.maximum) if c == c else d
                         for c, d in zip(value, self.default, strict=True))
        return type(value)(min(max(value, self.minimum), self.maximum)) if value == value else self.default

    def single(self, value):
        """`value` as a socket holds it, in single precision; still within the range."""
        if self.kind in ("color", "vector"):
            value = tuple(float(np.float32(c)) for c in value)
        return self.clamp(float(np.float32(value)) if self.kind == "float" else value)

    def stamp(self, value) -> tuple:
        """The stamp of an image's file, which changes with it; () of other kinds, and where there is no file."""
        return images.stamp(value) if self.kind == "image" and value else ()

    def _outside(self, value, shown):
        return ParameterError(self.id, "range", value, f"{shown} is outside {self.minimum:g} .. {self.maximum:g}",
                              (self.minimum, self.maximum))

    def _check_path(self, value):
        if not isinstance(value, str | os.PathLike):
            raise ParameterError(self.id, "type", value, f"expected the path of an image, got {value!r}")
        path = os.fspath(value)
        if not isinstance(path, str) or not path.isprintable():
            raise ParameterError(self.id, "path", path, f"{path!r} is not the path of a file")
        return path

    def _check_triple(self, value):
        try:
            triple = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise ParameterError(self.id, "type", value, f"expected three numbers, got {value!r}") from None
        if triple.ndim == 0 and self.kind == "color":
            triple = np.full(3, float(triple))
        if triple.shape != (3,):
            raise ParameterError(self.id, "shape", value, f"expected three numbers, got shape {triple.shape}")
        if not np.isfinite(triple).all() or triple.min() < self.minimum or triple.max() > self.maximum:
            raise self._outside(tuple(triple.tolist()), triple.tolist())
        return tuple(triple.tolist())
