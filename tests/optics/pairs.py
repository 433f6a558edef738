"""Pairs of a view and a light, each measured in Cycles as one number: a sun of no size on a plane, a lens without
perspective."""
from functools import partial

import numpy as np

from addon.verify import Measurement, instruments, room
from optics.directions import toward
from optics.furnace import sharpened, together


def measured(material, views, lights, samples, seed=0) -> Measurement:
    """f (N·L) of `material` for unit vectors (N, 3) each, z being the normal and x the tangent, and its standard error.

    Its pixels are independent measurements of one number each: (N, 3) both.
    """
    return together(each(samples, seed) for each in _each(material, views, lights))


def until_sharp(material, views, lights, wanted, least=64, most=4096):
    """`measured`, with as many samples, `least` to `most`, as a noise below `wanted` (N,) needs, see `sharpened`."""
    pairs = zip(_each(material, views, lights), wanted, strict=True)
    return together(sharpened(each, enough, most, least) for each, enough in pairs)


def _each(material, views, lights):
    """Functions of samples and seed that measure a pair each; each is good until the next is asked for."""
    with room.Room(material, room.PLANE, 16) as place:
        sun = place.shine("SUN", (0.0, 0.0, 1.0), energy=room.SUN_ENERGY, angle=0.0)
        for view, light in zip(views, lights, strict=True):
            place.look_from(view)
            yield partial(_shown, place, sun, light)


def _shown(place, sun, light, samples, seed):
    f, noise = instruments.value_in(place, sun, light, samples, seed)
    return Measurement(f * light[2], noise * light[2])


def peak(model, given, view, count=4000):
    """Largest f (N·L) of a model's lights for one view (3,): over the upper half, and where its own samples are."""
    rng = np.random.default_rng(3)
    drawn = model.sample(view, rng.random((count, 2)), **given)
    mu = (np.arange(60) + 0.5) / 60
    even = toward(np.degrees(np.arccos(np.repeat(mu, 90))), np.tile(np.arange(90) * 4.0, 60))
    mirrored = (view * [-1.0, -1.0, 1.0])[None]
    light = np.concatenate([drawn[drawn[:, 2] > 0.0], even, mirrored, view[None]])
    value = model.evaluate(view, light, **given)
    value = value if value.ndim == 2 else value[:, None]
    return float((value * light[:, 2:]).max())
