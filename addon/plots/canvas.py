"""A picture with anti-aliased lines, areas and text, drawn by NumPy.

Points are (x, y) in pixels from the lower left corner, y up. The center of the first pixel is (0.5, 0.5). Colors are
display RGB, 0..1.
"""
import numpy as np

from . import letters


class Canvas:
    """`pixels` (height, width, 4), float32, 0..1, opaque, the bottom row first as Blender's images have it."""

    def __init__(self, width: int, height: int, background):
        self.pixels = np.ones((height, width, 4), np.float32)
        self.pixels[..., :3] = background

    def blend(self, coverage, colour, at=(slice(None), slice(None))):
        """Blends `colour` over the pixels `at` (rows, columns), with the opacity `coverage` (height, width), 0..1."""
        target = self.pixels[at][..., :3]
        target += coverage[..., None].astype(np.float32) * (np.asarray(colour, np.float32) - target)

    def line(self, points, colour, width: float = 2.5, opacity: float = 1.0, dash: float = 0.0):
        """Draws a line of `width` pixels through `points` (N, 2), N >= 2. Points that are not finite interrupt it.

        `dash` is the length in pixels of the strokes and of the gaps. 0 draws a solid line.
        """
        # The pixels that the line can touch.
        points = np.asarray(points, np.float64)
        known = points[np.isfinite(points).all(axis=1)]
        if not len(known):
            return
        reach = 0.5 * width + 1.0
        rows, columns = self._around(known.min(axis=0) - reach, known.max(axis=0) + reach)
        cover = np.zeros((max(rows.stop - rows.start, 0), max(columns.stop - columns.start, 0)), np.float32)
        # Strokes are united by their maximum, so that joints are not darker.
        for start, end in _strokes(points, dash):
            y, x = self._around(np.minimum(start, end) - reach, np.maximum(start, end) + reach)
            stroke = cover[y.start - rows.start:max(y.stop - rows.start, 0),
                           x.start - columns.start:max(x.stop - columns.start, 0)]
            if stroke.size:
                distance = _distance(y.start, x.start, stroke.shape, start, end)
                np.maximum(stroke, np.clip(0.5 * width + 0.5 - distance, 0.0, 1.0), out=stroke)
        self.blend(opacity * cover, colour, (rows, columns))

    def _around(self, low, high):
        """Slices (rows, columns) of the pixels between two corners (2,), clipped to the picture."""
        most = np.array(self.pixels.shape[1::-1])
        left, bottom = np.clip(np.floor(low), 0, most).astype(int)
        right, top = np.clip(np.ceil(high), 0, most).astype(int)
        return slice(bottom, top), slice(left, right)

    def below(self, points, floor: float, colour, opacity: float):
        """Fills the area between a curve, `points` (N, 2) with x ascending, and the height `floor`."""
        points = np.asarray(points, np.float64)
        low, high = (points[0, 0], floor - 1.0), (points[-1, 0], points[:, 1].max() + 1.0)
        rows, columns = at = self._around(low, high)
        x = np.arange(columns.start, columns.stop) + 0.5
        y = np.arange(rows.start, rows.stop)[:, None] + 0.5
        top = np.interp(x, points[:, 0], points[:, 1])
        inside = np.clip(top - y + 0.5, 0.0, 1.0) * np.clip(y - floor + 0.5, 0.0, 1.0)
        self.blend(opacity * inside, colour, at)

    def fan(self, centre, angles, radii, colour, opacity: float):
        """Fills the area about `centre` inside a polar curve above it.

        The curve has `radii` (N,) in pixels at `angles` (N,), ascending, in radians from the vertical to the right.
        """
        reach = np.max(radii) + 1.0
        rows, columns = at = self._around(np.asarray(centre) - (reach, 1.0), np.asarray(centre) + reach)
        y = np.arange(rows.start, rows.stop)[:, None] + 0.5 - centre[1]
        x = np.arange(columns.start, columns.stop) + 0.5 - centre[0]
        radius = np.interp(np.arctan2(x, y), angles, radii, left=0.0, right=0.0)
        self.blend(opacity * np.clip(radius - np.hypot(x, y) + 0.5, 0.0, 1.0) * (y > -0.5), colour, at)

    def text(self, text: str, at, colour, dot: int = 2, align: float = 0.0):
        """Draws text with its lower left corner at `at`. `align` 0.5 centers it there, 1 ends it there."""
        # The ink, clipped to the picture.
        ink = letters.bitmap(text, dot)[::-1]
        left, low = int(round(at[0] - align * ink.shape[1])), int(round(at[1]))
        height, width = self.pixels.shape[:2]
        ink = ink[max(-low, 0):height - low, max(-left, 0):width - left]
        rows, columns = slice(max(low, 0), max(low, 0) + len(ink)), slice(max(left, 0), max(left, 0) + ink.shape[1])
        self.blend(ink, colour, (rows, columns))


def _strokes(points, dash):
    """Yields (start, end), points (2,), of the straight strokes that a line is drawn as."""
    starts, ends = points[:-1], points[1:]
    known = np.isfinite(starts).all(axis=1) & np.isfinite(ends).all(axis=1)
    for start, end in zip(starts[known], ends[known], strict=True):
        length = float(np.hypot(*(end - start)))
        if not dash or length < dash:
            yield start, end
            continue
        for at in np.arange(0.0, length, 2.0 * dash):
            yield start + at / length * (end - start), start + min(at + dash, length) / length * (end - start)


def _distance(bottom, left, shape, start, end):
    """Distances (shape) of a block of pixels, the first at (`bottom`, `left`), to the line between two points."""
    y = np.arange(shape[0])[:, None] + (bottom + 0.5 - start[1])
    x = np.arange(shape[1]) + (left + 0.5 - start[0])
    along = end - start
    t = np.clip((x * along[0] + y * along[1]) / max(float(along @ along), 1e-12), 0.0, 1.0)
    return np.hypot(x - t * along[0], y - t * along[1])
