"""Furnace, goniometer and lit sphere: what a material does in Cycles, in numbers.

The furnace and the goniometer look at a plane through an orthographic camera, so that every pixel has the same view
direction and the pixels are independent measurements of one number: their mean is the result and their scatter its
standard error. The sphere shows many directions at once, the way a picture does.
"""
from typing import NamedTuple

import numpy as np

from ..brdf import geometry
from ..brdf.errors import ArgumentError
from ..brdf.geometry import directions, dot, normalize
from . import room

MAX_ANGLE = 89.0  # degrees; beyond, the plane is seen nearly edge on


class Measurement(NamedTuple):
    """`value` and its standard error `noise`, both (N, 3), RGB."""

    value: np.ndarray
    noise: np.ndarray


class Sphere(NamedTuple):
    """A picture of a sphere: `image` (H, W, 3) radiance, row 0 at the bottom, and what each pixel's centre sees.

    `covered` (H, W) tells the pixels that see the sphere, `normal` (H, W, 3) is N there and NaN elsewhere; all of them
    see along the same `view` (3,). The camera's right and up are +x and +y.
    """

    image: np.ndarray
    covered: np.ndarray
    normal: np.ndarray
    view: np.ndarray


class LitDirections(NamedTuple):
    """View and light of the P `covered` pixels of a sphere, in each pixel's own local frame (+z is its normal)."""

    covered: np.ndarray
    view: np.ndarray
    light: np.ndarray


def _angles(name, degrees):
    angles = np.atleast_1d(np.asarray(degrees, dtype=np.float64))
    if angles.ndim != 1 or not len(angles) or not np.all((angles >= 0.0) & (angles <= MAX_ANGLE)):
        raise ArgumentError(name, "range", f"expected angles from 0 to {MAX_ANGLE:g} degrees, got {degrees}")
    return angles


def _from_zenith(degrees):
    angle = np.radians(degrees)
    return np.array([np.sin(angle), 0.0, np.cos(angle)])


def _statistics(pixels):
    """Mean and standard error of the mean of independent pixels (..., 3)."""
    flat = pixels.reshape(-1, 3)
    return flat.mean(axis=0), flat.std(axis=0, ddof=1) / np.sqrt(len(flat))


def _ignore(done, total):
    """No progress report."""


def furnace(material, angles_deg, samples=256, resolution=16, seed=0, progress=_ignore) -> Measurement:
    """Albedo of `material` seen at `angles_deg` (N,) degrees from the normal, 0..89, under a white sky.

    `samples` per pixel, `resolution` pixels across; `progress(done, total)` is called after each render.
    Returns mean and standard error, (N, 3) each. Raises ValueError for an angle out of range, RoomError (a
    ValueError) where Blender or its OSL is missing.
    """
    angles = _angles("angles_deg", angles_deg)
    rows = []
    with room.Room(material, room.PLANE, resolution) as place:
        place.sky(1.0)
        for angle in angles:
            rows.append(albedo_in(place, angle, samples, seed))
            progress(len(rows), len(angles))
    return Measurement(*map(np.array, zip(*rows, strict=True)))


def albedo_in(place, angle_deg: float, samples: int, seed: int = 0) -> Measurement:
    """The albedo of a room's plane under a white sky, seen at one angle: (3,) each."""
    place.look_from(_from_zenith(angle_deg))
    return Measurement(*_statistics(place.render(samples, seed)))


def goniometer(material, view_deg, lights, samples=16, resolution=16, seed=0, progress=_ignore) -> Measurement:
    """f(V, L) of `material` in 1/sr, measured under a sun of no size.

    V lies in the x-z plane, `view_deg` degrees from the normal towards +x, 0..89. `lights` are unit vectors (N, 3)
    above the horizon, +z being the normal. Returns f and its standard error, (N, 3) each. Raises as `furnace`.
    """
    angle = _angles("view_deg", view_deg)
    if len(angle) != 1:
        raise ArgumentError("view_deg", "shape", f"expected one angle, got {view_deg}")
    lights = directions("lights", lights)
    if not len(lights) or lights[:, 2].min() <= 0.0:
        raise ArgumentError("lights", "range", "every light must be above the horizon")
    rows = []
    with room.Room(material, room.PLANE, resolution) as place:
        place.look_from(_from_zenith(angle[0]))
        sun = place.shine("SUN", lights[0], energy=room.SUN_ENERGY, angle=0.0)
        for light in lights:
            rows.append(value_in(place, sun, light, samples, seed))
            progress(len(rows), len(lights))
    return Measurement(*map(np.array, zip(*rows, strict=True)))


def value_in(place, sun, light, samples: int, seed: int = 0) -> Measurement:
    """f of a room's plane, for the view that it is seen from and its `sun` at the unit vector `light`: (3,) each."""
    place.aim(sun, light)
    radiance, noise = _statistics(place.render(samples, seed))
    irradiance = room.SUN_ENERGY * light[2]
    return Measurement(radiance / irradiance, noise / irradiance)


