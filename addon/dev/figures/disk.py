"""Figures 7, 8 and 13 of the halfway vector disk's paper, computed by the reference models: lobes, lumps, half vectors.

Source: Edwards, Boulos, Johnson, Shirley, Ashikhmin, Stark, Wyman, "The halfway vector disk for BRDF modeling", 2006;
equations are numbered as there. Densities on the disk are per unit of its area, which is pi: its radius is 1.
"""
import numpy as np

from ... import brdf
from ...models import disk
from ...models.channels import mean
from ...models.geometry import dot, half, in_plane
from .style import INK, SHADES, STYLE, captioned

SET = ("lobes", "lumps", "half_vectors")

VIEWS = (0.0, 20.0, 40.0, 60.0)  # degrees
# One lump for all views: the largest that stays on the disk at the last view. With its exponent lobes are 0 at the
# horizon.
LOBE = {"radius": float(disk.room(0.5)), "exponent": 2.0}
PROJECTIONS = {"disk_scaling": "Scaling projection (eq. 20)", "disk_orthogonal": "Orthogonal projection (eq. 24)"}

RADII = (1.0, 0.5)
EXPONENTS = (1.0, 5.0, 10.0)

TURNS = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)  # of the view, degrees
# Exponents with which all three have nearly the same peak at normal incidence.
COMPARED = (  # (model, parameters, title)
    ("edwards_fit", {"renormalize": False}, "Edwards Data Fit, raw"),
    ("blinn", {"exponent": 250.0}, "Blinn, n = 250"),
    ("pumped_phong", {"exponent": 62.0}, "Pumped Phong, n = 62"),
)
WINDOW = (-1.1, 2.1, -1.1, 1.1)  # u and v: every disk, from normal incidence to grazing
STEP = 0.01


def lobe_curve(model: str, view_angle: float, count: int = 1801, **parameters):
    """Light angles (degrees, -90..90, the mirror direction positive) and f (1/sr) in the plane of incidence.

    Both (count,).
    """
    angles = np.linspace(-90.0, 90.0, count)
    light = np.stack([-np.sin(np.radians(angles)), np.zeros(count), np.cos(np.radians(angles))], axis=-1)
    return angles, brdf.MODELS[model].evaluate(in_plane(view_angle), light, **parameters)


def lump_curve(radius: float, exponent: float, count: int = 801):
    """u (-1..1) and the density p(u, 0) of a lump about the origin (eq. 26), both (count,)."""
    u = np.linspace(-1.0, 1.0, count)
    point = np.stack([u, np.zeros(count)], axis=-1)
    return u, disk.Lump(np.zeros(2), np.full(2, radius), exponent).density(point)


def half_vector_density(model: str, view_angle: float, point, projection=disk.ORTHOGONAL, **parameters):
    """Density p (N,) on the disk of a model's half vectors at `point` (N, 2), solved from eq. 11; NaN off the disk.

    p = 4 f (N·L)(L·H) / (dh/dH), its volume the albedo. f is the mean of its channels. The view lies in the x-z plane,
    at `view_angle` degrees. By the orthogonal projection p is f itself, as |V+L| = 2 (L·H).
    """
    point = np.atleast_2d(np.asarray(point, dtype=np.float64))
    view = np.tile(in_plane(view_angle), (len(point), 1))
    away = point - view[:, :2]
    light = projection.light(view, point)
    # On the rim itself N·L may be 0, and p is a limit.
    on_disk = (dot(away, away) < 1.0) & (light[:, 2] > 0.0)
    view, light = view[on_disk], light[on_disk]
    f = mean(brdf.MODELS[model].evaluate(view, light, **parameters))
    density = np.full(len(point), np.nan)
    density[on_disk] = 4.0 * f * light[:, 2] * dot(light, half(view, light)) / projection.measure(view, light)
    return density


def half_vector_image(model: str, view_angle: float, projection=disk.ORTHOGONAL, step: float = STEP, **parameters):
    """`half_vector_density` at the centers of square pixels of side `step` over WINDOW: (rows of v, columns of u)."""
    u, v = _pixels(step)
    point = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    return half_vector_density(model, view_angle, point, projection, **parameters).reshape(len(v), len(u))


