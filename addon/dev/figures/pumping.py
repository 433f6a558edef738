"""The pumping paper's figures 1 and 3 to 7, computed by the reference models: albedo, and radiance under a point light.

The left plot of each shows the albedo against the angle of view (the paper's eq. 4: what a uniform sky of radiance 1
gives). The right one shows f(V, L) (N·L), the paper's eq. 3: radiance towards the viewer per unit irradiance on a
surface facing the light, in 1/sr, in the plane of incidence, for a light at 0, 40 and 80 degrees. Figure 1 compares
models by their albedo alone; its right plot is the left one towards grazing, both axes logarithmic.
"""
import numpy as np

from ... import brdf
from ...models import quadrature
from ...models.channels import mean
from ...models.geometry import half, in_plane, view_at
from ...models.microfacet import beckmann
from .style import SHADES, STYLE

ANGLES = (0.0, 40.0, 80.0)  # of the light, degrees
STAGES = (0, 1, 2, 3, 4)
LIMIT_EXPONENTS = (5.0, 20.0, 100.0, 1000.0)
CHAINS = {  # name: (model, control, title)
    "phong_plain": ("pumped_phong", False, "Reciprocal Phong and its pumped-up versions, n = 20"),
    "blinn_plain": ("pumped_blinn", False, "Reciprocal Blinn and its pumped-up versions, n = 20"),
    "phong_controlled": ("pumped_phong", True, "Controlled pumping-up of reciprocal Phong, n = 20"),
    "blinn_controlled": ("pumped_blinn", True, "Controlled pumping-up of reciprocal Blinn, n = 20"),
}
SLOPE = 0.1  # m of figure 1's Cook-Torrance and Ward
COMPARED = {  # label in figure 1: (model or None, parameters, shade, dashes); the last two are not in the paper
    "reciprocal Phong, n = 150": ("phong", {"exponent": 150.0}, "#3d5a80", "-"),
    "He-Torrance, σ₀ = 0.1, τ = 1.7": ("he_torrance", {"sigma": 0.1, "tau": 1.7}, "#1f8a70", "-"),
    "Cook-Torrance, m = 0.1": ("cook_torrance", {"roughness": SLOPE}, "#b5310f", "-"),
    "Ward, m = 0.1": ("ward", {"roughness_u": SLOPE, "roughness_v": SLOPE}, "#e09f1f", "-"),
    "Cook-Torrance, m = 0.1, with G = 1": (None, {}, "#b5310f", (0, (5, 3))),
    "Ward-Dür, m = 0.1": ("ward_duer", {"roughness_u": SLOPE, "roughness_v": SLOPE}, "#8d6a1a", (0, (1, 1.5))),
}
NOTE = ("Fresnel factor 1; He-Torrance with its mirror spike. Slopes are measured from N·V = 0.001 to 0.0001. Ward's "
        "albedo is unbounded, and so is Cook-Torrance's\nwith G = 1, as the paper's proof takes it in eq. 12 (dashed). "
        "With the geometry term of eq. 10 (solid) it does not diverge: it never passes 1, its limit.")
LAST = 1e-4  # cosine at the end of the plot towards grazing; growth is measured over the decade before it
SET = ("models", *CHAINS, "phong_limit")


def albedo_curve(model: str, count: int = 181, **parameters):
    """View angles (degrees, up to 89.5) and the albedo at each, both (count,)."""
    angles = np.linspace(0.0, 89.5, count)
    return angles, brdf.MODELS[model].albedo(np.cos(np.radians(angles)), **parameters)


def radiance_curve(model: str, light_angle: float, count: int = 721, **parameters):
    """View angles (degrees, -90..90, the mirror direction positive) and f(V, L) (N·L) in 1/sr, both (count,)."""
    angles = np.linspace(-90.0, 90.0, count)
    light = in_plane(-light_angle)
    return angles, brdf.MODELS[model].evaluate(in_plane(angles), light, **parameters) * light[:, 2]


def without_geometry(view, light, slope: float = SLOPE):
    """Cook and Torrance's f in 1/sr with G = 1, (N,): eq. 9 as eq. 12 takes it in the paper's proof of divergence.

    No model of the registry: the geometry term of eq. 10 keeps theirs from diverging.
    """
    return beckmann(half(view, light), slope) / (4.0 * view[:, 2] * light[:, 2])


def compared_albedo(label: str, cos_theta):
    """Albedo (N,) of one of COMPARED at N·V = `cos_theta` (N,), with a Fresnel factor of 1."""
    model, parameters, *_ = COMPARED[label]
    if model is None:
        return np.array([quadrature.hemisphere(without_geometry, view, SLOPE) for view in view_at(cos_theta)])
    return mean(brdf.MODELS[model].albedo(cos_theta, **parameters))


def growth(label: str, last: float = LAST) -> float:
    """Exponent g of the albedo ~ (N·V)^g of one of COMPARED: its slope, both axes logarithmic, from 10 `last` on."""
    mu = last * np.array([10.0, 1.0])
    steep = np.diff(np.log(compared_albedo(label, mu))) / np.diff(np.log(mu))
    return float(steep[0])


