"""Lobes of all models in the plane of incidence, matched in width, as in figures 2 to 4 of Sawicki's comparison.

Source: D. Sawicki, "Modeling the metallic reflection using appropriate BRDF model". Every model has the half angle of
He-Torrance's model on one surface. A lobe is f for a fixed light over the view's angle, divided by its peak: the paper
does not give its normalization. The plane contains the tangent.
"""
from dataclasses import dataclass

import numpy as np

from ... import brdf
from ...models.formula_model import FormulaModel
from ...models.lobes import DISK
from ...models.pumped_model import PumpedModel
from ..compare import agreement, lobes, published
from .style import FAINT, GREY, INK, SHADES, STYLE, captioned

LIGHTS = (15.0, 30.0, 45.0, 60.0, 70.0, 80.0)  # degrees; 15 to 60 are figure 2's, 70 figure 3's, 80 figure 4's
VIEWS = np.linspace(-89.5, 89.5, 1433)
SURFACE = agreement.SURFACES[0]
COLOURS = (*SHADES, "#6b1d5c")  # of LIGHTS
MODEL_COLOURS = (INK, *SHADES[1:], "#a35bb5")  # of the models of the first page
PUBLISHED = "published"
TITLES = {
    PUBLISHED: "The compared models at each angle of incidence",
    "phong": "Lobes of the Phong and Blinn family",
    "literature": "Lobes of the literature's models",
    "pumped": "Lobes of the literature's models, pumped up",
    "disk": "Lobes on the halfway vector disk",
}
SET = tuple(TITLES)


@dataclass(frozen=True)
class Lobes:
    """Lobes of a model with the parameters `given`, for each of LIGHTS.

    `curves` (lights, VIEWS) are f over its peak, `heights` (lights,) that peak over f at normal incidence; `angle` is
    the half angle (degrees).
    """

    model: object
    given: dict
    angle: float
    curves: np.ndarray
    heights: np.ndarray


def lobes_of(model) -> Lobes:
    """The model's lobes, matched in width to He-Torrance's on SURFACE, or of the default width where none matches."""
    given = lobes.those(model, **SURFACE)
    angle = lobes.half_angle(brdf.MODELS["he_torrance"], SURFACE)
    try:
        given = lobes.matched(model, angle, given)
    except ValueError:
        angle = lobes.half_angle(model, given)
    f = np.array([lobes.lobe(model, light, VIEWS, given) for light in LIGHTS])
    peaks = f.max(axis=1)
    return Lobes(model, given, angle, f / peaks[:, None], peaks / lobes.lobe(model, 0.0, 0.0, given))


def page_of(model) -> str:
    """The page of SET that shows a model. The page of the models that the paper compares is separate."""
    if isinstance(model, PumpedModel):
        return "pumped"
    if not isinstance(model, FormulaModel):
        return "phong" if getattr(model, "lobe", DISK) is not DISK else "disk"
    return "phong" if model.id.startswith(("phong", "blinn", "weighted")) else "literature"


def draw(name: str):
    """The figure `name` of SET as a matplotlib Figure. Raises ValueError for another name."""
    import matplotlib

    if name not in SET:
        raise ValueError(f"no figure {name!r}; there are {', '.join(SET)}")
    with matplotlib.rc_context(STYLE):
        return _draw_published() if name == PUBLISHED else _draw_models(name)


def _draw_models(name):
    """A panel for each model of a page, in it a lobe for each light."""
    models = [model for model in brdf.MODELS.values() if page_of(model) == name]
    caption = ("f over its peak, by the angle of the view from the normal (degrees). Dashed rays: lights; dots: their "
               "mirror directions. Numbers: height of the peak over f at normal incidence.\n" + _matched_note())
    if any(model.id == "kajiya_kay" for model in models):
        caption += "\nKajiya-Kay: the plane contains the strands; across them f is the same for all views."
    columns = min((4, 3, 5), key=lambda c: -len(models) % c)  # with the fewest empty panels
    figure, axes = _panels(TITLES[name], caption, len(models), columns, 0.36)
    for at, model in zip(axes, models, strict=True):
        shown = lobes_of(model)
        _protractor(at)
        for light, curve, color in zip(LIGHTS, shown.curves, COLOURS, strict=True):
            _polar(at, curve, color)
            _mark(at, light, color)
        at.set_title(model.label, pad=2.0)
        at.text(0.0, 1.07, _shape_note(shown), ha="center", size=7.5, color=GREY)
        for i, (height, color) in enumerate(zip(shown.heights, COLOURS, strict=True)):
            at.text(0.36 * (i - 2.5), -0.3, f"× {height:.3g}" if height < 999.5 else f"× {height:.0f}", ha="center",
                    size=7.5, color=color)
    _legend(figure, [(color, f"light at {light:g}°") for light, color in zip(LIGHTS, COLOURS, strict=True)])
    return figure