def draw(name: str):
    """The figure `name` of SET as a matplotlib Figure. Raises ValueError for another name."""
    if name not in SET:
        raise ValueError(f"no figure {name!r}; there are {', '.join(SET)}")
    return {"lobes": _draw_lobes, "lumps": _draw_lumps, "half_vectors": draw_half_vectors}[name]()


def draw_half_vectors(compared=COMPARED, projection=disk.ORTHOGONAL):
    """The disk seen from above, as in figure 13: a row for each (model, parameters, title), a column for each of TURNS.

    For isotropic models: the view turns in the x-z plane only.
    """
    import matplotlib
    from matplotlib.colors import LogNorm

    with matplotlib.rc_context(STYLE):
        head = f"Half vectors on the disk, {projection.id} projection"
        figure = captioned((14.0, 1.75 + 1.5 * len(compared)), head, (
            "As figure 13: density of half vectors, p = 4 f (N·L)(L·H) / (dh/dH), from eq. 11. The disk is centered on "
            "the in-plane part of the view (dot); the cross is the normal, where light is mirrored. "
            "Thin lines: p = 0.1 and 1.\na: albedo, the volume on the disk."))
        axes = figure.subplots(len(compared), len(TURNS), sharex=True, sharey=True, squeeze=False)
        for row, (model, given, title) in zip(axes, compared, strict=True):
            for at, angle in zip(row, TURNS, strict=True):
                image = half_vector_image(model, angle, projection, **given)
                shown = _show_disk(at, angle, image, LogNorm(0.01, 10.0))
                albedo = np.mean(brdf.MODELS[model].albedo(np.cos(np.radians(angle)), **given))
                # In the corner outside the disk.
                at.text(*((-1.05, -1.05) if angle > 40.0 else (2.05, -1.05)), f"a = {albedo:.3f}",
                        ha="left" if angle > 40.0 else "right", va="bottom", size=8, color=INK)
            row[0].set_ylabel(f"{title}\nv (disk radii)")
        for at, angle in zip(axes[0], TURNS, strict=True):
            at.set_title(f"view at {angle:g}°")
        for at in axes[-1]:
            at.set_xlabel("u (disk radii)")
        figure.colorbar(shown, ax=axes, extend="both", aspect=35, pad=0.012,
                        label="density p (per unit area of the disk)")
    return figure


def _draw_lobes():
    import matplotlib

    given = {"radius_u": LOBE["radius"], "radius_v": LOBE["radius"], "exponent": LOBE["exponent"]}
    peak = (LOBE["exponent"] + 1.0) / (np.pi * LOBE["radius"] ** 2)
    with matplotlib.rc_context(STYLE):
        figure = captioned((11.0, 4.95), "BRDF lobes of one lump in the plane of incidence", (
            "As figure 7: f against the angle of the light, on a scale for each projection. The lump is the same "
            f"for all views: eq. 26 with c = 0, n = {LOBE['exponent']:g} and R = 1 - sin 60° = {LOBE['radius']:.3f},\n"
            f"the largest that stays on the disk at 60°; p(0) = (n+1)/(πR²) = {peak:.1f}. In the mirror direction f is "
            "p(0)/4 on the left, and higher beyond it; on the right p(0), the peak."))
        # The polar axes are a square whose middle half is the half plane; the square extends below the figure.
        figure.set_layout_engine("none")
        width, height = figure.get_size_inches()
        side = 4.5
        for i, (model, title) in enumerate(PROJECTIONS.items()):
            corner = (0.25 + 0.5 * i) * width - 0.5 * side, 2.3 - 0.5 * side
            at = figure.add_axes((corner[0] / width, corner[1] / height, side / width, side / height),
                                 projection="polar")
            for angle, shade in zip(VIEWS, SHADES[1:], strict=True):
                angles, f = lobe_curve(model, angle, **given)
                at.plot(np.radians(angles), f, color=shade, label=f"view at {angle:g}°")
                at.fill(np.radians(angles), f, color=shade, alpha=0.12, linewidth=0.0)
            _polar(at, title)
        lines, labels = at.get_legend_handles_labels()
        figure.legend(lines, labels, loc="upper right", ncols=3, bbox_to_anchor=(0.99, 1.0))
    return figure