def draw(name: str):
    """The figure `name` of SET as a matplotlib Figure. Raises ValueError for another name."""
    import matplotlib

    if name not in SET:
        raise ValueError(f"no figure {name!r}; there are {', '.join(SET)}")
    with matplotlib.rc_context(STYLE):
        figure, albedo, radiance = _axes()
        if name == "models":
            _draw_models(figure, albedo, radiance)
            title = "Albedo of widely used models (figure 1), and how it ends at grazing"
        elif name == "phong_limit":
            _draw_limit(albedo, radiance)
            title = "Where controlled pumping-up of Phong ends (eq. 22)"
        else:
            model, control, title = CHAINS[name]
            _draw_chain(albedo, radiance, model, control)
        figure.suptitle(title, x=0.012, y=0.975, ha="left", va="top", size=13, weight="bold", color="#1b1b1d")
    return figure


def _axes():
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.6, 4.5), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, 0.92), wspace=0.05)
    albedo, radiance = figure.subplots(1, 2)
    albedo.set(title="Albedo", xlabel="angle of view θ (degrees)", ylabel="albedo a (dimensionless)",
               xlim=(0.0, 90.0), ylim=(0.0, 1.12), xticks=range(0, 91, 15))
    radiance.set(title="Output radiance, light at 0°, 40° and 80°", xlabel="angle of view θ in the plane of incidence "
                 "(degrees)", ylabel="f (N·L) (1/sr)", xlim=(-90.0, 90.0), xticks=range(-90, 91, 30))
    albedo.axhline(1.0, color="#1b1b1d", linewidth=0.8, linestyle=(0, (4, 3)))
    return figure, albedo, radiance


def _draw_chain(albedo, radiance, model, control):
    for stage, shade in zip(STAGES, SHADES, strict=True):
        given = {"exponent": 20.0, "pumps": float(stage), "control": control}
        label = "not pumped" if stage == 0 else f"pumped {stage} ×"
        # Later stages of a controlled chain lie on one another: dashes let all be seen.
        dashes = {3: (0, (5, 5)), 4: (0, (2, 8))}.get(stage, "-") if control else "-"
        albedo.plot(*albedo_curve(model, **given), color=shade, label=label, linestyle=dashes)
        for angle in ANGLES:
            radiance.plot(*radiance_curve(model, angle, **given), color=shade, linestyle=dashes)
    _finish(albedo, radiance)


def _draw_limit(albedo, radiance):
    for n, shade in zip(LIMIT_EXPONENTS, SHADES[1:], strict=True):
        albedo.plot(*albedo_curve("phong_limit", exponent=n), color=shade, label=f"n = {n:g}")
    for angle in ANGLES:
        radiance.plot(*radiance_curve("phong_limit", angle, exponent=100.0), color=SHADES[3])
    radiance.set_title("Output radiance, n = 100, light at 0°, 40° and 80°")
    _finish(albedo, radiance)


def _draw_models(figure, albedo, grazing):
    angles = np.linspace(0.0, 89.75, 180)
    mu = np.geomspace(1.0, LAST, 81)
    for label, (_, _, shade, dashes) in COMPARED.items():
        albedo.plot(angles, compared_albedo(label, np.cos(np.radians(angles))), color=shade, linestyle=dashes,
                    label=label)
        slope = growth(label)
        grazing.plot(mu, compared_albedo(label, mu), color=shade, linestyle=dashes,
                     label=f"{label}: slope {slope:.2f}".replace("-0.", "−0.") if slope < -0.1 else None)
    albedo.set(ylim=(0.0, 1.6))
    albedo.legend(loc="lower left", fontsize=8.5)
    grazing.axhline(1.0, color="#1b1b1d", linewidth=0.8, linestyle=(0, (4, 3)))
    grazing.set(title="Towards grazing: the right end is 89.994°", xlabel="N·V = cos θ (dimensionless)",
                ylabel="albedo a (dimensionless)", xscale="log", yscale="log", xlim=(1.0, LAST), ylim=(5e-3, 4e2))
    grazing.legend(loc="upper left", fontsize=8.5)
    figure.get_layout_engine().set(rect=(0.0, 0.1, 1.0, 0.82))
    figure.text(0.012, 0.025, NOTE, ha="left", va="bottom", size=8.5, color="#55555c")


def _finish(albedo, radiance):
    """Legend, and a mark for each mirror direction."""
    albedo.legend(loc="lower left")
    radiance.set_ylim(0.0, 1.12 * max(line.get_ydata().max() for line in radiance.lines))
    for angle in ANGLES:
        radiance.axvline(angle, color="#9a9aa2", linewidth=0.9, linestyle=(0, (1, 2)), zorder=0.5,
                         label="mirror direction of the light" if angle == ANGLES[0] else None)
    radiance.legend(loc="upper left")
