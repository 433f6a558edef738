"""Images that serve as distributions of half vectors."""
import numpy as np
from scipy import ndimage

from addon.models import exr


def grid(size):
    """x (to the right) and y (up) of the pixels' centers in -1..1, (size, size) each, row 0 at the top."""
    centers = (np.arange(size) + 0.5) * 2.0 / size - 1.0
    return np.meshgrid(centers, -centers)


def spot(size=64, x=0.35, y=0.15, width=0.06):
    """A Gaussian spot at (x, y), (size, size)."""
    across, up = grid(size)
    return np.exp(-((across - x) ** 2 + (up - y) ** 2) / width**2)


def letter(size=64):
    """An F, its strokes a few pixels wide and soft at the edges."""
    x, y = grid(size)
    f = (abs(x + 0.12) < 0.05) & (abs(y) < 0.3) | (x > -0.17) & (abs(y - 0.25) < 0.05) & (x < 0.22)
    return ndimage.gaussian_filter((f | (x > -0.17) & (abs(y) < 0.05) & (x < 0.1)).astype(float), size / 64.0)


def written(folder, gray, name="map.exr"):
    """Writes a picture (N, N) as a float EXR; returns its path."""
    gray = np.asarray(gray, np.float32)
    exr.write(folder / name, np.stack([gray, gray, gray, np.ones_like(gray)], axis=-1), {})
    return str(folder / name)
