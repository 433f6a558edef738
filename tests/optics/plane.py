"""Pictures of a plane of one material."""
import bpy
import numpy as np

from addon.measure import scene

# Before version 5 Blender makes facets that lean too bright, the more the more slanted the view: of wide lobes by up to
# these parts of all light, at 1, 45, 70 and 82 degrees.
LEANING = np.zeros(4) if bpy.app.version >= (5, 0) else np.array([0.0, 0.01, 0.04, 0.04])


def plane(material, view_deg, samples=256, resolution=16, seed=0, sky=1.0, arrange=None):
    """Pixels (N, 3) of a plane of `material`; `arrange(room)` changes the scene before it is rendered."""
    with scene.MeasuringScene(material, scene.PLANE, resolution) as place:
        place.sky(sky)
        angle = np.radians(view_deg)
        place.look_from((np.sin(angle), 0.0, np.cos(angle)))
        if arrange:
            arrange(place)
        return place.render(samples, seed).reshape(-1, 3)


def picture_of(material):
    """A plane under a white sky, (4096, 3), fine enough to tell stripes."""
    return plane(material, 30.0, samples=4, resolution=64)


def is_striped(pixels):
    """Stripes of one color and none: nothing that a reflectance makes of an even sky."""
    return pixels.std() > 0.3 * pixels.mean()


def picture(material, view_deg=60.0, samples=16, energy=0.0):
    """A plane under a white sky, or under a sun of `energy` from the normal: (256, 3)."""
    with scene.MeasuringScene(material, scene.PLANE, 16) as place:
        place.sky(0.0 if energy else 1.0)
        if energy:
            place.shine("SUN", (0.0, 0.0, 1.0), energy=energy, angle=0.0)
        angle = np.radians(view_deg)
        place.look_from((np.sin(angle), 0.0, np.cos(angle)))
        return place.render(samples).reshape(-1, 3)