def in_plane(angles_deg) -> np.ndarray:
    """Lights in the plane of incidence, `angles_deg` (N,) from the normal to the mirror's side (-x): (N, 3)."""
    return geometry.in_plane(-np.asarray(angles_deg, dtype=np.float64))


def across_lobe(view_deg: float, angles_deg) -> np.ndarray:
    """Lights off the plane of incidence, `angles_deg` (N,) from the mirror direction towards +y: (N, 3)."""
    angles = np.radians(np.asarray(angles_deg, dtype=np.float64))[:, None]
    return np.cos(angles) * in_plane([view_deg]) + np.sin(angles) * [0.0, 1.0, 0.0]


def sphere(material, lamps=(), sky=0.0, image=None, samples=64, resolution=128, seed=0) -> Sphere:
    """Picture of a sphere of radius 1 at the origin, seen from +z; a pixel sees its centre only.

    `lamps`: (kind, direction, settings) each, as `Room.shine` takes them, e.g. ("SUN", (0, 0, 1), {"energy": 3.14,
    "angle": 0.0}). `sky` is radiance from everywhere, or scales the equirectangular HDRI file `image`.
    """
    with room.Room(material, room.BALL, resolution, exact_pixels=True) as place:
        place.sky(1.0 if image is not None and np.max(sky) == 0.0 else sky, image)
        for kind, direction, settings in lamps:
            place.shine(kind, direction, **settings)
        width = 2.0 * (1.0 + 1.0 / resolution)
        place.look_from((0.0, 0.0, 1.0), width)
        picture = place.render(samples, seed)
    centres = width * ((np.arange(resolution) + 0.5) / resolution - 0.5)
    x, y = np.meshgrid(centres, centres)
    squared = 1.0 - x * x - y * y
    covered = squared > 0.0
    normal = np.stack([x, y, np.sqrt(np.maximum(squared, 0.0))], axis=-1)
    normal[~covered] = np.nan
    return Sphere(picture, covered, normal, np.array([0.0, 0.0, 1.0]))


def local_directions(picture: Sphere, light, margin: float = 0.0) -> LitDirections:
    """V and L of the pixels with N·V > `margin`, in frames with +z along N and V in the x-z plane.

    `light` is the unit vector (3,) to the light. The rim is where a tessellated sphere is least like a round one:
    `margin` = 0.05 leaves it out.
    """
    with np.errstate(invalid="ignore"):
        covered = picture.covered & (picture.normal @ picture.view > margin)
    normal = picture.normal[covered]
    across = picture.view - dot(normal, picture.view)[:, None] * normal
    tangent = normalize(np.where(np.linalg.norm(across, axis=1, keepdims=True) > 1e-12, across, [1.0, 0.0, 0.0]))
    bitangent = np.cross(normal, tangent)

    def local(vector):
        return normalize(np.stack([tangent @ vector, bitangent @ vector, normal @ vector], axis=-1))

    return LitDirections(covered, local(picture.view), local(directions("light", light)[0]))


def sphere_sun(material, sun_angle_deg, samples=64, resolution=128, seed=0, margin=0.05):
    """Picture of a sphere under a sun of no size, `sun_angle_deg` (-180..180) from the camera's axis towards +x.

    Returns (image (H, W, 3), LitDirections). The sun's irradiance is pi, so a pixel shows pi f(V, L) (N·L).
    """
    direction = _from_zenith(float(sun_angle_deg))
    lamp = ("SUN", direction, {"energy": room.SUN_ENERGY, "angle": 0.0})
    picture = sphere(material, [lamp], samples=samples, resolution=resolution, seed=seed)
    return picture.image, local_directions(picture, direction, margin)


def sphere_reference(evaluate, lit: LitDirections) -> np.ndarray:
    """What `sphere_sun` should show for the BRDF `evaluate(view, light) -> (P,) or (P, 3)` in 1/sr: (H, W, 3).

    0 outside `lit.covered`.
    """
    value = np.asarray(evaluate(lit.view, lit.light), dtype=np.float64).reshape(len(lit.view), -1)
    image = np.zeros(lit.covered.shape + (3,))
    image[lit.covered] = room.SUN_ENERGY * value * np.maximum(lit.light[:, 2:], 0.0)
    return image


def l1_error(image, reference, covered=None) -> float:
    """Mean absolute deviation over mean reference, sum|a-b| / sum|b|, over the pixels `covered` (all by default)."""
    a, b = _pick(image, reference, covered)
    return float(np.abs(a - b).sum() / np.abs(b).sum())


def total_ratio(image, reference, covered=None) -> float:
    """Total light of `image` over that of `reference`, over the pixels `covered` (all by default)."""
    a, b = _pick(image, reference, covered)
    return float(a.sum() / b.sum())


def _pick(image, reference, covered):
    image, reference = np.asarray(image), np.asarray(reference)
    if image.shape != reference.shape:
        raise ValueError(f"image and reference differ in shape: {image.shape} and {reference.shape}")
    return (image, reference) if covered is None else (image[covered], reference[covered])
