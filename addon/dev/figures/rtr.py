"""Figure 7.38 of Real-Time Rendering, rendered: the original Phong highlight above, the normalized one below.

Source: Akenine-Möller, Haines, Hoffman, "Real-Time Rendering", 3rd ed., 2008. Only drawing
needs bpy.
"""
import tempfile
from pathlib import Path

import numpy as np

from .style import STYLE, captioned

SET = ("phong",)
RESOLUTION, SAMPLES = (880, 440), 64  # twice as wide as high
GROUND = 0.82  # gray, so that the dark side of a sphere is seen against it
ROWS = ("original, kₛ (R·L)ᵐ", "normalized, c (m+2)/(2π) (R·L)ᵐ")


def draw(name: str):
    """The figure `name` of SET as a matplotlib Figure, rendered at RESOLUTION. Raises ValueError for another name."""
    if name not in SET:
        raise ValueError(f"no figure {name!r}; there are {', '.join(SET)}")
    from matplotlib import image

    from ..demo import phong_row

    with tempfile.TemporaryDirectory(prefix="plausible-") as folder:
        picture = image.imread(phong_row.render(Path(folder), RESOLUTION, SAMPLES))
    return _assemble(picture, phong_row)


def _before_ground(tile, radius):
    """A tile (side, side, 3) with GROUND outside the centered sphere of `radius` pixels."""
    x = np.arange(len(tile)) + 0.5 - 0.5 * len(tile)
    inside = np.clip(radius - np.hypot(x, x[:, None]) + 0.5, 0.0, 1.0)[..., None]
    return inside * tile + (1.0 - inside) * GROUND


def _assemble(picture, row):
    """The figure: a tile for each sphere, with its m and its specular factor."""
    import matplotlib

    side = picture.shape[0] // 2
    with matplotlib.rc_context(STYLE):
        figure = captioned((9.6, 5.95), "Highlights of red plastic under a sun, not normalized and normalized", (
            f"After figure 7.38 of Real-Time Rendering: c = {row.SPECULAR:g}, a diffuse part of {row.DIFFUSE[0]:g} in "
            "red; kₛ is chosen so that the two leftmost spheres match.\n"
            "One sun, one exposure. Normalized, the highlight grows brighter as it gets narrower; not normalized, its "
            "light is lost."))
        tiles = figure.subplots(2, len(row.EXPONENTS))
        for i, title in enumerate(ROWS):
            for j, exponent in enumerate(row.EXPONENTS):
                at = tiles[i, j]
                tile = picture[i * side:(i + 1) * side, j * side:(j + 1) * side, :3]
                at.imshow(_before_ground(tile, row.RADIUS / row.SPACING * side), interpolation="none")
                at.set(xticks=(), yticks=(), xlabel=f"m = {exponent:g},  factor {row.scale(exponent, i == 1):.3f} 1/sr")
                at.spines[:].set_visible(False)
            tiles[i, 0].set_ylabel(title)
    return figure
