"""Quadratures over the hemisphere by the midpoint rule, with nodes dense where a lobe is."""
from functools import lru_cache

import numpy as np

NODES = {"ndf_map": (600, 720)}  # rings and turns of models whose lobes have narrow rays


@lru_cache(maxsize=8)
def half_vectors(width, rings=300, turns=120):
    """Half vectors (N, 3) about the normal and solid angles (N,), by the midpoint rule in log of their slope."""
    edges = np.concatenate([[0.0], np.geomspace(1e-3 * width, 1e4, rings)])
    slope = np.sqrt(edges[1:] * np.maximum(edges[:-1], 1e-12))
    slope[0] = 0.5 * edges[1]
    cosines = 1.0 / np.sqrt(1.0 + edges * edges)
    area = (cosines[:-1] - cosines[1:]) * 2.0 * np.pi / turns
    phi = (np.arange(turns) + 0.5) * 2.0 * np.pi / turns
    z = 1.0 / np.sqrt(1.0 + slope**2)
    x, y = (np.outer(z * slope, f(phi)).ravel() for f in (np.cos, np.sin))
    return np.stack([x, y, np.repeat(z, turns)], axis=-1), np.repeat(area, turns)


def half_vector_lights(view, model, values):
    """Lights (N, 3) above the horizon and solid angles (N,), dense where half vectors are upright: dL = 4 V·H dH."""
    h, area = half_vectors(round(float(model.width(model.resolve(values))), 4), *NODES.get(model.id, ()))
    facing = h @ view
    light = 2.0 * facing[:, None] * h - view
    lit = (facing > 0.0) & (light[:, 2] > 0.0)
    return light[lit] / np.linalg.norm(light[lit], axis=1, keepdims=True), 4.0 * facing[lit] * area[lit]


def even_lights(view, model, values, nodes=600):
    """Lights (N, 3) and solid angles (N,), evenly spread: strands reflect into cones, bright at the horizon."""
    mu, phi = ((np.arange(nodes) + 0.5) * end / nodes for end in (1.0, 2.0 * np.pi))
    s = np.sqrt(1.0 - mu * mu)
    x, y = (np.outer(s, f(phi)).ravel() for f in (np.cos, np.sin))
    return np.stack([x, y, np.repeat(mu, nodes)], axis=-1), np.full(nodes * nodes, 2.0 * np.pi / nodes**2)


def integrated(model, view, values):
    """The albedo of one view (3,), without a spike: a number or one for each channel."""
    light, area = (even_lights if model.id == "kajiya_kay" else half_vector_lights)(view, model, values)
    return np.einsum("n,n...->...", area * light[:, 2], model.evaluate(view[None], light, **values))
