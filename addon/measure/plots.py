"""Plots of measurements: lines are the formula, dots the renders. Needs matplotlib."""
from pathlib import Path

import numpy as np

from ..models.channels import LUMINANCE
from .comparison import SIGMAS

INK, FAINT, BAND = "#2b2d33", "#d9dbe1", "#e9f1ec"
VIEWS = ("#1b6ca8", "#d1495b", "#2e8b57", "#e09f3e", "#6a4c93", "#3a9d9d")
CHANNELS = (("red", "#c8403c"), ("green", "#3b9450"), ("blue", "#3868b8"))


def _pyplot():
    """The module matplotlib.pyplot, set up without a window. Raises ValueError where matplotlib is missing."""
    try:
        import matplotlib
    except ImportError:
        raise ValueError("the plot needs matplotlib: install it with `pip install matplotlib`") from None
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({
        "font.size": 10, "axes.edgecolor": INK, "axes.labelcolor": INK, "text.color": INK, "xtick.color": INK,
        "ytick.color": INK, "axes.grid": True, "grid.color": FAINT, "grid.linewidth": 0.7, "axes.axisbelow": True,
        "axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 130, "savefig.facecolor": "white",
    })
    return plt


def check(path):
    """Raises ValueError where no plot could be written to `path`. Call it before minutes of rendering."""
    _pyplot()
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise ValueError(f"{path} is not named .png")
    if not path.parent.is_dir():
        raise ValueError(f"no folder {path.parent}")


def _is_gray(values):
    return np.ptp(values, axis=-1).max() <= 1e-6 * max(np.abs(values).max(), 1e-30)


def _series(values, reference):
    """(label, color, channel) of the lines to draw: one line where all values are gray, else one for each channel."""
    if _is_gray(values) and (reference is None or _is_gray(reference)):
        return [("", VIEWS[0], 0)]
    return [(name, color, channel) for channel, (name, color) in enumerate(CHANNELS)]


def furnace(path, title: str, angles_deg, measured, noise, comparison=None, curve=None):
    """Plots the albedo over the view angle, and below it the error where there is a `comparison`. Writes a PNG.

    `angles_deg` is (N,), `measured` and `noise` are (N, 3). `curve` is the formula's (angles in degrees (M,), albedo
    (M, 3)), or None.
    """
    plt = _pyplot()
    # A second, lower plot holds the errors.
    rows = 1 if comparison is None else 2
    figure, axes = plt.subplots(rows, 1, figsize=(7.2, 3.6 + 2.0 * (rows - 1)), sharex=True, squeeze=False,
                                gridspec_kw={"height_ratios": [2.2, 1.0][:rows]}, layout="constrained")
    upper = axes[0, 0]
    for label, color, channel in _series(measured, None if curve is None else curve[1]):
        if curve is not None:
            upper.plot(curve[0], curve[1][:, channel], color=color, lw=1.6, label=f"formula {label}".strip())
        upper.errorbar(angles_deg, measured[:, channel], SIGMAS * noise[:, channel], fmt="o", ms=5, color=color,
                       mfc="white", mew=1.4, capsize=2, label=f"rendered {label}".strip(), zorder=3)
    # The dashed line at 1 is the limit of a plausible albedo.
    top = max(1.0, measured.max(), 0.0 if curve is None else curve[1].max())
    upper.set(ylabel="albedo", title=title, xlim=(-2.0, 91.0), ylim=(0.0, 1.06 * top))
    upper.axhline(1.0, color=INK, lw=0.8, ls=(0, (4, 3)))
    upper.legend(frameon=False, loc="lower left", fontsize=9, ncols=2)
    if comparison is not None:
        _errors(axes[1, 0], angles_deg, comparison, "error, bars 5σ", 1.0)
    axes[-1, 0].set(xlabel="view angle from the normal [degrees]", xticks=range(0, 91, 10))
    figure.savefig(path)
    plt.close(figure)


