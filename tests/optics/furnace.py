"""White furnaces with little enough noise for a verdict, and their allowed errors."""
import itertools

import numpy as np

from addon import brdf, create_material, measure
from addon.measure import comparison
from optics.directions import cosines

SIGMAS = comparison.SIGMAS
FURNACE_BOUND, FURNACE_NOISE = 2e-3, 7e-4  # of the albedo


def sharpened(measure_rows, count, wanted, most=1 << 14):
    """A Measurement of `count` rows, each with the samples, 64 to `most`, that bring its noise below `wanted`.

    `measure_rows(rows, samples, seed)` measures some rows. A first measurement of all rows estimates the samples that a
    row needs. Rows that were too noisy are measured again with another seed, and the first value is dropped: otherwise
    the selection would bias the result.
    """
    # Noise falls with the root of the number of samples; the factor 0.8 is a reserve.
    value, noise = measure_rows(np.arange(count), 64, 0)
    needed = np.minimum(64 * (noise.max(axis=1) / (0.8 * wanted)) ** 2, most)
    for low, high in itertools.pairwise((64, 256, 1024, 4096, 1 << 14)):
        again = np.nonzero((needed > low) & (needed <= high))[0]
        if len(again):
            value[again], noise[again] = measure_rows(again, int(np.ceil(min(1.2 * needed[again].max(), most))), 1)
    return measure.Measurement(value, noise)


def albedo_of(material, angles_deg, wanted=FURNACE_NOISE):
    """Furnace of `material` at `angles_deg`, with noise below `wanted` where 16384 samples suffice."""
    angles = np.atleast_1d(np.asarray(angles_deg, dtype=np.float64))
    return sharpened(lambda rows, samples, seed: measure.furnace(material, angles[rows], samples=samples, seed=seed),
                     len(angles), wanted)


def furnace_report(model, parameters, angles, material=None):
    """Comparison of the rendered furnace with the formula's albedo."""
    measured, noise = albedo_of(material or create_material(model, **parameters), angles)
    reference = brdf.MODELS[model].albedo(cosines(angles), **parameters)
    return measure.compare(measured, reference, noise, FURNACE_BOUND)


def assert_good(report, noise):
    """Fails where a Comparison is noisier than `noise` or a row is not OK."""
    assert report.noise.max() <= noise, f"too noisy to decide: {report.noise.max():.2g}"
    assert set(report.verdicts()) == {comparison.OK}, np.array2string(report.error[:, 0], precision=5)
