"""The picture of a plot: on the left the albedo by the view's angle, on the right lobes in the plane of incidence.

It has a dark background of its own, so that it is readable in any theme. Each half is a square.
"""
import numpy as np

from .canvas import Canvas
from .quick import VIEWS, Plot

# The side of each half in pixels.
SIDE = 256
# Colors are display RGB, 0..1. BEFORE is for albedos before pumping, UNITY for the albedo 1, WARNING for larger ones.
BACKGROUND, GRID, INK = (0.105, 0.105, 0.11), (0.21, 0.21, 0.22), (0.72, 0.72, 0.72)
CURVE, BEFORE, UNITY, WARNING = (0.62, 0.80, 1.0), (0.50, 0.50, 0.52), (0.82, 0.82, 0.82), (1.0, 0.62, 0.10)
CHANNELS = ((0.98, 0.38, 0.36), (0.42, 0.82, 0.40), (0.42, 0.60, 1.0))
# One color for each of quick.LOBE_VIEWS.
LOBES = ((0.62, 0.80, 1.0), (0.55, 0.88, 0.55), (0.98, 0.56, 0.80))
# The ends of the albedo's axes in pixels.
LEFT, RIGHT, FLOOR, CEILING = 44.0, 246.0, 30.0, 244.0
# The albedos at which the axis may end.
TOPS = (1.25, 2.0, 4.0, 10.0, 40.0, 200.0)
# The center of the lobes, and the radius of the highest peak, in pixels.
CENTRE, RADIUS = (SIDE + 128.0, 30.0), 116.0
# Lobes' radii are proportional to the values or to their square or cube root. POWERS has (largest peak relative to
# white paper, root).
PAPER, POWERS = 1.0 / np.pi, ((8.0, 1), (400.0, 2), (np.inf, 3))


def draw(plot: Plot) -> np.ndarray:
    """The picture, (SIDE, 2 SIDE, 4), float32 display RGBA, 0..1, opaque, the bottom row first."""
    canvas = Canvas(2 * SIDE, SIDE, BACKGROUND)
    _draw_albedo(canvas, plot)
    _draw_lobes(canvas, plot)
    return canvas.pixels


def draw_furnace(plot: Plot, views, measured, noise) -> np.ndarray:
    """The albedo's half, (SIDE, SIDE, 4), with a furnace's albedos `measured` (N, 3) at `views` (N,) in degrees.

    Each value has a horizontal bar, and a vertical one of five standard errors `noise` (N, 3) up and down.
    """
    canvas = Canvas(SIDE, SIDE, BACKGROUND)
    _draw_albedo(canvas, plot)
    top = top_of(plot)
    for channel, colour in enumerate(CHANNELS if plot.albedo.shape[1] == 3 else (INK,)):
        for view, value, error in zip(views, measured[:, channel], noise[:, channel], strict=True):
            (x, y), = place([view], [value], top)
            (_, low), (_, high) = place([view] * 2, [value - 5.0 * error, value + 5.0 * error], top)
            canvas.line([(x, low), (x, high)], colour, 1.5)
            canvas.line([(x - 4.0, y), (x + 4.0, y)], UNITY, 3.0)
    return canvas.pixels


def top_of(plot: Plot) -> float:
    """The albedo at which the axis ends: the first of TOPS that no view up to 85 degrees exceeds, or the last."""
    highest = np.nan_to_num(plot.albedo[VIEWS <= 85.0]).max()
    return next((top for top in TOPS if highest <= top), TOPS[-1])


def place(view, albedo, top: float) -> np.ndarray:
    """Points (N, 2) in pixels of albedos (N,) at views (N,) in degrees. The axis ends at `top`; albedos are clamped."""
    x = LEFT + (RIGHT - LEFT) * np.asarray(view, np.float64) / 90.0
    y = FLOOR + (CEILING - FLOOR) * np.clip(np.asarray(albedo, np.float64) / top, 0.0, 1.02)
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def _draw_albedo(canvas, plot):
    """The albedo's axes and curves."""
    top = top_of(plot)
    _draw_axes(canvas, top)
    curves = plot.albedo.T
    colours = (CURVE,) if len(curves) == 1 else CHANNELS
    # Curves before pumping, a tinted area below a white model's albedo, and the albedos.
    if plot.unpumped is not None:
        for curve in plot.unpumped.T:
            canvas.line(place(VIEWS, curve, top), BEFORE, 2.0)
    if len(curves) == 1:
        canvas.below(place(VIEWS, np.nan_to_num(curves[0]), top), FLOOR, CURVE, 0.12)
    for curve, colour in zip(curves, colours, strict=True):
        canvas.line(place(VIEWS, curve, top), colour, 3.0)
    # Albedos above 1, over all curves: one channel is enough for a warning.
    for curve in curves:
        views, above = _above_one(curve)
        if np.isfinite(above).any():
            canvas.line(place(views, above, top), WARNING, 4.0)


