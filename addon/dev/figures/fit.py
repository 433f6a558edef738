"""A fit beside what it is fitted to: lobes in the plane of incidence, and the albedo, before, after and wanted.

Of stretched lobes it shows the plane of the tangent.
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
_VISIBLE = 0.01  # of the peak: what a lobe's plot reaches to


def draw(found: fit.Fit, title: str):
    """The figure of a `fit.Fit` as a matplotlib Figure. Of colors it shows the luminance."""
    import matplotlib

    views = _views(found)
    rows, columns = (2, 2) if len(views) == 3 else (1, len(views) + 1)
    height = 0.4 + 3.6 * rows
    with matplotlib.rc_context(STYLE):
        figure = captioned((5.3 * columns, height), title, _caption(found))
        axes = figure.subplots(rows, columns).ravel()
        for at, view in zip(axes, views, strict=False):
            _draw_lobe(at, found, view)
        _draw_albedo(axes[-1], found)
        lines, labels = axes[0].get_legend_handles_labels()
        figure.legend(lines, labels, loc="upper right", ncols=3, bbox_to_anchor=(0.99, 1.0))
    return figure


def _views(found):
    """View angles (degrees) of the plots of lobes: of a table those that it has nearest to VIEWS."""
    if found.target is not None:
        return VIEWS
    there = np.unique(np.degrees(np.arccos(found.samples.view[:, 2])).round(6))
    return np.unique([there[np.abs(there - view).argmin()] for view in VIEWS])


def _caption(found):
    parts = [f"{max(100.0 * error, 1e-3):.3g} % of {name}" for error, name in
             zip(found.errors, ("f (N·L)", "the albedo"), strict=True) if error is not None]
    highest = np.degrees(np.arccos(found.samples.view[:, 2])).max()
    return f"Largest relative error, fitted: {' and '.join(parts)}, at views up to {highest:.3g}°."


def lobe_curve(model, values, view: float, angles):
    """f (N·L) (N,) at light `angles` (degrees, the mirror direction positive) in the plane of incidence."""
    light = in_plane(-np.asarray(angles))
    return luminance(model.evaluate(in_plane(view), light, **values)) * light[:, 2]


def _curves(found):
    """[(model, values, look)] that can be evaluated anywhere."""
    target = [(*found.target, TARGET)] if found.target is not None else []
    return [*target, (found.model, found.start, MATCHED), (found.model, found.parameters, FITTED)]


def _draw_lobe(at, found, view):
    angles = np.linspace(-90.0, 90.0, 7201)
    rows = _draw_rows(at, found, view, angles) if found.target is None else 0.0
    curves = [(lobe_curve(model, values, view, angles), look) for model, values, look in _curves(found)]
    for curve, look in curves:
        at.plot(angles, curve, **look)
    wanted = np.maximum(curves[0 if found.target else -1][0], rows)
    lit = angles[wanted > _VISIBLE * wanted.max()]
    margin = 0.15 * np.ptp(lit) + 0.2
    at.axvline(view, color="#9a9aa2", linewidth=0.9, linestyle=(0, (1, 2)), zorder=0.5)
    # Where the start is far off, the others would be flat lines.
    top = max(wanted.max(), curves[-1][0].max())
    at.set(title=f"View at {view:g}°", xlabel="angle of light in the plane of incidence (degrees)",
           ylabel="f (N·L) (1/sr)", xlim=(max(lit.min() - margin, -90.0), min(lit.max() + margin, 90.0)),
           ylim=(0.0, 1.1 * min(max(top, curves[-2][0].max()), 2.5 * top)))


def _draw_rows(at, found, view, angles):
    """Dots of a table's rows in the plane of incidence; returns them read between at `angles`."""
    rows = found.samples
    phi = np.arctan2(rows.light[:, 1], rows.light[:, 0])
    chosen = (np.abs(rows.light[:, 1]) < 1e-6) & (np.abs(np.degrees(np.arccos(rows.view[:, 2])) - view) < 1e-3)
    tilt = np.degrees(np.arccos(rows.light[chosen, 2])) * np.where(np.abs(phi[chosen]) > 1.0, 1.0, -1.0)
    order = np.argsort(tilt)
    value = luminance(rows.cosine_weighted[chosen])
    if not len(order):
        return np.zeros(len(angles))
    at.plot(tilt[order], value[order], **DOTS)
    return np.interp(angles, tilt[order], value[order], left=0.0, right=0.0)


def _draw_albedo(at, found):
    angles = np.linspace(0.0, 85.0, 86)
    top = 1.0
    for model, values, look in _curves(found):
        albedo = luminance(model.albedo(np.cos(np.radians(angles)), **values))
        at.plot(angles, albedo, **look)
        top = max(top, albedo[angles <= 75.0].max())  # some grow without bound at grazing
    rows = found.samples
    if found.target is None and rows.integrable.any():
        cosines = [rows.view[rows.group == number][0, 2] for number in np.nonzero(rows.integrable)[0]]
        albedo = luminance(rows.albedos(rows.value))
        at.plot(np.degrees(np.arccos(cosines)), albedo, clip_on=False, **DOTS)
        top = max(top, albedo.max())
    at.axhline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 3)))
    at.set(title="Albedo", xlabel="angle of view θ (degrees)", ylabel="albedo a (dimensionless)", xlim=(0.0, 85.0),
           ylim=(0.0, 1.12 * top), xticks=range(0, 86, 15))
