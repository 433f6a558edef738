"""White furnaces of a noise that decides, and what they may be off by."""
import itertools

import numpy as np

from addon import brdf, create_material, measure
from addon.measure import comparison
from optics.directions import cosines

SIGMAS = comparison.SIGMAS
FURNACE_BOUND, FURNACE_NOISE = 2e-3, 7e-4  # of the albedo


def sharpened(measure_rows, count, wanted, most=1 << 14):
    """A Measurement of `count` rows with as many samples, 64 to `most`, as a noise below `wanted` needs in each.

    `measure_rows(rows, samples, seed)` measures some of them. A first look at all tells how many samples a row needs; it is
    not kept where it was too noisy: what it happened to show must not choose.
    """
    value, noise = measure_rows(np.arange(count), 64, 0)
    needed = np.minimum(64 * (noise.max(axis=1) / (0.8 * wanted)) ** 2, most)
    for low, high in itertools.pairwise((64, 256, 1024, 4096, 1 << 14)):
        again = np.nonzero((needed > low) & (needed <= high))[0]
        if len(again):
            value[again], noise[again] = measure_rows(again, int(np.ceil(min(1.2 * needed[again].max(), most))), 1)
    return measure.Measurement(value, noise)


def albedo_of(material, angles_deg, wanted=FURNACE_NOISE):
    """Furnace of `material`, its noise below `wanted` where that can be."""
    angles = np.atleast_1d(np.asarray(angles_deg, dtype=np.float64))
    return sharpened(lambda rows, samples, seed: measure.furnace(material, angles[rows], samples=samples, seed=seed),
                     len(angles), wanted)


def furnace_report(model, parameters, angles, material=None):
    """Comparison of the rendered furnace with the quadrature."""
    measured, noise = albedo_of(material or create_material(model, **parameters), angles)
    reference = brdf.MODELS[model].albedo(cosines(angles), **parameters)
    return measure.compare(measured, reference, noise, FURNACE_BOUND)


def assert_good(report, noise):
    assert report.noise.max() <= noise, f"too noisy to decide: {report.noise.max():.2g}"
    assert set(report.verdicts()) == {comparison.OK}, np.array2string(report.error[:, 0], precision=5)
