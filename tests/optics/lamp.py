"""A sphere under a square lamp: the sum over the lamp's points, and Cycles' picture."""
import numpy as np

from addon import brdf, create_material, measure
from addon.measure import scene
from optics.directions import rgb
from optics.sun import ball

AREA = {"energy": 200.0, "size": 0.5, "shape": "SQUARE", "distance": 3.5}
AREA_DIRECTION = np.array([0.36, 0.48, 0.8])  # from the sphere to the lamp


def area_lamp(stage):
    """Adds the square lamp to a measuring scene."""
    stage.shine("AREA", AREA_DIRECTION, **AREA)


def zones_of(reference, resolution):
    """Masks (4, H, W): the sphere, and three rings of it from facing to grazing, each with a third of the light."""
    facing = np.nan_to_num(ball(resolution).normal[..., 2])
    light = np.where(facing > 0.05, reference.sum(axis=-1), 0.0)
    order = np.argsort(-facing, axis=None)
    share = np.empty(facing.size)
    share[order] = np.cumsum(light.ravel()[order]) / light.sum()
    ring = np.minimum((3.0 * share).astype(int), 2).reshape(facing.shape)
    covered = facing > 0.05
    return np.array([covered] + [covered & (ring == i) for i in range(3)])


def frames(resolution):
    """(mask (H, W), position, tangent, bitangent (N, 3)) of the pixels that see the sphere.

    In a pixel's frame the view lies in the x-z plane.
    """
    normal = ball(resolution).normal
    mask = np.nan_to_num(normal[..., 2]) > 0.05
    n = normal[mask]
    tangent = np.array([0.0, 0.0, 1.0]) - n[:, 2:] * n
    length = np.linalg.norm(tangent, axis=1, keepdims=True)
    tangent = np.where(length > 1e-9, tangent / np.maximum(length, 1e-9), [1.0, 0.0, 0.0])
    return mask, n, tangent, np.cross(n, tangent)


def gathered(evaluate, resolution, lights_at):
    """Sums f (N·L) times light at each pixel of a sphere; returns (H, W, 3).

    `lights_at(position)` gives directions (M, 3) and their light (M, 3), radiance times solid angle.
    """
    mask, normals, tangents, bitangents = frames(resolution)
    image, values = np.zeros(mask.shape + (3,)), []
    for n, t, b in zip(normals, tangents, bitangents, strict=True):
        lights, light = lights_at(n)
        local = lights @ np.stack([t, b, n], axis=1)
        above = local[:, 2] > 0.0
        view = np.array([[t[2], b[2], n[2]]])
        value = rgb(evaluate(view, local[above])) * local[above, 2:]
        values.append((value * light[above]).sum(axis=0))
    image[mask] = values
    return image


def lamp_points(position, count=12):
    """Directions (count², 3) from `position` to Gauss points of the square lamp, and their light (count², 3).

    Light is radiance times solid angle. Blender's radiance is power / (pi area), on one side of the lamp.
    """
    x, w = np.polynomial.legendre.leggauss(count)
    a = AREA_DIRECTION
    u = np.cross([0.0, 1.0, 0.0], a)
    u = u / np.linalg.norm(u)
    v = np.cross(a, u)
    # The Gauss points on the lamp, which faces the origin.
    half_size = 0.5 * AREA["size"]
    grid_u, grid_v = np.meshgrid(half_size * x, half_size * x)
    point = AREA["distance"] * a + grid_u.reshape(-1, 1) * u + grid_v.reshape(-1, 1) * v
    to_lamp = point - position
    distance = np.linalg.norm(to_lamp, axis=1, keepdims=True)
    lights = to_lamp / distance
    area = np.outer(w, w).reshape(-1, 1) * half_size**2
    radiance = AREA["energy"] / (np.pi * AREA["size"] ** 2)
    return lights, np.repeat(radiance * np.maximum(lights @ a, 0.0)[:, None] / distance**2 * area, 3, axis=1)


def total_under_the_lamp(model, parameters, size=48, samples=64, pictures=6):
    """The sphere's total light under the lamp over the formula's, less one, and its standard error."""
    reference = gathered(lambda view, light: brdf.MODELS[model].evaluate(view, light, **parameters), size, lamp_points)
    covered = zones_of(reference, size)[0]
    with scene.MeasuringScene(create_material(model, **parameters), scene.BALL, size, exact_pixels=True) as stage:
        area_lamp(stage)
        stage.look_from((0.0, 0.0, 1.0), 2.0 * (1.0 + 1.0 / size))
        ratios = [measure.total_ratio(stage.render(samples, seed), reference, covered) for seed in range(pictures)]
    return np.mean(ratios) - 1.0, np.std(ratios, ddof=1) / np.sqrt(pictures)
