"""The highlight that the model `ndf_map` has without an image: a star of six points with a soft core."""
import platform

import numpy as np

from ..models import exr
from ..models.formulas.ndf_map import SHIPPED

SIZE = 128  # pixels across
CORE, HALO = (1.0, 0.045), (0.03, 0.3)  # height and width of the bells, in radii of the disk
RAY_HEIGHT, RAY_WIDTH, RAY_LENGTH = 0.45, 0.035, 0.13


def star() -> np.ndarray:
    """Pixels (SIZE, SIZE, 4), float32: relative densities, gray, the same upside down and from left to right."""
    at = (np.arange(SIZE) + 0.5) * 2.0 / SIZE - 1.0
    x, y = np.meshgrid(at, at)
    radius = np.hypot(x, y)
    p = sum(height * np.exp(-((radius / width) ** 2)) for height, width in (CORE, HALO))
    for angle in np.radians((0.0, 60.0, 120.0)):
        along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        p = p + RAY_HEIGHT * np.exp(-((across / RAY_WIDTH) ** 2) - np.abs(along) / RAY_LENGTH)
    p = np.where(radius < 1.0, 0.5 * (p + p[::-1]), 0.0)  # rounding is no side
    gray = (0.5 * (p + p[:, ::-1])).astype(np.float32)
    return np.stack([gray, gray, gray, np.ones_like(gray)], axis=-1)


def write(folder):
    """Write the image to a folder; returns its path. Raises OSError when it cannot."""
    path = folder / SHIPPED
    exr.write(path, star(), {
        "plausible:model": "ndf_map: relative density of half vectors, the hemisphere from above, tangent to the right",
        "plausible:formula": f"bells (height, width) {CORE}, {HALO}; three lines 60 degrees apart, "
                             f"{RAY_HEIGHT} exp(-(across/{RAY_WIDTH})² - |along|/{RAY_LENGTH})",
        "plausible:software": f"Plausible BRDF, NumPy {np.__version__}, Python {platform.python_version()}",
    })
    return path
