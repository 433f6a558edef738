"""A fit and its target: lobes in the plane of incidence and albedos, of the target, the start and the fit.

Stretched lobes are shown in the plane of the tangent.
"""
import numpy as np

from ...fitting import fit
from ...models.channels import luminance
from ...models.geometry import in_plane
from .style import INK, SHADES, STYLE, captioned

VIEWS = (0.0, 40.0, 70.0)  # degrees
# (label, line of the target, of the start, of the fit); the wide pale line shows through what lies on it.
TARGET = {"label": "target", "color": "#b8bdc9", "linewidth": 5.0, "solid_capstyle": "butt"}
MATCHED = {"label": "matched by width", "color": SHADES[1], "linestyle": (0, (5, 3))}
FITTED = {"label": "fitted", "color": SHADES[4]}
DOTS = {"label": "target", "color": "#8d94a5", "linestyle": "none", "marker": "o", "markersize": 4.5}
_VISIBLE = 0.01  # of the peak: the plot of a lobe ends where f falls below


def draw(fitted: fit.Fit, title: str):
    """The figure of a `fit.Fit` as a matplotlib Figure. Colors are shown by their luminance."""
    import matplotlib

    views = _views(fitted)
    rows, columns = (2, 2) if len(views) == 3 else (1, len(views) + 1)
    height = 0.4 + 3.6 * rows
    with matplotlib.rc_context(STYLE):
        figure = captioned((5.3 * columns, height), title, _caption(fitted))
        axes = figure.subplots(rows, columns).ravel()
        for at, view in zip(axes, views, strict=False):
            _draw_lobe(at, fitted, view)
        _draw_albedo(axes[-1], fitted)
        lines, labels = axes[0].get_legend_handles_labels()
        figure.legend(lines, labels, loc="upper right", ncols=3, bbox_to_anchor=(0.99, 1.0))
    return figure


def _views(fitted):
    """View angles (degrees) of the plots of lobes: VIEWS, or a table's angles nearest to them."""
    if fitted.target is not None:
        return VIEWS
    available = np.unique(np.degrees(np.arccos(fitted.samples.view[:, 2])).round(6))
    return np.unique([available[np.abs(available - view).argmin()] for view in VIEWS])


def _caption(fitted):
    errors = [f"{max(100.0 * error, 1e-3):.3g} % of {name}" for error, name in
              zip(fitted.errors, ("f (N·L)", "the albedo"), strict=True) if error is not None]
    highest = np.degrees(np.arccos(fitted.samples.view[:, 2])).max()
    return f"Largest relative error, fitted: {' and '.join(errors)}, at views up to {highest:.3g}°."


def lobe_curve(model, values, view: float, angles):
    """f (N·L) (N,) at light `angles` (degrees, the mirror direction positive) in the plane of incidence."""
    light = in_plane(-np.asarray(angles))
    return luminance(model.evaluate(in_plane(view), light, **values)) * light[:, 2]


def _curves(fitted):
    """[(model, values, look)] of the curves: the target where it is a model, the start and the fit."""
    target = [(*fitted.target, TARGET)] if fitted.target is not None else []
    return [*target, (fitted.model, fitted.start, MATCHED), (fitted.model, fitted.parameters, FITTED)]


def _draw_lobe(at, fitted, view):
    angles = np.linspace(-90.0, 90.0, 7201)
    rows = _draw_rows(at, fitted, view, angles) if fitted.target is None else 0.0
    curves = [(lobe_curve(model, values, view, angles), look) for model, values, look in _curves(fitted)]
    for curve, look in curves:
        at.plot(angles, curve, **look)
    target = np.maximum(curves[0 if fitted.target else -1][0], rows)
    lit = angles[target > _VISIBLE * target.max()]
    margin = 0.15 * np.ptp(lit) + 0.2
    at.axvline(view, color="#9a9aa2", linewidth=0.9, linestyle=(0, (1, 2)), zorder=0.5)
    # A start far from the target must not flatten the other curves.
    top = max(target.max(), curves[-1][0].max())
    at.set(title=f"View at {view:g}°", xlabel="angle of light in the plane of incidence (degrees)",
           ylabel="f (N·L) (1/sr)", xlim=(max(lit.min() - margin, -90.0), min(lit.max() + margin, 90.0)),
           ylim=(0.0, 1.1 * min(max(top, curves[-2][0].max()), 2.5 * top)))


def _draw_rows(at, fitted, view, angles):
    """Plots a table's rows in the plane of incidence as dots; returns them interpolated at `angles`."""
    rows = fitted.samples
    phi = np.arctan2(rows.light[:, 1], rows.light[:, 0])
    chosen = (np.abs(rows.light[:, 1]) < 1e-6) & (np.abs(np.degrees(np.arccos(rows.view[:, 2])) - view) < 1e-3)
    tilt = np.degrees(np.arccos(rows.light[chosen, 2])) * np.where(np.abs(phi[chosen]) > 1.0, 1.0, -1.0)
    order = np.argsort(tilt)
    value = luminance(rows.cosine_weighted[chosen])
    if not len(order):
        return np.zeros(len(angles))
    at.plot(tilt[order], value[order], **DOTS)
    return np.interp(angles, tilt[order], value[order], left=0.0, right=0.0)


def _draw_albedo(at, fitted):
    angles = np.linspace(0.0, 85.0, 86)
    top = 1.0
    for model, values, look in _curves(fitted):
        albedo = luminance(model.albedo(np.cos(np.radians(angles)), **values))
        at.plot(angles, albedo, **look)
        top = max(top, albedo[angles <= 75.0].max())  # some grow without bound at grazing
    rows = fitted.samples
    if fitted.target is None and rows.integrable.any():
        cosines = [rows.view[rows.group == number][0, 2] for number in np.nonzero(rows.integrable)[0]]
        albedo = luminance(rows.albedos(rows.value))
        at.plot(np.degrees(np.arccos(cosines)), albedo, clip_on=False, **DOTS)
        top = max(top, albedo.max())
    at.axhline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 3)))
    at.set(title="Albedo", xlabel="angle of view θ (degrees)", ylabel="albedo a (dimensionless)", xlim=(0.0, 85.0),
           ylim=(0.0, 1.12 * top), xticks=range(0, 86, 15))
