"""The fallback: the Principled BSDFs that are nearest to a model, as numbers, and their errors."""
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
    """The Principled BSDFs of a model's fallback, for `values` {parameter id: value}: [(share, inputs)].

    `share` is a function of N·V (N,) that gives weights (N,), see `principled_fit.errors`; `inputs` are
    `principled_bsdf.Inputs`. The last 64 results are cached. Raises ValueError for values that the model refuses, such
    as an image that cannot be read.
    """
    return _parts(model, json.dumps(values, sort_keys=True), _stamps(model, values))


def look(model: Model, values: dict):
    """(color (3,), roughness, metallic) of the brightest part at normal incidence. Raises as `parts`."""
    brightest = max(parts(model, values), key=lambda part: part[0](np.ones(1))[0])[1]
    return brightest.base_color, brightest.roughness, brightest.metallic


def error(model: Model, values: dict) -> tuple:
    """Errors of the fallback, (lobe, albedo), in % of the model's light. Raises as `parts`."""
    return _error(model, json.dumps(values, sort_keys=True), _stamps(model, values))


def _stamps(model, values):
    return tuple(p.stamp(values[p.id]) for p in model.parameters if p.id in values)


@lru_cache(maxsize=64)
def _parts(model, text, _):
    """`parts` for the values in the JSON `text`. The stamps of files only serve as a part of the cache's key."""
    values = model.resolve({key: tuple(value) if isinstance(value, list) else value
                            for key, value in json.loads(text).items()})
    if isinstance(model, FormulaModel):
        evaluated = {p.id: values[p.id] for p in model.parameters if p.evaluated}
        return [(np.ones_like, principled_fit.fit(model, evaluated))]
    # One lobe of the model's own width, or such a lobe over a diffuse body.
    color, exponent, _ = appearance(model, values)
    if "diffuse_color" in values:
        color = np.asarray(values["base_color"])
    color = np.clip(color, 0.0, 1.0)
    roughness = models.roughness_of_exponent(exponent) * principled_fit.ROUGHNESS_FACTORS[model.id]
    if "diffuse_color" not in values:
        return [(np.ones_like, Inputs(tuple(color.tolist()), 1.0, roughness))]
    return _over_diffuse(color, roughness, values["diffuse_color"])


def _over_diffuse(color, roughness, diffuse_color):
    """Two parts: a lobe, whose share is Schlick's factor of its brightest channel, and a diffuse body with the rest."""
    brightest = float(color.max())

    def factor(mu):
        return brightest + (1.0 - brightest) * (1.0 - mu) ** 5

    lobe = Inputs(tuple((color / max(brightest, 1e-6)).tolist()), 1.0, roughness)
    body = Inputs(tuple(diffuse_color), 0.0, 1.0, specular=0.0)
    return [(factor, lobe), (lambda mu: 1.0 - factor(mu), body)]


@lru_cache(maxsize=64)
def _error(model, text, stamps):
    return principled_fit.errors(model, json.loads(text), _parts(model, text, stamps))
