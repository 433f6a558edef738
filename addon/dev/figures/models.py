"""The picture of a model's page: three balls, and beside them the albedos and lobes of the same values.

Source: the model's own formula; only rendering the balls needs bpy.
"""
import tempfile
from pathlib import Path

import numpy as np

from ...forms.files import replacing
from ...models.channels import mean
from ...models.geometry import in_plane
from ..compare import lobes
from ..pages.figure_values import shown
from ..pages.model_page import picture_name
from .compare import VIEWS, _mark, _polar, _protractor
from .style import GREY, INK, SHADES, STYLE

SIZE, DPI = (10.4, 2.15), 100  # inches, pixels an inch
SIDE = 120  # of a ball's tile, pixels
LIGHT = 45.0  # degrees
LINES = (SHADES[1], SHADES[2], SHADES[4])
GRAYS, TINTS = 64, 12  # of the PNG's palette, with TINTS of each of LINES; more make the file larger
TALLEST = 1.3  # albedo where curves are cut


def write(model, folder: Path) -> Path:
    """Renders and draws a model's picture into `folder`; returns its path. Only a complete one replaces an old one."""
    from matplotlib import image

    from ..demo import balls

    with tempfile.TemporaryDirectory(prefix="plausible-") as there:
        tiles = image.imread(balls.render(model, Path(there), SIDE))
    return save(draw(model, tiles, balls.RADIUS / balls.SPACING), folder / picture_name(model))


def draw(model, tiles, radius: float):
    """The picture as a matplotlib Figure. `tiles`: balls side by side, (side, 3 side, 3) in 0..1; `radius` in sides."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    this, side = shown(model), tiles.shape[0]
    with matplotlib.rc_context({**STYLE, "font.size": 8.5}):
        figure = Figure(figsize=SIZE, dpi=DPI)
        FigureCanvasAgg(figure)
        for i, (value, color) in enumerate(zip(this.values, LINES, strict=True)):
            at = figure.add_axes((0.005 + 0.17 * i, 0.14, 0.165, 0.84))
            tile = tiles[:, i * side:(i + 1) * side, :3]
            at.imshow(1.0 - (1.0 - tile) * _disk(side, radius), interpolation="bilinear", vmin=0.0, vmax=1.0)
            at.set_axis_off()
            at.text(0.5, -0.02, this.label(value), transform=at.transAxes, ha="center", va="top", color=color,
                    size=9.0, weight="bold")
        _albedos(figure.add_axes((0.565, 0.17, 0.18, 0.71)), model, this)
        _lobes(figure.add_axes((0.765, 0.03, 0.23, 0.88)), model, this)
    return figure


def _disk(side, radius):
    """Mask (side, side, 1): 1 inside a ball and 0 outside, where the picture is the page's white."""
    x = np.arange(side) + 0.5 - 0.5 * side
    return np.clip(radius * side - np.hypot(x, x[:, None]) + 0.5, 0.0, 1.0)[..., None]


def _albedos(at, model, this):
    angles = np.linspace(0.0, 89.0, 90)
    for given, color in zip(this.settings(), LINES, strict=True):
        at.plot(angles, mean(model.albedo(np.cos(np.radians(angles)), **given)), color=color, linewidth=1.4)
    at.axhline(1.0, color=INK, linewidth=0.7, linestyle=(0, (4, 3)))
    at.set(xlim=(0.0, 90.0), ylim=(0.0, min(max(1.08, 1.03 * at.get_ylim()[1]), TALLEST)), xticks=range(0, 91, 30),
           xticklabels=[f"{angle}°" for angle in range(0, 91, 30)])
    at.set_title("albedo by the view's angle", size=8.5, color=GREY, pad=3.0)


def _lobes(at, model, this):
    _protractor(at)
    _mark(at, LIGHT, GREY)
    plane = [1, 0, 2] if this.is_across else [0, 1, 2]
    view, light = (in_plane(angles)[:, plane] for angles in (VIEWS, -LIGHT))
    for given, color in zip(this.settings(), LINES, strict=True):
        f = lobes.value(model, view, light, lobes.glossy(model, given))
        _polar(at, f / f.max(), color, filled=False)
    at.set(xlim=(-1.2, 1.2), ylim=(-0.12, 1.2), aspect="equal")
    at.set_axis_off()
    at.set_title(f"f over its peak, light at {LIGHT:g}°", size=8.5, color=GREY, pad=0.0)


def save(figure, path: Path) -> Path:
    """Write a figure as a PNG with a palette of grays and of tints of LINES; returns `path`."""
    from PIL import Image

    figure.canvas.draw()
    indexed = Image.fromarray(_nearest(np.asarray(figure.canvas.buffer_rgba())[..., :3], _palette()))
    indexed.putpalette(_palette().ravel().tolist())
    with replacing(path) as beside:
        indexed.save(beside, format="PNG", optimize=True)
    return path


def _nearest(pixels, palette):
    """Index (height, width) of the nearest color in `palette` (colors, 3) of each of `pixels` (height, width, 3)."""
    distinct, inverse = np.unique(pixels.reshape(-1, 3).astype(int), axis=0, return_inverse=True)
    index = ((distinct[:, None] - palette) ** 2).sum(axis=-1).argmin(axis=1)
    return index[inverse.ravel()].reshape(pixels.shape[:2]).astype(np.uint8)


def _palette():
    """Colors (GRAYS + TINTS for each of LINES, 3) of 0 to 255."""
    from matplotlib.colors import to_rgb

    grays = np.linspace(0.0, 1.0, GRAYS)[:, None] * np.ones(3)
    share = np.linspace(1.0, 0.0, TINTS, endpoint=False)[:, None]
    tints = [share * to_rgb(color) + 1.0 - share for color in LINES]
    return np.round(255.0 * np.concatenate([grays, *tints])).astype(int)
