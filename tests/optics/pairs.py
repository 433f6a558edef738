"""Measures f (N·L) in Cycles for pairs of a view and a light: a sun of no size on a plane, an orthographic camera."""
from functools import partial

import numpy as np

from addon.measure import Measurement, instruments, scene
from optics.directions import toward
from optics.furnace import sharpened, together


def measured(material, views, lights, samples, seed=0) -> Measurement:
    """f (N·L) of `material` for unit vectors (N, 3) each, z being the normal and x the tangent, and its standard error.

    z is the normal, x the tangent. The pixels of a render are independent measurements of one number.
    """
    return together(measure_pair(samples, seed) for measure_pair in _pairs(material, views, lights))


def until_sharp(material, views, lights, wanted, least=64, most=4096):
    """`measured` with the samples, `least` to `most`, for a noise below `wanted` (N,), see `sharpened`."""
    pairs = zip(_pairs(material, views, lights), wanted, strict=True)
    return together(sharpened(measure_pair, enough, most, least) for measure_pair, enough in pairs)


def _pairs(material, views, lights):
    """Functions of samples and seed, one for each pair. Each measures its pair until the next is asked for."""
    with scene.MeasuringScene(material, scene.PLANE, 16) as stage:
        sun = stage.shine("SUN", (0.0, 0.0, 1.0), energy=scene.SUN_ENERGY, angle=0.0)
        for view, light in zip(views, lights, strict=True):
            stage.look_from(view)
            yield partial(_measured, stage, sun, light)


def _measured(stage, sun, light, samples, seed):
    f, noise = instruments.value_in(stage, sun, light, samples, seed)
    return Measurement(f * light[2], noise * light[2])


def peak(model, given, view, count=4000):
    """Largest f (N·L) of a model for one view (3,), among lights over the hemisphere and `count` of its own samples."""
    rng = np.random.default_rng(3)
    drawn = model.sample(view, rng.random((count, 2)), **given)
    mu = (np.arange(60) + 0.5) / 60
    even = toward(np.degrees(np.arccos(np.repeat(mu, 90))), np.tile(np.arange(90) * 4.0, 60))
    mirrored = (view * [-1.0, -1.0, 1.0])[None]
    light = np.concatenate([drawn[drawn[:, 2] > 0.0], even, mirrored, view[None]])
    value = model.evaluate(view, light, **given)
    value = value if value.ndim == 2 else value[:, None]
    return float((value * light[:, 2:]).max())
