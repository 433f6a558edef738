"""Outlines and lathe-turned bodies of the demo scene, as vertices and faces. Lengths in meters; never imports bpy."""
import math

import numpy as np


def rounded(outline, radius: float, segments: int = 6):
    """An open polyline (N, 2) whose inner corners are replaced by arcs of `radius`, cut short where a leg is short.

    Two points closer than 1e-6 are an error of the caller's: ValueError.
    """
    points = np.asarray(outline, dtype=np.float64)
    if np.any(np.linalg.norm(np.diff(points, axis=0), axis=1) < 1e-6):
        raise ValueError("rounded: two neighbors of the outline coincide")
    result = [points[0]]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        u, v = before - corner, after - corner
        length = np.linalg.norm(u), np.linalg.norm(v)
        u, v = u / length[0], v / length[1]
        opening = math.acos(np.clip(u @ v, -1.0, 1.0))
        cut = min(radius / math.tan(opening / 2.0), 0.45 * min(length)) if opening < math.pi - 1e-3 else 0.0
        # Points of a quadratic curve with the corner as its middle control point: tangent to both legs.
        for t in np.linspace(0.0, 1.0, segments + 1) if cut > 1e-6 else [0.5]:
            result.append(corner + cut * ((1.0 - t) ** 2 * u + t * t * v))
    return np.array([*result, points[-1]])


def lathe(profile, turns: int = 96):
    """Turn a profile of (radius, height) pairs about the z axis: vertices (M, 3) and faces of vertex numbers.

    Points of radius 0 become one vertex each. The profile runs upwards with the body on its left: faces look outwards.
    """
    angles = 2.0 * np.pi * np.arange(turns) / turns
    vertices, rings = [], []
    for radius, height in profile:
        count = 1 if radius < 1e-9 else turns
        rings.append(range(len(vertices), len(vertices) + count))
        vertices += [(radius * math.cos(a), radius * math.sin(a), height) for a in angles[:count]]
    faces = []
    for low, high in zip(rings, rings[1:], strict=False):
        for i in range(turns):
            j = (i + 1) % turns
            corners = [low[i % len(low)], low[j % len(low)], high[j % len(high)], high[i % len(high)]]
            faces.append(tuple(dict.fromkeys(corners)))
    return vertices, [face for face in faces if len(face) > 2]


def prism(outline, width: float):
    """A convex outline of (x, z) pairs, counter-clockwise seen from -y, extruded along y over `width`, centered."""
    count = len(outline)
    vertices = [(x, y, z) for y in (-width / 2.0, width / 2.0) for x, z in outline]
    sides = [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    return vertices, [*[side[::-1] for side in sides], tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1))]


def pyramid(side: float, height: float):
    """A square pyramid standing on z = 0."""
    h = side / 2.0
    vertices = [(-h, -h, 0.0), (h, -h, 0.0), (h, h, 0.0), (-h, h, 0.0), (0.0, 0.0, height)]
    return vertices, [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (3, 2, 1, 0)]


def stadium(length: float, height: float, segments: int = 16):
    """The outline of a track, standing on z = 0: two half circles joined by straight lines, `length` over all."""
    r = height / 2.0
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, segments)
    right = [(length / 2.0 - r + r * math.cos(a), r + r * math.sin(a)) for a in angles]
    return right + [(-x, z) for x, z in reversed(right)]
