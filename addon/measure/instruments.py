"""Furnace, goniometer and lit sphere: they measure a material's reflectance in Cycles.

The furnace and the goniometer see a plane through an orthographic camera. Every pixel then has the same view direction,
and the pixels are independent measurements of one number: their mean is the result, their scatter its standard error.
The sphere shows many directions at once, as a picture does.
"""
from typing import NamedTuple

import numpy as np

from ..models import geometry
from ..models.errors import ArgumentError
from ..models.geometry import directions, dot, normalize
from . import scene

MAX_ANGLE = 89.0  # degrees; beyond it the camera sees the plane nearly edge on


class Measurement(NamedTuple):
    """`value` and its standard error `noise`, both (N, 3), RGB."""

    value: np.ndarray
    noise: np.ndarray


class Sphere(NamedTuple):
    """A picture of a sphere, with the surface point at each pixel's center.

    `image` (H, W, 3) is radiance, row 0 at the bottom. `covered` (H, W) is True for the pixels that see the sphere.
    `normal` (H, W, 3) is N at these pixels and NaN elsewhere. All pixels have the same `view` (3,). The camera's right
    and up are +x and +y.
    """

    image: np.ndarray
    covered: np.ndarray
    normal: np.ndarray
    view: np.ndarray


class LitDirections(NamedTuple):
    """View and light (P, 3) at the P pixels of a sphere where `covered` (H, W) is True.

    Each row is in its pixel's local frame: +z is the normal.
    """

    covered: np.ndarray
    view: np.ndarray
    light: np.ndarray


def _angles(name, degrees):
    """Checks angles (N,) in degrees, 0 to MAX_ANGLE. Raises ArgumentError that names the parameter `name`."""
    angles = np.atleast_1d(np.asarray(degrees, dtype=np.float64))
    if angles.ndim != 1 or not len(angles) or not np.all((angles >= 0.0) & (angles <= MAX_ANGLE)):
        raise ArgumentError(name, "range", f"expected angles from 0 to {MAX_ANGLE:g} degrees, got {degrees}")
    return angles


def _from_zenith(degrees):
    """Unit vector (3,) in the x-z plane, `degrees` from +z towards +x."""
    angle = np.radians(degrees)
    return np.array([np.sin(angle), 0.0, np.cos(angle)])


def _statistics(pixels):
    """Mean and standard error of the mean of independent pixels (..., 3)."""
    flat = pixels.reshape(-1, 3)
    return flat.mean(axis=0), flat.std(axis=0, ddof=1) / np.sqrt(len(flat))


def _ignore(done, total):
    """Reports no progress."""


def furnace(material, angles_deg, samples=256, resolution=16, seed=0, progress=_ignore) -> Measurement:
    """Albedo of `material` at the view angles `angles_deg` (N,), 0..89 degrees from the normal, under a white sky.

    Renders `samples` per pixel, `resolution` pixels across, and calls `progress(done, total)` after each render.
    Returns the mean and the standard error, (N, 3) each. Raises ValueError for an angle out of range, and MeasureError
    (a ValueError) where Blender is missing or cannot run the material's backend.
    """
    angles = _angles("angles_deg", angles_deg)
    rows = []
    with scene.MeasuringScene(material, scene.PLANE, resolution) as stage:
        stage.sky(1.0)
        for angle in angles:
            rows.append(albedo_in(stage, angle, samples, seed))
            progress(len(rows), len(angles))
    return Measurement(*map(np.array, zip(*rows, strict=True)))


def albedo_in(stage, angle_deg: float, samples: int, seed: int = 0) -> Measurement:
    """Albedo of the plane of the measuring scene `stage` under a white sky, at one view angle: (3,) each."""
    stage.look_from(_from_zenith(angle_deg))
    return Measurement(*_statistics(stage.render(samples, seed)))


def goniometer(material, view_deg, lights, samples=16, resolution=16, seed=0, progress=_ignore) -> Measurement:
    """f(V, L) of `material` in 1/sr, measured under a sun of no size.

    V lies in the x-z plane, `view_deg` degrees (0..89) from the normal +z towards +x. `lights` are unit vectors (N, 3)
    above the horizon. Returns f and its standard error, (N, 3) each. Raises as `furnace`.
    """
    angle = _angles("view_deg", view_deg)
    if len(angle) != 1:
        raise ArgumentError("view_deg", "shape", f"expected one angle, got {view_deg}")
    lights = directions("lights", lights)
    if not len(lights) or lights[:, 2].min() <= 0.0:
        raise ArgumentError("lights", "range", "every light must be above the horizon")
    rows = []
    with scene.MeasuringScene(material, scene.PLANE, resolution) as stage:
        stage.look_from(_from_zenith(angle[0]))
        sun = stage.shine("SUN", lights[0], energy=scene.SUN_ENERGY, angle=0.0)
        for light in lights:
            rows.append(value_in(stage, sun, light, samples, seed))
            progress(len(rows), len(lights))
    return Measurement(*map(np.array, zip(*rows, strict=True)))


def value_in(stage, sun, light, samples: int, seed: int = 0) -> Measurement:
    """f in 1/sr of the measuring scene's plane, for the scene's view and its `sun` at the unit `light`: (3,) each."""
    stage.aim(sun, light)
    # A plane under a sun shows radiance f times the irradiance on the plane.
    radiance, noise = _statistics(stage.render(samples, seed))
    irradiance = scene.SUN_ENERGY * light[2]
    return Measurement(radiance / irradiance, noise / irradiance)


