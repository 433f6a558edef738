"""f (N·L) at single directions, in parts of a lobe's peak."""
import numpy as np

from addon import brdf, measure
from optics.directions import rgb
from optics.furnace import sharpened

POINT_BOUND, POINT_NOISE = 0.02, 0.004  # of the lobe's peak
# The residual is grainy at grazing views and for the widest lobes: noise of a mean over all pixels, of the peak.
POINT_GRAINY = 0.02
POINT_WANTED = 0.001  # the noise to reach, of the peak: five of it are a quarter of the bound


def peak_of(model, parameters, view):
    """Largest f (N·L) over the hemisphere for one view, within a thousandth."""
    theta, phi = np.meshgrid(np.radians(np.linspace(0.0, 89.9, 1800)), np.radians(np.linspace(0.0, 20.0, 9)))
    light = np.stack([-np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).reshape(-1, 3)
    return float((rgb(brdf.MODELS[model].evaluate(view, light, **parameters)) * light[:, 2:]).max())


def directions_of(material, view_deg, lights, peak, most):
    """f (N·L) in parts of `peak`, with the samples, up to `most`, that bring the noise below POINT_WANTED."""
    def measure_rows(rows, samples, seed):
        f, noise = measure.goniometer(material, view_deg, lights[rows], samples=samples, seed=seed)
        return f * lights[rows, 2:] / peak, noise * lights[rows, 2:] / peak

    return sharpened(measure_rows, len(lights), POINT_WANTED, most)
