"""Measures f (N·L) in Cycles for pairs of a view and a light: a sun of no size on a plane, an orthographic camera."""
import numpy as np

from addon.measure import Measurement, scene
from optics.directions import toward


def measured(material, views, lights, samples, seed=0, resolution=16) -> Measurement:
    """f (N·L) of `material` and its standard error, (N, 3) each, for unit `views` and `lights` (N, 3).

    z is the normal, x the tangent. The pixels of a render are independent measurements of one number.
    """
    rows = []
    with scene.MeasuringScene(material, scene.PLANE, resolution) as stage:
        sun = stage.shine("SUN", (0.0, 0.0, 1.0), energy=scene.SUN_ENERGY, angle=0.0)
        for view, light in zip(views, lights, strict=True):
            stage.look_from(view)
            stage.aim(sun, light)
            pixels = stage.render(samples, seed).reshape(-1, 3) / np.pi
            rows.append((pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / np.sqrt(len(pixels))))
    return Measurement(*map(np.array, zip(*rows, strict=True)))


def until_sharp(material, views, lights, wanted, least=64, most=4096):
    """`measured` with the samples, `least` to `most`, that bring the noise below `wanted` (N,).

    A first measurement estimates the samples. Pairs that were too noisy are measured again with another seed, and the
    first value is dropped: otherwise the selection would bias the result.
    """
    value, noise = measured(material, views, lights, least)
    needed = np.minimum(least * (noise.max(axis=1) / (0.8 * wanted)) ** 2, most)
    low = least
    while low < most:
        high = min(4 * low, most)
        again = np.flatnonzero((needed > low) & (needed <= high))
        if len(again):
            samples = int(np.ceil(min(1.2 * needed[again].max(), most)))
            value[again], noise[again] = measured(material, views[again], lights[again], samples, seed=1)
        low = high
    return Measurement(value, noise)


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