def _polar(at, title):
    """The upper half plane, the normal up, with radii in 1/sr, and a ray for each view and mirror direction."""
    at.set_theta_zero_location("N")
    at.set_theta_direction(-1)
    at.set(thetamin=-90.0, thetamax=90.0)
    top = 1.05 * max(line.get_ydata().max() for line in at.lines)
    for angle, shade in zip(VIEWS, SHADES[1:], strict=True):
        for towards, dashes, label in ((-angle, (0, (5, 3)), "view"), (angle, (0, (1, 2)), "mirror direction")):
            at.plot(np.radians([towards, towards]), [0.0, top], color=shade, linewidth=1.1, linestyle=dashes,
                    label=label if angle == VIEWS[-1] else None, zorder=1.5)
    at.set_ylim(0.0, top)
    ticks = np.arange(0.0, top, 5.0 if top < 30.0 else 10.0)
    at.set_yticks(ticks, [f"{t:g}" for t in ticks])
    at.set_xticks(np.radians(range(-90, 91, 15)), [f"{abs(a)}°" for a in range(-90, 91, 15)])
    at.grid(color="#dcdce1")
    at.tick_params(colors="#55555c")
    at.text(0.5, 0.845, title, transform=at.transAxes, ha="center", size=10.5, color=INK)
    at.text(0.5, 0.15, "f (1/sr), by angle from the normal (degrees)", transform=at.transAxes, ha="center", color=INK)


def _draw_lumps():
    import matplotlib

    # Colors as the paper's.
    with matplotlib.rc_context(STYLE):
        figure = captioned((10.6, 4.9), "Cross sections of the lump on the disk", (
            "As figure 8, both on the same scale. Eq. 26 with c = 0: p(h) = (n+1)/(πR²) [1 - |h|²/R²]ⁿ, of volume 1 "
            "and peak (n+1)/(πR²)."))
        axes = figure.subplots(1, 2, sharey=True)
        for at, radius in zip(axes, RADII, strict=True):
            for n, shade in zip(EXPONENTS, (INK, SHADES[4], SHADES[1]), strict=True):
                at.plot(*lump_curve(radius, n), color=shade, label=f"n = {n:g}")
            at.set(title=f"R = {radius:g}", xlabel="u (disk radii)", xlim=(-1.0, 1.0))
            at.legend(loc="upper left")
        axes[0].set(ylabel="p(u, 0) (per unit area of the disk)", ylim=(0.0, 15.0))
    return figure


def _show_disk(at, angle, image, norm):
    """One disk of figure 13 with its rim, center and normal; returns the image as drawn."""
    from matplotlib.patches import Circle

    center = (np.sin(np.radians(angle)), 0.0)
    shown = at.imshow(image, extent=WINDOW, origin="lower", norm=norm, cmap="viridis", interpolation="nearest")
    # Pixels cut by the rim are empty: the disk's lowest color would fray without a ground of its own.
    ground = Circle(center, 1.0, facecolor=shown.cmap(0.0), edgecolor="none", zorder=shown.get_zorder() - 0.1)
    at.add_patch(ground)
    shown.set_clip_path(ground)
    u, v = _pixels(STEP)
    at.contour(u, v, image, levels=(0.1, 1.0), colors="white", linewidths=0.6, alpha=0.7)
    at.add_patch(Circle(center, 1.0, facecolor="none", edgecolor=INK, linewidth=1.0))
    at.plot(*center, marker="o", markersize=2.6, color="white", linestyle="none")
    at.plot(0.0, 0.0, marker="+", markersize=5.0, markeredgewidth=0.9, color=SHADES[4], linestyle="none")
    at.grid(False)
    at.set(xlim=WINDOW[:2], ylim=WINDOW[2:], xticks=(-1, 0, 1, 2), yticks=(-1, 0, 1), aspect="equal")
    return shown


def _pixels(step):
    """Centers of WINDOW's pixels along u and v."""
    return tuple(np.arange(low + 0.5 * step, high, step) for low, high in (WINDOW[:2], WINDOW[2:]))
