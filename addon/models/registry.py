"""The registry of models: sockets, panel, bake jobs, command line and tests are made of what is declared here, once."""
from dataclasses import dataclass, field

import numpy as np

from .errors import ArgumentError, DuplicateModel, UnknownModel, UnknownParameter
from .geometry import directions, paired
from .parameters import Parameter

MODELS = {}


@dataclass(frozen=True)
class Model:
    """A reflectance model as declared: names, parameters, formula and sources.

    The subclasses `LobeModel` and `DiskModel` say what it computes. All methods take the model's parameters by id and
    raise ValueError that names what is wrong. `width_parameter` names the parameter that widens or narrows the lobe,
    None where none does. The parameters `widened_with` it belong to other lobes and are scaled by the same factor. An
    exponent is the power of one of `power_bases`, which changes so that the power stays.
    """

    id: str
    label: str
    description: str
    parameters: tuple
    formula: str
    references: tuple
    width_parameter: str = field(default="exponent", kw_only=True)
    widened_with: tuple = field(default=(), kw_only=True)
    power_bases: tuple = field(default=(), kw_only=True)

    @property
    def axes(self) -> tuple:
        """The parameters that stretch the lobe along and across the tangent, by id; () where it is round."""
        ids = [p.id for p in self.parameters]
        pairs = [(name, f"{name[:-1]}v") for name in ids if name.endswith("_u") and f"{name[:-1]}v" in ids]
        return pairs[0] if pairs else ()

    @property
    def widths(self) -> tuple:
        """The parameters that say how wide the lobes are, by id; `width_parameter` first."""
        return tuple(name for name in dict.fromkeys((self.width_parameter, *self.widened_with, *self.axes)) if name)

    def parameter(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.id == name:
                return parameter
        raise UnknownParameter(self.id, name, (p.id for p in self.parameters))

    def resolve(self, given: dict) -> dict:
        """All parameters checked and completed with defaults."""
        values = {p.id: p.default for p in self.parameters}
        for name, value in given.items():
            values[name] = self.parameter(name).check(value)
        return values

    def with_albedos(self, albedos) -> "Model":
        """This model with other albedos to divide by, see albedos.py; itself where it divides by none.

        Registered models integrate theirs, which takes some tenths of a second for each new exponent: the truth. Who
        must not wait, or asks for many exponents, takes `tabulated.TABULATED`.
        """
        return self

    def evaluate(self, view, light, **parameters) -> np.ndarray:
        """f(V, L) in 1/sr: (N,) where the model is white, else (N, 3). 0 below the horizon.

        `view`, `light`: unit vectors (N, 3), or one for all.
        """
        p = self.resolve(parameters)
        view, light = paired("view", directions("view", view), "light", directions("light", light))
        above = (view[:, 2] > 0.0) & (light[:, 2] > 0.0)
        lit = self._value(view[above], light[above], p)
        value = np.zeros((len(view), *lit.shape[1:]))
        value[above] = lit
        return value

    def evaluate_fast(self, view, light, p: dict) -> np.ndarray:
        """f(V, L) as `evaluate` gives it, of resolved parameters and directions above the horizon, within about 1 %.

        For what must not wait: it is the value itself where that takes no preparing; a model `with_albedos` from tables
        takes none.
        """
        return self._value(view, light, p)

    def albedo(self, cos_theta, **parameters) -> np.ndarray:
        """Albedo at N·V = `cos_theta` (N,), by quadrature: (N,) or (N, 3) as `evaluate`.

        The view lies in the x-z plane, as everywhere; only models with a tangent care.
        """
        p = self.resolve(parameters)
        mu = np.atleast_1d(np.asarray(cos_theta, dtype=np.float64))
        if mu.ndim != 1 or not mu.size:
            raise ArgumentError("cos_theta", "shape", f"expected numbers of shape (N,), got shape {mu.shape}")
        if not np.all((mu >= 0.0) & (mu <= 1.0)):
            raise ArgumentError("cos_theta", "range", f"{mu[~((mu >= 0.0) & (mu <= 1.0))][0]:g} is outside 0 .. 1")
        return self._albedo(mu, p)

    def sample(self, view, u, **parameters) -> np.ndarray:
        """Light directions (N, 3) with the density `pdf`, from uniform numbers `u` (N, 2) in 0..1.

        They follow the model's lobes, and some lie below the horizon, where the BRDF is 0.
        """
        p = self.resolve(parameters)
        u = np.atleast_2d(np.asarray(u, dtype=np.float64))
        if u.ndim != 2 or u.shape[1] != 2:
            raise ArgumentError("u", "shape", f"expected uniform numbers of shape (N, 2), got shape {u.shape}")
        if not np.all((u >= 0.0) & (u <= 1.0)):
            raise ArgumentError("u", "range", f"{u[~((u >= 0.0) & (u <= 1.0))][0]:g} is outside 0 .. 1")
        view, u = paired("view", directions("view", view), "u", u)
        return self._sample(view, np.maximum(u, 1e-300), p)

    def pdf(self, view, light, **parameters) -> np.ndarray:
        """Density of `sample` at `light`, 1/sr over the whole sphere, shape (N,)."""
        p = self.resolve(parameters)
        view, light = paired("view", directions("view", view), "light", directions("light", light))
        return self._pdf(view, light, p)


def find_model(name: str) -> Model:
    """The model called `name`. Raises UnknownModel that lists what there is."""
    if name not in MODELS:
        raise UnknownModel(name, MODELS)
    return MODELS[name]


def register(model: Model) -> Model:
    """Add a model. Raises DuplicateModel when its id is taken."""
    if model.id in MODELS:
        raise DuplicateModel(model.id)
    MODELS[model.id] = model
    return model
