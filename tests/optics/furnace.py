"""White furnaces with little enough noise for a verdict, and their allowed errors."""
from functools import partial

import numpy as np

from addon import brdf, create_material, measure
from addon.measure import comparison, instruments, scene
from optics.directions import cosines

SIGMAS = comparison.SIGMAS
FURNACE_BOUND, FURNACE_NOISE = 2e-3, 7e-4  # of the albedo


def sharpened(measure_once, wanted, most=1 << 14, least=64):
    """The Measurement of `measure_once(samples, seed)` with the samples, `least` to `most`, for a noise below `wanted`.

    A first measurement estimates the samples. Where it was too noisy it is dropped, and another seed is measured:
    otherwise the selection would bias the result.
    """
    # Noise falls with the root of the number of samples; the factor 0.8 is a reserve.
    first = measure_once(least, 0)
    needed = min(least * (first.noise.max() / (0.8 * wanted)) ** 2, most)
    return first if needed <= least else measure_once(int(np.ceil(min(1.2 * needed, most))), 1)


def together(measurements):
    """One Measurement, (N, 3) each, of several."""
    return measure.Measurement(*map(np.array, zip(*measurements, strict=True)))


def albedo_of(material, angles_deg, wanted=FURNACE_NOISE):
    """Furnace of `material` at `angles_deg`, with noise below `wanted` where 16384 samples suffice."""
    with scene.MeasuringScene(material, scene.PLANE, 16) as stage:
        stage.sky(1.0)
        return together(sharpened(partial(instruments.albedo_in, stage, angle), wanted)
                        for angle in np.atleast_1d(angles_deg))


def furnace_report(model, parameters, angles, material=None):
    """Comparison of the rendered furnace with the formula's albedo."""
    measured, noise = albedo_of(material or create_material(model, **parameters), angles)
    reference = brdf.MODELS[model].albedo(cosines(angles), **parameters)
    return measure.compare(measured, reference, noise, FURNACE_BOUND)


def assert_good(report, noise):
    """Fails where a Comparison is noisier than `noise` or a row is not OK."""
    assert report.noise.max() <= noise, f"too noisy to decide: {report.noise.max():.2g}"
    assert set(report.verdicts()) == {comparison.OK}, np.array2string(report.error[:, 0], precision=5)
