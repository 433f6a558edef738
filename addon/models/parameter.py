"""A model's parameter: its name, its kind and the values that it takes."""
import math
import os
from dataclasses import dataclass

import numpy as np

from . import images
from .errors import ParameterError

# The sections in which nodes, panels and pages group parameters.
LOBE, RETROREFLECTION, COLOR, GEOMETRY, SAMPLING = "Lobe", "Retroreflection", "Color", "Geometry", "Sampling"


@dataclass(frozen=True)
class Parameter:
    """One input of a model.

    - `id`: the name in code and files. `label` and `help` are shown to users.
    - `kind`: "float", "int", "bool", "enum" (an int, the index in `items`), "color" (a tuple of linear RGB), "vector"
      (a tuple of three) or "image" (a file's path, as text).
    - `minimum`, `maximum`: the range of numbers, and of each channel of a color.
    - `items`: the choices of an enum, each (name, label, help).
    - `evaluated`: False for a parameter of the renderer's estimator, which the formula does not contain.
    - `logarithmic`: True for exponents. A lobe's width is in proportion to 1 / sqrt(exponent).
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
        """The section of nodes, panels and pages: one of LOBE, RETROREFLECTION, COLOR, GEOMETRY, SAMPLING."""
        if self.kind == "vector":
            return GEOMETRY
        if not self.evaluated:
            return SAMPLING
        if self.kind in ("color", "enum"):
            return COLOR
        return RETROREFLECTION if self.id.startswith("retro") else LOBE

    @property
    def can_be_driven(self) -> bool:
        """Whether a baked model can be baked over a range of the parameter, so that a link can drive it."""
        return self.evaluated and self.kind not in ("image", "vector")

    @property
    def is_whole(self) -> bool:
        """Whether the parameter is a switch, a choice or a count: it has no values between whole numbers."""
        return self.kind in ("bool", "int", "enum")

    @property
    def is_width(self) -> bool:
        """Whether the parameter scales a lobe's width: equal ratios are equal steps."""
        return self.kind == "float" and self.minimum > 0.0

    def usual_range(self, value) -> tuple:
        """(least, most): a first guess of a driven parameter's range, about the `value` of its unlinked socket."""
        if self.is_width:
            ratio = 4.0 if self.logarithmic else 2.0
            low, high = value / ratio, value * ratio
        elif self.kind == "color" and self.maximum > 1.0:
            low, high = 0.5 * min(value), max(2.0 * max(value), 1.0)
        else:
            low, high = self.minimum, self.maximum
        return max(low, self.minimum), min(high, self.maximum)

    def check(self, value):
        """Returns `value` converted to the parameter's type. An enum accepts an item's name, a color one number.

        Raises ParameterError, which names the value and the allowed values.
        """
        # Kinds that are no number.
        if self.kind in ("color", "vector"):
            return self._check_triple(value)
        if self.kind == "image":
            return self._check_path(value)
        if self.kind == "enum" and isinstance(value, str):
            names = [item[0] for item in self.items]
            if value not in names:
                raise ParameterError(self.id, "choice", value, f"{value!r} is not one of {', '.join(names)}", names)
            return names.index(value)
        # Numbers.
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
        """Clamps `value`, of the parameter's type, to the range. NaN becomes the default. A path is unchanged."""
        if self.kind == "image":
            return value
        if self.kind in ("color", "vector"):
            return tuple(min(max(c, self.minimum), self.maximum) if c == c else d
                         for c, d in zip(value, self.default, strict=True))
        return type(value)(min(max(value, self.minimum), self.maximum)) if value == value else self.default

    def single(self, value):
        """`value` rounded to single precision, as a socket stores it, and clamped to the range."""
        if self.kind in ("color", "vector"):
            value = tuple(float(np.float32(c)) for c in value)
        return self.clamp(float(np.float32(value)) if self.kind == "float" else value)

    def stamp(self, value) -> tuple:
        """The stamp of an image's file, which changes with the file. () for other kinds and for missing files."""
        return images.stamp(value) if self.kind == "image" and value else ()

    def _outside(self, value, text):
        return ParameterError(self.id, "range", value, f"{text} is outside {self.minimum:g} .. {self.maximum:g}",
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
