"""The registry of models. Sockets, panel, bake jobs, command line and tests derive from the models declared in it."""
from dataclasses import dataclass, field

import numpy as np

from .errors import ArgumentError, DuplicateModel, UnknownModel, UnknownParameter
from .geometry import directions, paired
from .parameters import Parameter

# {id: model}, in the order of registration.
MODELS = {}


@dataclass(frozen=True)
class Model:
    """A reflectance model as declared: names, parameters, formula and sources.

    The subclasses `FormulaModel`, `LobeModel` and `DiskModel` implement the formula. All methods take the model's
    parameters by id, and raise ValueError that names the fault.

    - `width_parameter`: the id of the parameter that widens or narrows the lobe, or None.
    - `widened_with`: ids of other lobes' width parameters, which are scaled by the same factor.
    - `power_bases`: ids of the bases that exponents apply to. When an exponent is scaled, they change so that the
      powers stay the same.
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
        """Ids of the parameters that stretch the lobe along and across the tangent. () if the lobe is round."""
        ids = [p.id for p in self.parameters]
        pairs = [(name, f"{name[:-1]}v") for name in ids if name.endswith("_u") and f"{name[:-1]}v" in ids]
        return pairs[0] if pairs else ()

    @property
    def widths(self) -> tuple:
        """Ids of all parameters that set a lobe's width, `width_parameter` first."""
        return tuple(name for name in dict.fromkeys((self.width_parameter, *self.widened_with, *self.axes)) if name)

    def parameter(self, name: str) -> Parameter:
        """The parameter with the id `name`. Raises UnknownParameter."""
        for parameter in self.parameters:
            if parameter.id == name:
                return parameter
        raise UnknownParameter(self.id, name, (p.id for p in self.parameters))

    def resolve(self, given: dict) -> dict:
        """{id: value} of all parameters: those in `given` checked, the others' defaults.

        Raises UnknownParameter or ParameterError.
        """
        values = {p.id: p.default for p in self.parameters}
        for name, value in given.items():
            values[name] = self.parameter(name).check(value)
        return values

    def with_albedos(self, albedos) -> "Model":
        """This model with another source of the albedos that it divides by (see albedos.py). Itself if it needs none.

        Registered models integrate their albedos, which is exact but takes some tenths of a second per new exponent.
        Callers that must be fast, or that need many exponents, pass `tabulated.TABULATED`.
        """
        return self

    def evaluate(self, view, light, **parameters) -> np.ndarray:
        """f(V, L) in 1/sr: (N,) if the model is white, else (N, 3). It is 0 below the horizon.

        `view`, `light`: unit vectors (N, 3), or one for all rows.
        """
        p = self.resolve(parameters)
        view, light = paired("view", directions("view", view), "light", directions("light", light))
        above = (view[:, 2] > 0.0) & (light[:, 2] > 0.0)
        lit = self._value(view[above], light[above], p)
        value = np.zeros((len(view), *lit.shape[1:]))
        value[above] = lit
        return value

    def evaluate_fast(self, view, light, p: dict) -> np.ndarray:
        """f(V, L) as `evaluate`, for resolved parameters `p` and directions above the horizon, within about 1 %.

        It is fast for new parameters, too. Models that precompute nothing return the exact value, and so do models
        `with_albedos` from tables.
        """
        return self._value(view, light, p)

    def albedo(self, cos_theta, **parameters) -> np.ndarray:
        """Albedo at N·V = `cos_theta` (N,) in 0..1, by quadrature: (N,) or (N, 3) as `evaluate`.

        The view lies in the x-z plane, which matters only to models with a tangent.
        """
        p = self.resolve(parameters)
        mu = np.atleast_1d(np.asarray(cos_theta, dtype=np.float64))
        if mu.ndim != 1 or not mu.size:
            raise ArgumentError("cos_theta", "shape", f"expected numbers of shape (N,), got shape {mu.shape}")
        if not np.all((mu >= 0.0) & (mu <= 1.0)):
            raise ArgumentError("cos_theta", "range", f"{mu[~((mu >= 0.0) & (mu <= 1.0))][0]:g} is outside 0 .. 1")
        return self._albedo(mu, p)

    def sample(self, view, u, **parameters) -> np.ndarray:
        """Light directions (N, 3) with the density `pdf`, from uniform random numbers `u` (N, 2) in 0..1.

        The directions follow the model's lobes. Some lie below the horizon, where the BRDF is 0.
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
    """The model with the id `name`. Raises UnknownModel, which lists all ids."""
    if name not in MODELS:
        raise UnknownModel(name, MODELS)
    return MODELS[name]


def register(model: Model) -> Model:
    """Adds a model and returns it. Raises DuplicateModel if its id is taken."""
    if model.id in MODELS:
        raise DuplicateModel(model.id)
    MODELS[model.id] = model
    return model
