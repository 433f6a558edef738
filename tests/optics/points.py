"""f (N·L) at single directions, in parts of a lobe's peak."""
from functools import partial

import numpy as np

from addon import brdf, measure
from addon.measure import instruments, scene
from addon.models.geometry import view_at
from optics.directions import cosines, rgb
from optics.furnace import sharpened, together

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
    """f (N·L) in parts of `peak`, from so many samples, up to `most`, that the noise is below POINT_WANTED."""
    with scene.MeasuringScene(material, scene.PLANE, 16) as stage:
        stage.look_from(view_at(cosines([view_deg]))[0])
        sun = stage.shine("SUN", lights[0], energy=scene.SUN_ENERGY, angle=0.0)
        f, noise = together(sharpened(partial(instruments.value_in, stage, sun, light), POINT_WANTED * peak / light[2],
                                      most) for light in lights)
    return measure.Measurement(f * lights[:, 2:] / peak, noise * lights[:, 2:] / peak)