def _errors(axis, x, comparison, label, unit):
    """Plots errors and their bars over `x`, and a band for the tolerance; `unit` divides the values."""
    tolerance = comparison.tolerance / unit
    axis.axhspan(-tolerance, tolerance, color=BAND, lw=0)
    axis.axhline(0.0, color=INK, lw=0.8)
    for _, color, channel in _series(comparison.measured, comparison.reference):
        axis.errorbar(x, comparison.error[:, channel] / unit, SIGMAS * comparison.noise[:, channel] / unit,
                      fmt="o", ms=4, color=color, mfc="white", mew=1.2, capsize=2, lw=1.0)
    reach = max(1.4 * tolerance, 1.15 * (np.abs(comparison.error) + SIGMAS * comparison.noise).max() / unit)
    axis.set(ylabel=label, ylim=(-reach, reach))
    axis.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)


def goniometer(path, title: str, sweeps):
    """Plots lobes f(V, L)(N·L) in 1/sr: in the plane of incidence (polar), across it, and the errors. Writes a PNG.

    `sweeps` are dicts with view_deg, plane ("incidence" or "across"), angles_deg (N,), measured (N, 3), noise (N, 3),
    curve (None, or angles (M,) and values (M, 3)) and comparison (or None), all of f(V, L)(N·L). A sweep with a
    comparison has its peak, too.
    """
    plt = _pyplot()
    compared = any(sweep["comparison"] is not None for sweep in sweeps)
    figure = plt.figure(figsize=(11.5, 5.2), layout="constrained")
    figure.suptitle(title, fontsize=12)
    # The polar plot fills the left side; the other plots share the right side.
    grid = figure.add_gridspec(2 if compared else 1, 2, width_ratios=[1.3, 1.0])
    lobe = figure.add_subplot(grid[:, 0], projection="polar")
    across = figure.add_subplot(grid[0, 1])
    colors = {view: VIEWS[i % len(VIEWS)] for i, view in enumerate(dict.fromkeys(s["view_deg"] for s in sweeps))}
    # One color a view; angles are radians in the polar plot.
    for sweep in sweeps:
        color, flat = colors[sweep["view_deg"]], sweep["plane"] == "incidence"
        axis, turn = (lobe, np.radians) if flat else (across, np.asarray)
        if sweep["curve"] is not None:
            axis.plot(turn(sweep["curve"][0]), sweep["curve"][1] @ LUMINANCE, color=color, lw=1.5)
        axis.plot(turn(sweep["angles_deg"]), sweep["measured"] @ LUMINANCE, "o", ms=4, color=color, mfc="white",
                  mew=1.1, label=f"view at {sweep['view_deg']:g}°", zorder=3)
    what = "" if all(_is_gray(sweep["measured"]) for sweep in sweeps) else "luminance, "
    _finish_lobe(lobe, sweeps, colors, what + ("dots rendered, lines formula" if compared else "rendered"))
    across.set(xlabel="angle off the plane of incidence [degrees]", ylabel=r"$f\,(N\!\cdot\!L)$  [1/sr]")
    across.set_ylim(bottom=0.0)
    if compared:
        _lobe_errors(figure.add_subplot(grid[1, 1]), sweeps, colors)
    figure.savefig(path)
    plt.close(figure)


def _finish_lobe(axis, sweeps, colors, caption):
    """Shows the half disk above the surface, its normal up, marks the viewers on the rim, and adds the legend."""
    axis.set_theta_zero_location("N")
    axis.set_theta_direction(-1)
    axis.set_thetalim(-np.pi / 2, np.pi / 2)
    axis.set_thetagrids(range(-90, 91, 30), [f"{abs(a)}°" for a in range(-90, 91, 30)])
    top = 1.08 * max(float((s["measured"] @ LUMINANCE).max()) for s in sweeps if s["plane"] == "incidence")
    axis.set_ylim(0.0, top if top > 0.0 else 1.0)
    axis.set_rlabel_position(-90)
    axis.tick_params(axis="y", labelsize=8)
    axis.set_title(r"plane of incidence: $f\,(N\!\cdot\!L)$ [1/sr] over the light's angle", fontsize=10)
    for view, color in colors.items():
        axis.plot([-np.radians(view)], [0.985 * axis.get_ylim()[1]], marker=(3, 0, view + 180), ms=9, color=color,
                  clip_on=False, ls="none")
    axis.legend(frameon=False, fontsize=9, ncols=4, loc="upper center", bbox_to_anchor=(0.5, 0.14),
                columnspacing=1.4, handletextpad=0.2, title=f"{caption}; triangles are the viewers",
                title_fontsize=9)


