"""The style of all figures: colors, lines, and a page with a title and a caption."""

INK, GREY, FAINT = "#1b1b1d", "#55555c", "#dcdce1"
SHADES = ("#8d99ae", "#3d5a80", "#1f8a70", "#e09f1f", "#b5310f")
STYLE = {
    "font.size": 9.5, "axes.titlesize": 10.5, "axes.spines.top": False, "axes.spines.right": False,
    "axes.edgecolor": "#55555c", "axes.labelcolor": "#1b1b1d", "xtick.color": "#55555c", "ytick.color": "#55555c",
    "axes.grid": True, "grid.color": "#e4e4e8", "grid.linewidth": 0.7, "axes.axisbelow": True, "lines.linewidth": 1.7,
    "legend.frameon": False, "legend.handlelength": 3.0, "svg.hashsalt": "pumping", "svg.fonttype": "path",
}


def captioned(size, title, caption):
    """An empty figure of `size` (inches) with a title above and a caption below."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    head, foot = 0.42 / size[1], (0.16 + 0.17 * caption.count("\n") + 0.22) / size[1]
    figure.get_layout_engine().set(rect=(0.0, foot, 1.0, 1.0 - head - foot), wspace=0.03, hspace=0.03)
    figure.suptitle(title, x=0.012, y=1.0 - 0.12 / size[1], ha="left", va="top", size=13, weight="bold", color=INK)
    figure.text(0.012, 0.1 / size[1], caption, ha="left", va="bottom", size=8.5, color=GREY)
    return figure
