"""The fallback: the Principled BSDFs that come nearest to a model, as numbers, and how far they are from it."""
import json
from functools import lru_cache

import numpy as np

from ... import models
from ...models.formula_model import FormulaModel
from ...models.registry import Model
from . import principled_fit
from .appearance import appearance
from .principled_bsdf import Inputs


def parts(model: Model, values: dict) -> list:
    """The Principled BSDFs that stand for a model with `values` by parameter id: [(share, inputs)].

    `share` is a function of N·V (N,), see `principled.errors`. The last few results are kept. Raises ValueError for
    values that the model refuses, as an image that cannot be read.
    """
    return _parts(model, json.dumps(values, sort_keys=True), _stamps(model, values))


def look(model: Model, values: dict):
    """(color (3,), roughness, metallic) of the brightest part at normal incidence. Raises as `parts`."""
    shown = parts(model, values)
    most = max(shown, key=lambda part: part[0](np.ones(1))[0])[1]
    return most.base_color, most.roughness, most.metallic


def error(model: Model, values: dict) -> tuple:
    """Errors (of the lobe, of the albedo) in % of the model's light. Raises as `parts`."""
    return _error(model, json.dumps(values, sort_keys=True), _stamps(model, values))


def _stamps(model, values):
    return tuple(p.stamp(values[p.id]) for p in model.parameters if p.id in values)


@lru_cache(maxsize=64)
def _parts(model, text, _):
    values = model.resolve({key: tuple(value) if isinstance(value, list) else value
                            for key, value in json.loads(text).items()})
    if isinstance(model, FormulaModel):
        evaluated = {p.id: values[p.id] for p in model.parameters if p.evaluated}
        return [(np.ones_like, principled_fit.fit(model, evaluated))]
    color, exponent, _ = appearance(model, values)
    if "diffuse_color" in values:
        color = np.asarray(values["base_color"])
    color = np.clip(color, 0.0, 1.0)
    roughness = models.roughness_of_exponent(exponent) * principled_fit.ROUGHNESS_FACTORS[model.id]
    if "diffuse_color" not in values:
        return [(np.ones_like, Inputs(tuple(color.tolist()), 1.0, roughness))]
    return _over_diffuse(color, roughness, values["diffuse_color"])


def _over_diffuse(color, roughness, diffuse_color):
    """Two parts: the lobe by Schlick's factor of its brightest channel, and a diffuse body by the rest."""
    brightest = float(color.max())

    def factor(mu):
        return brightest + (1.0 - brightest) * (1.0 - mu) ** 5

    lobe = Inputs(tuple((color / max(brightest, 1e-6)).tolist()), 1.0, roughness)
    body = Inputs(tuple(diffuse_color), 0.0, 1.0, specular=0.0)
    return [(factor, lobe), (lambda mu: 1.0 - factor(mu), body)]


@lru_cache(maxsize=64)
def _error(model, text, stamps):
    return principled_fit.errors(model, json.loads(text), _parts(model, text, stamps))