def _lobe_errors(axis, sweeps, colors):
    """Plots errors in per cent of each sweep's own peak, in the plane (dots) and across it (crosses)."""
    reach = 0.0
    for sweep in (s for s in sweeps if s["comparison"] is not None):
        comparison = sweep["comparison"]
        peak = sweep["peak"] / 100.0
        error = comparison.error @ LUMINANCE / peak
        bar = SIGMAS * (comparison.noise @ LUMINANCE) / peak
        flat = sweep["plane"] == "incidence"
        axis.errorbar(sweep["angles_deg"], error, bar, fmt="o" if flat else "x", ms=4, mfc="white", mew=1.1, lw=0.8,
                      color=colors[sweep["view_deg"]])
        band = comparison.tolerance / peak
        reach = max(reach, 1.3 * band, 1.15 * float((np.abs(error) + bar).max()))
    axis.axhspan(-band, band, color=BAND, lw=0)
    axis.axhline(0.0, color=INK, lw=0.8)
    axis.set(xlabel="light in the plane of incidence (dots), off it (crosses) [degrees]",
             ylabel="error [% of the peak], bars 5σ", ylim=(-reach, reach))


def chi_square(path, title: str, result):
    """Plots the drawn density, the claimed density, and their difference in standard deviations. Writes a PNG.

    `result` is a `statistics.chi_square.ChiSquare`. All cells are drawn in one size; the ticks give their edges.
    """
    plt = _pyplot()
    # Both densities share a logarithmic scale over four decades.
    figure, axes = plt.subplots(1, 3, figsize=(13.0, 4.4), layout="constrained", sharex=True, sharey=True)
    area = np.diff(result.azimuths)[:, None] * np.diff(result.cosines)
    total = result.counts.sum() + result.undrawn[0]
    drawn, claimed = result.counts / total / area, result.expected / total / area
    peak = max(drawn.max(), 1e-30)
    for axis, density, label in ((axes[0], drawn, "drawn"), (axes[1], claimed, "claimed")):
        image = axis.imshow(np.maximum(density, 1e-6 * peak).T, norm="log", vmin=1e-4 * peak, vmax=peak, cmap="viridis",
                            origin="lower", aspect="auto", interpolation="nearest")
        axis.set_title(f"{label} [1/sr]", fontsize=10)
    figure.colorbar(image, ax=list(axes[:2]), fraction=0.04)
    # A count's standard deviation is the root of its expectation.
    spread = np.sqrt(np.maximum(result.expected, 1.0))
    image = axes[2].imshow(((result.counts - result.expected) / spread).T, vmin=-4.0, vmax=4.0, cmap="RdBu_r",
                           origin="lower", aspect="auto", interpolation="nearest")
    axes[2].set_title("drawn less claimed, in standard deviations", fontsize=10)
    figure.colorbar(image, ax=axes[2], fraction=0.08)
    for axis in axes:
        axis.grid(False)
        axis.set_xlabel("azimuth [degrees], cells as they are")
        axis.set_xticks(*_ticks(np.degrees(result.azimuths)))
    axes[0].set_ylabel("cosine from the normal")
    axes[0].set_yticks(*_ticks(result.cosines))
    strays = f", {result.strays} where the density is 0" if result.strays else ""
    fine, coarse = (f"χ² = {test.statistic:.0f} of {test.degrees} degrees" for test in (result.fine, result.coarse))
    figure.suptitle(f"{title}{': ' if title else ''}p = {result.p_value:.3g}, {fine}, coarse {coarse}, integral "
                    f"{result.integral:.5f}{strays}", fontsize=11)
    figure.savefig(path)
    plt.close(figure)


def _ticks(edges, count=5):
    """Positions and labels of `count` of the cells' `edges`, where all cells are drawn equally wide."""
    chosen = np.linspace(0, len(edges) - 1, count).round().astype(int)
    return chosen - 0.5, [f"{round(edges[i], 9) + 0.0:.4g}" for i in chosen]