def _draw_published():
    """A panel for each light, in it the lobes of the models that the paper compares, as in its figures 2 to 4."""
    shown = [lobes_of(brdf.MODELS[name]) for name in published.MODELS]
    caption = ("f over its peak, by the angle of the view from the normal (degrees). Dashed ray: light; dotted: its "
               "mirror direction. Ward's f grows without bound at the horizon; drawn to 89.5°.\n" + _matched_note())
    figure, axes = _panels(TITLES[PUBLISHED], caption, len(LIGHTS), 3, 0.12)
    for i, (at, light) in enumerate(zip(axes, LIGHTS, strict=True)):
        _protractor(at)
        _mark(at, light, INK)
        x, y = _point(light, 1.0)
        at.plot([0.0, x], [0.0, y], color=INK, linewidth=0.9, linestyle=(0, (1, 2)))
        for curves, color in zip(shown, MODEL_COLOURS, strict=True):
            _polar(at, curves.curves[i], color, filled=False)
        at.set_title(f"light at {light:g}°", pad=2.0)
    _legend(figure, [(color, curves.model.label) for curves, color in zip(shown, MODEL_COLOURS, strict=True)])
    return figure


def _matched_note():
    angle = lobes.half_angle(brdf.MODELS["he_torrance"], SURFACE)
    return (f"All as wide as He-Torrance with σ₀ = {SURFACE['sigma']:g} µm, τ = {SURFACE['tau']:g} µm: half of f at "
            f"{angle:.1f}° of the half vector, seen from above.")


def _shape_note(shown):
    """The parameter that was matched, and the width where it could not be."""
    name = shown.model.width_parameter
    if name in shown.given:
        return f"{shown.model.parameter(name).label} = {shown.given[name]:.3g}"
    return f"not matched: half at {shown.angle:.1f}°"


def _panels(title, caption, count, columns, foot):
    """A figure with `count` bare axes for half circles of radius 1, below each `foot` radii of room."""
    rows, width = -(-count // columns), max(13.2 / columns, 3.0)
    height = (1.2 + foot) / 2.44 * width + 0.3
    figure = captioned((columns * width, 0.9 + 0.17 * caption.count("\n") + rows * height), title, caption)
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for i, at in enumerate(axes):
        at.set(xlim=(-1.22, 1.22), ylim=(-foot, 1.2), aspect="equal")
        at.set_axis_off()
        at.set_visible(i < count)
    return figure, axes[:count]


def _protractor(at):
    """Half circles at one half and 1, a ray every 30 degrees with its angle."""
    turn = np.linspace(-90.0, 90.0, 181)
    for radius in (0.5, 1.0):
        at.plot(*_point(turn, radius), color=FAINT, linewidth=0.8, zorder=0.5)
    for angle in range(-90, 91, 30):
        x, y = _point(angle, 1.0)
        at.plot([0.0, x], [0.0, y], color=FAINT, linewidth=0.8, zorder=0.5)
        if angle:
            at.text(1.1 * x, 1.1 * y, f"{abs(angle)}°", ha="center", va="center", size=7.5, color=GREY)
    for radius in (0.5, 1.0):
        at.text(-radius, -0.04, f"{radius:g}", ha="center", va="top", size=7.0, color=GREY)


def _mark(at, light, color):
    """Draws the light's ray and a dot at its mirror direction."""
    x, y = _point(light, 1.0)
    at.plot([-x, 0.0], [y, 0.0], color=color, linewidth=0.9, linestyle=(0, (5, 3)))
    at.plot(x, y, marker="o", markersize=3.2, color=color, linestyle="none", zorder=3.0)


def _polar(at, radius, color, filled=True):
    """Draws a lobe with `radius` at each of VIEWS."""
    x, y = _point(VIEWS, radius)
    at.plot(x, y, color=color, linewidth=1.4)
    if filled:
        at.fill(x, y, color=color, alpha=0.1, linewidth=0.0)


def _point(angle, radius):
    """x and y of a point at `angle` degrees from the normal, which points up."""
    return radius * np.sin(np.radians(angle)), radius * np.cos(np.radians(angle))


def _legend(figure, entries):
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=color, label=label) for color, label in entries]
    figure.legend(handles=lines, loc="upper right", ncols=len(lines), bbox_to_anchor=(0.995, 1.0), handlelength=1.6,
                  columnspacing=1.2, fontsize=8.5)