def _above_one(curve, margin=0.002):
    """Views in degrees and albedos of a curve, (361,) both. Albedos up to 1 + `margin`, the curve's error, are NaN."""
    views = np.linspace(0.0, VIEWS[-1], 361)
    albedo = np.interp(views, VIEWS, curve)
    return views, np.where(albedo > 1.0 + margin, albedo, np.nan)


def _draw_axes(canvas, top):
    """The albedo's grid and its labels. `top` is the albedo at which the axis ends."""
    # Views.
    for view in (0.0, 30.0, 60.0, 90.0):
        canvas.line(place([view, view], [0.0, top], top), GRID, 1.0)
        # The number is centered at the tick without its degree sign. The last label would not fit.
        x = place(view, 0.0, top)[0] + 6.0 if view < 90.0 else SIDE - 18.0
        canvas.text(f"{view:g}°", (x, 8.0), INK, align=0.5)
    # Albedos.
    ticks = (0.0, 0.5, 1.0) if top <= 2.0 else (0.0, 1.0, top) if top <= 10.0 else (0.0, top)
    for albedo in ticks:
        y = place(0.0, albedo, top)[1]
        canvas.line([(LEFT, y), (RIGHT, y)], GRID, 1.0)
        canvas.text(f"{albedo:g}"[:3], (LEFT - 8.0, y - 7.0), INK, align=1.0)
    y = place(0.0, 1.0, top)[1]
    canvas.line([(LEFT, y), (RIGHT, y)], UNITY, 1.5, dash=6.0)
    # The title is above the line of 1 if there is room. Higher axes show curves that are high about the normal, so it
    # moves to the right.
    canvas.text("albedo", (0.5 * (LEFT + RIGHT) + (0.0 if top <= 2.0 else 60.0), CEILING - 18.0), INK, align=0.5)


def power_of(plot: Plot) -> int:
    """The root by which lobes' radii depend on the values: 1, 2 or 3."""
    brightest = max(lobe.peak for lobe in plot.lobes) / PAPER
    return next(power for most, power in POWERS if brightest <= most)


def _draw_lobes(canvas, plot):
    """The polar grid, the lobes, their views and their peaks."""
    # The grid.
    arc = np.radians(np.linspace(-90.0, 90.0, 61))
    for fraction in (0.5, 1.0):
        canvas.line(_polar(arc, np.full(61, fraction * RADIUS)), GRID, 1.0)
    for angle in (-90.0, -45.0, 0.0, 45.0, 90.0):
        canvas.line(_polar(np.radians([angle, angle]), [0.0, RADIUS]), GRID, 1.0)
    # Each lobe, relative to the highest peak.
    power = power_of(plot)
    highest = max(lobe.peak for lobe in plot.lobes)
    for i, (lobe, colour) in enumerate(zip(plot.lobes, LOBES, strict=True)):
        angles = np.radians(lobe.angles)
        relative = np.clip(np.nan_to_num(lobe.values), 0.0, highest) / max(highest, 1e-300)
        radii = RADIUS * relative ** (1.0 / power)
        canvas.fan(CENTRE, angles, radii, colour, 0.16)
        canvas.line(_thinned(_polar(angles, radii)), colour, 2.5)
        # The view's angle, the peak, and a mark at the view's direction.
        canvas.text(f"{lobe.view:g}°", (SIDE + 10.0, SIDE - 26.0 - 20.0 * i), colour)
        canvas.text(_short(lobe.peak), (2 * SIDE - 8.0, SIDE - 26.0 - 20.0 * i), colour, align=1.0)
        canvas.line(_polar(np.radians([-lobe.view] * 2), [RADIUS + 3.0, RADIUS + 11.0]), colour, 4.0)
    # The title.
    root = {1: "", 2: "√", 3: "³√"}[power]
    canvas.text(f"{root} f N·L", (CENTRE[0], SIDE - 26.0), INK, align=0.5)
    canvas.text("peak", (CENTRE[0], SIDE - 46.0), INK, align=0.5)


def _polar(angles, radii):
    """Points (N, 2) at `radii` in pixels from CENTRE, at `angles` in radians from the vertical to the right."""
    return np.stack([CENTRE[0] + radii * np.sin(angles), CENTRE[1] + radii * np.cos(angles)], axis=-1)


def _thinned(points, least=0.75):
    """`points` without those nearer than `least` pixels to the previous point of the result. Tips are not removed."""
    radius = np.hypot(*(points - CENTRE).T)
    indices = [0]
    for i in range(1, len(points)):
        tip = 0 < i < len(points) - 1 and radius[i] > radius[i - 1] and radius[i] >= radius[i + 1]
        if tip or i == len(points) - 1 or np.abs(points[i] - points[indices[-1]]).max() >= least:
            indices.append(i)
    return points[indices]


def _short(number):
    """A peak as short text, "-" from 1e6 on."""
    if number >= 1e6:
        return "-"
    return f"{number:.2f}" if number < 10.0 else f"{number:.0f}"
