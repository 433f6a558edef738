"""Renders of a plane of one material."""
import bpy
import numpy as np

from addon.measure import scene

# Before version 5 Blender renders leaning facets too bright, and more so at slanted views. Wide lobes gain up to these
# parts of all light, at views of 1, 45, 70 and 82 degrees.
LEANING = np.zeros(4) if bpy.app.version >= (5, 0) else np.array([0.0, 0.01, 0.04, 0.04])


def plane(material, view_deg, samples=256, resolution=16, seed=0, sky=1.0, arrange=None):
    """Pixels (N, 3) of a plane of `material`; `arrange(stage)` changes the scene before the render."""
    with scene.MeasuringScene(material, scene.PLANE, resolution) as stage:
        stage.sky(sky)
        angle = np.radians(view_deg)
        stage.look_from((np.sin(angle), 0.0, np.cos(angle)))
        if arrange:
            arrange(stage)
        return stage.render(samples, seed).reshape(-1, 3)


def picture_of(material):
    """Pixels (4096, 3) of a plane under a white sky, fine enough to show stripes."""
    return plane(material, 30.0, samples=4, resolution=64)


def is_striped(pixels):
    """Whether pixels show stripes of one color and black, which no reflectance makes of an even sky."""
    return pixels.std() > 0.3 * pixels.mean()


def picture(material, view_deg=60.0, samples=16, energy=0.0):
    """Pixels (256, 3) of a plane under a white sky, or under a sun of `energy` (W/m²) from the normal."""
    with scene.MeasuringScene(material, scene.PLANE, 16) as stage:
        stage.sky(0.0 if energy else 1.0)
        if energy:
            stage.shine("SUN", (0.0, 0.0, 1.0), energy=energy, angle=0.0)
        angle = np.radians(view_deg)
        stage.look_from((np.sin(angle), 0.0, np.cos(angle)))
        return stage.render(samples).reshape(-1, 3)
