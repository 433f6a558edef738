"""The default image of the model `ndf_map`: a star of six points with a soft core."""
import platform

import numpy as np

from ..models import exr
from ..models.formulas.ndf_map import SHIPPED

# Pixels across.
SIZE = 128
# The bells' (height, width). Widths are in radii of the disk.
CORE, HALO = (1.0, 0.045), (0.03, 0.3)
# The rays: their height at the center, and the widths and lengths, in radii, over which they fall.
RAY_HEIGHT, RAY_WIDTH, RAY_LENGTH = 0.45, 0.035, 0.13


def star() -> np.ndarray:
    """Pixels (SIZE, SIZE, 4), float32: relative densities in gray, symmetric about both axes."""
    # Two bells.
    at = (np.arange(SIZE) + 0.5) * 2.0 / SIZE - 1.0
    x, y = np.meshgrid(at, at)
    radius = np.hypot(x, y)
    p = sum(height * np.exp(-((radius / width) ** 2)) for height, width in (CORE, HALO))
    # Three lines through the center.
    for angle in np.radians((0.0, 60.0, 120.0)):
        along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        p = p + RAY_HEIGHT * np.exp(-((across / RAY_WIDTH) ** 2) - np.abs(along) / RAY_LENGTH)
    # The means with the mirror images remove the asymmetry of rounding.
    p = np.where(radius < 1.0, 0.5 * (p + p[::-1]), 0.0)
    gray = (0.5 * (p + p[:, ::-1])).astype(np.float32)
    return np.stack([gray, gray, gray, np.ones_like(gray)], axis=-1)


def write(folder):
    """Writes the image to `folder` and returns its path. Raises OSError if that fails."""
    path = folder / SHIPPED
    exr.write(path, star(), {
        "plausible:model": "ndf_map: relative density of half vectors, the hemisphere from above, tangent to the right",
        "plausible:formula": f"bells (height, width) {CORE}, {HALO}; three lines 60 degrees apart, "
                             f"{RAY_HEIGHT} exp(-(across/{RAY_WIDTH})² - |along|/{RAY_LENGTH})",
        "plausible:software": f"Plausible BRDF, NumPy {np.__version__}, Python {platform.python_version()}",
    })
    return path
