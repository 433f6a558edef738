"""The contact sheet: the panels side by side under their captions, pixel for pixel."""
from pathlib import Path

MARGIN, GAP, HEAD, CAPTION = 28, 14, 92, 30  # pixels, for panels 480 wide; text shrinks with narrower ones
SMALLEST = 0.62  # of that text: what can still be read
INK, PAPER, FAINT = "#1b1b1d", "#ffffff", "#6a6a70"


def compose(paths, captions, columns: int, title: str, note: str, output: Path):
    """Write the pictures `paths` (PNG, all of one size) with their `captions`, row by row, to the PNG `output`."""
    from matplotlib import image
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    pictures = [image.imread(path) for path in paths]
    height, width = pictures[0].shape[:2]
    scale = min(max(width / 480.0, SMALLEST), 1.0)
    rows = -(-len(pictures) // columns)
    full_width = 2 * MARGIN + columns * width + (columns - 1) * GAP
    full_height = HEAD + rows * (height + CAPTION) + (rows - 1) * GAP + MARGIN
    figure = Figure(figsize=(full_width / 100.0, full_height / 100.0), dpi=100, facecolor=PAPER)
    FigureCanvasAgg(figure)
    figure.text(MARGIN / full_width, 1.0 - 33 / full_height, title, color=INK, size=15 * scale, va="center",
                weight="bold")
    figure.text(MARGIN / full_width, 1.0 - 50 / full_height, note, color=FAINT, size=9 * scale, va="top",
                linespacing=1.4)
    for index, (picture, caption) in enumerate(zip(pictures, captions, strict=True)):
        row, column = divmod(index, columns)
        left = MARGIN + column * (width + GAP)
        top = HEAD + row * (height + CAPTION + GAP)
        # figimage puts pixels on pixels; its origin is the figure's lower left corner.
        figure.figimage(picture, left, full_height - top - height, origin="upper")
        figure.text((left + 1) / full_width, 1.0 - (top + height + 15) / full_height, caption, color=INK,
                    size=10.5 * scale, va="center")
    figure.savefig(output, dpi=100, facecolor=PAPER)