def in_plane(angles_deg) -> np.ndarray:
    """Unit lights (N, 3) in the plane of incidence, `angles_deg` (N,) from the normal to the mirror's side (-x)."""
    return geometry.in_plane(-np.asarray(angles_deg, dtype=np.float64))


def across_lobe(view_deg: float, angles_deg) -> np.ndarray:
    """Unit lights (N, 3) off the plane of incidence, `angles_deg` (N,) from the mirror direction towards +y.

    `view_deg` is the view's angle from the normal.
    """
    angles = np.radians(np.asarray(angles_deg, dtype=np.float64))[:, None]
    return np.cos(angles) * in_plane([view_deg]) + np.sin(angles) * [0.0, 1.0, 0.0]


def sphere(material, lamps=(), sky=0.0, image=None, samples=64, resolution=128, seed=0) -> Sphere:
    """Renders a sphere of radius 1 at the origin, seen from +z. A pixel sees its center only.

    `lamps` are (kind, direction, settings), the arguments of `MeasuringScene.shine`, e.g. ("SUN", (0, 0, 1), {"energy":
    3.14, "angle": 0.0}). `sky` is the radiance from everywhere, or the factor of the equirectangular HDRI file `image`.
    Raises MeasureError where Blender is missing or cannot run the material's backend.
    """
    with scene.MeasuringScene(material, scene.BALL, resolution, exact_pixels=True) as stage:
        stage.sky(1.0 if image is not None and np.max(sky) == 0.0 else sky, image)
        for kind, direction, settings in lamps:
            stage.shine(kind, direction, **settings)
        width = 2.0 * (1.0 + 1.0 / resolution)
        stage.look_from((0.0, 0.0, 1.0), width)
        picture = stage.render(samples, seed)
    # The normal of a unit sphere is its position: x and y are the pixel's, z follows.
    centers = width * ((np.arange(resolution) + 0.5) / resolution - 0.5)
    x, y = np.meshgrid(centers, centers)
    squared = 1.0 - x * x - y * y
    covered = squared > 0.0
    normal = np.stack([x, y, np.sqrt(np.maximum(squared, 0.0))], axis=-1)
    normal[~covered] = np.nan
    return Sphere(picture, covered, normal, np.array([0.0, 0.0, 1.0]))


def local_directions(picture: Sphere, light, margin: float = 0.0) -> LitDirections:
    """V and L of the pixels with N·V > `margin`, in frames with +z along N and V in the x-z plane.

    `light` is the unit vector (3,) to the light. At the rim a tessellated sphere differs most from a round one:
    `margin` = 0.05 leaves the rim out.
    """
    with np.errstate(invalid="ignore"):
        covered = picture.covered & (picture.normal @ picture.view > margin)
    # The tangent is the view's part in the surface; any direction serves where the view is the normal.
    normal = picture.normal[covered]
    across = picture.view - dot(normal, picture.view)[:, None] * normal
    tangent = normalize(np.where(np.linalg.norm(across, axis=1, keepdims=True) > 1e-12, across, [1.0, 0.0, 0.0]))
    bitangent = np.cross(normal, tangent)

    def local(vector):
        return normalize(np.stack([tangent @ vector, bitangent @ vector, normal @ vector], axis=-1))

    return LitDirections(covered, local(picture.view), local(directions("light", light)[0]))


def sphere_sun(material, sun_angle_deg, samples=64, resolution=128, seed=0, margin=0.05):
    """Renders a sphere under a sun of no size, `sun_angle_deg` (-180..180) from the camera's axis towards +x.

    Returns (image (H, W, 3), LitDirections). The sun's irradiance is pi W/m², so a pixel shows pi f(V, L) (N·L).
    """
    direction = _from_zenith(float(sun_angle_deg))
    lamp = ("SUN", direction, {"energy": scene.SUN_ENERGY, "angle": 0.0})
    picture = sphere(material, [lamp], samples=samples, resolution=resolution, seed=seed)
    return picture.image, local_directions(picture, direction, margin)


def sphere_reference(evaluate, lit: LitDirections) -> np.ndarray:
    """The formula's picture (H, W, 3) for `sphere_sun`: pi f(V, L) (N·L), and 0 outside `lit.covered`.

    `evaluate(view, light)` is the BRDF f in 1/sr, (P,) or (P, 3).
    """
    value = np.asarray(evaluate(lit.view, lit.light), dtype=np.float64).reshape(len(lit.view), -1)
    image = np.zeros(lit.covered.shape + (3,))
    image[lit.covered] = scene.SUN_ENERGY * value * np.maximum(lit.light[:, 2:], 0.0)
    return image


def l1_error(image, reference, covered=None) -> float:
    """Mean absolute deviation over mean reference, sum|a-b| / sum|b|, over the pixels `covered` (all by default).

    Raises ValueError where `image` and `reference` differ in shape.
    """
    a, b = _pick(image, reference, covered)
    return float(np.abs(a - b).sum() / np.abs(b).sum())


def total_ratio(image, reference, covered=None) -> float:
    """Total light of `image` over the total of `reference`, over the pixels `covered` (all by default).

    Raises ValueError where the shapes differ.
    """
    a, b = _pick(image, reference, covered)
    return float(a.sum() / b.sum())


def _pick(image, reference, covered):
    """The `covered` pixels of both pictures, or both whole where `covered` is None."""
    image, reference = np.asarray(image), np.asarray(reference)
    if image.shape != reference.shape:
        raise ValueError(f"image and reference differ in shape: {image.shape} and {reference.shape}")
    return (image, reference) if covered is None else (image[covered], reference[covered])
