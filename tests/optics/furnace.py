"""White furnaces of a noise that decides, and what they may be off by."""
from functools import partial

import numpy as np

from addon import brdf, create_material, verify
from addon.verify import comparison, instruments, room
from optics.directions import cosines

SIGMAS = comparison.SIGMAS
FURNACE_BOUND, FURNACE_NOISE = 2e-3, 7e-4  # of the albedo


def sharpened(measure, wanted, most=1 << 14, least=64):
    """What `measure(samples, seed)` gives, with as many samples, `least` to `most`, as a noise below `wanted` needs.

    A first look tells how many; it is not kept where it was too noisy: what it happened to show must not choose.
    """
    found = measure(least, 0)
    needed = min(least * (found.noise.max() / (0.8 * wanted)) ** 2, most)
    return found if needed <= least else measure(int(np.ceil(min(1.2 * needed, most))), 1)


def together(measurements):
    """One Measurement, (N, 3) each, of several."""
    return verify.Measurement(*map(np.array, zip(*measurements, strict=True)))


def albedo_of(material, angles_deg, wanted=FURNACE_NOISE):
    """Furnace of `material`, its noise below `wanted` where that can be."""
    with room.Room(material, room.PLANE, 16) as place:
        place.sky(1.0)
        return together(sharpened(partial(instruments.albedo_in, place, angle), wanted)
                        for angle in np.atleast_1d(angles_deg))


def furnace_report(model, parameters, angles, material=None):
    """Comparison of the rendered furnace with the quadrature."""
    measured, noise = albedo_of(material or create_material(model, **parameters), angles)
    reference = brdf.MODELS[model].albedo(cosines(angles), **parameters)
    return verify.compare(measured, reference, noise, FURNACE_BOUND)


def assert_good(report, noise):
    assert report.noise.max() <= noise, f"too noisy to decide: {report.noise.max():.2g}"
    assert set(report.verdicts()) == {comparison.OK}, np.array2string(report.error[:, 0], precision=5)
