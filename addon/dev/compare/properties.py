"""Properties of a reflectance model, computed from its formula: one function for each, and all together a `Row`.

`given` are a model's parameters {id: value}; others have their defaults. f is the mean of its channels.
"""
import time
from dataclasses import dataclass
from statistics import median

import numpy as np

from ... import brdf
from ...models.channels import mean
from ...models.geometry import in_plane, view_at
from . import lobes

ALBEDO_ANGLES = (*range(0, 80, 5), 80.0, 82.0, 84.0, 86.0, 87.0, 88.0, 89.0, 89.5)  # degrees
QUADRATURE_ERROR = 1e-3  # of an albedo, including the interpolation of the albedos that pumping divides by
OFF_SPECULAR_ANGLES = (60.0, 70.0, 80.0)  # of the light, degrees
CONFORMITY_ANGLES = (15.0, 30.0, 45.0, 60.0, 70.0)  # of Sawicki's figures 2 and 3
REFERENCE = "he_torrance"
BECKMANN, POWER, NEITHER = "Beckmann", "power", "neither"
NO_DIFFUSE, LAMBERT, NOT_LAMBERT = "none", "Lambert", "not Lambert"


@dataclass(frozen=True)
class Row:
    """The properties of one model; the functions of the same names define them."""

    model: str
    half_angle: float
    reciprocity_error: float
    largest_albedo: float
    largest_albedo_angle: float
    off_specular: tuple
    fresnel: float
    anisotropy: float
    diffuse: str
    spike: float
    dispersion: float
    distribution: str
    distribution_errors: dict
    conformity: float | None
    cost: float

    @property
    def conserves(self) -> bool:
        """Whether no albedo exceeds 1 by more than the quadrature's error."""
        return self.largest_albedo <= 1.0 + QUADRATURE_ERROR


def measure(model, given=None, reference=None) -> Row:
    """All properties of `model`. `reference` are He-Torrance's parameters that conformity is measured against."""
    given = dict(given or {})
    model.resolve(given)
    largest, angle = largest_albedo(model, given)
    distribution, errors = half_vector_distribution(model, given)
    return Row(
        model=model.id, half_angle=lobes.half_angle(model, given), reciprocity_error=reciprocity_error(model, given),
        largest_albedo=largest, largest_albedo_angle=angle,
        off_specular=tuple(off_specular(model, given, light) for light in OFF_SPECULAR_ANGLES),
        fresnel=fresnel(model, given), anisotropy=anisotropy(model, given), diffuse=diffuse(model, given),
        spike=spike(model, given), dispersion=dispersion(model, given), distribution=distribution,
        distribution_errors=errors, conformity=conformity(model, given, reference), cost=cost(model, given))


def reciprocity_error(model, given) -> float:
    """Largest |f(V, L) - f(L, V)| over the larger of both, 0..1; negligible pairs do not count."""
    view, light = _pairs()
    there, back = lobes.value(model, view, light, given), lobes.value(model, light, view, given)
    return _largest_difference(there, back, view[:, 2] * light[:, 2])


def largest_albedo(model, given) -> tuple:
    """(largest albedo, its angle in degrees) among ALBEDO_ANGLES.

    The view lies in the plane of the tangent; for stretched models also across it.
    """
    mu = np.cos(np.radians(ALBEDO_ANGLES))
    albedo = mean(model.albedo(mu, **given))
    if getattr(model, "stretched", None):
        p, views = model.resolve(given), in_plane(ALBEDO_ANGLES)[:, [1, 0, 2]]
        albedo = np.maximum(albedo, [np.mean(model.albedo_from(view, p)) for view in views])
    i = int(albedo.argmax())
    return float(albedo[i]), float(ALBEDO_ANGLES[i])


def off_specular(model, given, light_angle: float):
    """Angle (degrees) of the lobe's peak beyond the mirror direction; None where f is unbounded at the horizon.

    The peak is that of f itself in the plane of incidence, the light fixed, as in Sawicki's figures 3 and 4: what a
    goniometer's radiance shows. A peak at the horizon is 90 degrees minus the light's angle.
    """
    flattest = 1e-4  # cosine: below, the albedos that pumping divides by are extrapolated
    angles = np.append(np.arange(0.0, 89.96, 0.05), np.degrees(np.arccos(flattest)))
    f = lobes.lobe(model, light_angle, angles, given)
    before, last = lobes.lobe(model, light_angle, np.degrees(np.arccos([10.0 * flattest, flattest])), given)
    if last > 10.0**0.25 * before:  # growing faster than cos^-1/4; Ward's grows as cos^-1/2
        return None
    angles[-1] = 90.0
    return float(round(angles[f.argmax()] - light_angle, 2))


def fresnel(model, given) -> float:
    """Factor by which a color of 4 % grows in the mirror direction from 0 to 85 degrees; 1 without Fresnel's effect.

    A model with a choice takes Schlick's approximation.
    """
    dark = {**lobes.glossy(model, given), **lobes.those(model, base_color=(0.04,) * 3, fresnel_type="schlick")}
    angles = np.array([0.0, 85.0])
    view, light = in_plane(angles), in_plane(-angles)
    share = lobes.value(model, view, light, dark) / lobes.value(model, view, light, lobes.glossy(model, given))
    return float(share[1] / share[0])


def anisotropy(model, given) -> float:
    """Largest change of f, in parts of the larger value, 0..1, as view and light turn about the normal by 90 degrees.

    Parameters that come in pairs, along and across the tangent, are set to unequal values.
    """
    p = model.resolve(given)
    unequal = {q.id: q.clamp(0.5 * p[q.id.removesuffix("_v") + "_u"]) for q in model.parameters if q.id.endswith("_v")}
    view, light = _pairs()
    before = lobes.value(model, view, light, {**given, **unequal})
    after = lobes.value(model, _turned(view), _turned(light), {**given, **unequal})
    return _largest_difference(before, after, view[:, 2] * light[:, 2])


def diffuse(model, given) -> str:
    """The kind of diffuse part: none, a constant f (Lambert), or one that depends on the directions.

    The specular color is one half, since some diffuse parts scale with the light that it lets in.
    """
    added = lobes.those(model, diffuse_color=(0.5,) * 3)
    if not added:
        return NO_DIFFUSE
    view, light = _pairs()
    over = {**given, **lobes.those(model, base_color=(0.5,) * 3)}
    with_it = lobes.value(model, view, light, {**over, **added})
    amount = with_it - lobes.value(model, view, light, {**over, "diffuse_color": (0.0,) * 3})
    # Only far out on the lobe: near its peak the difference of large numbers is imprecise.
    amount = amount[with_it < 10.0 * np.median(with_it)]
    return LAMBERT if np.ptp(amount) < 1e-6 * amount.max() else NOT_LAMBERT


def spike(model, given) -> float:
    """Largest reflectance of the perfect mirror besides f, 0..1."""
    if not getattr(model, "spike", None):
        return 0.0
    return float(mean(model.spike(np.cos(np.radians(ALBEDO_ANGLES)), model.resolve(given))).max())


def dispersion(model, given) -> float:
    """Largest change of f, in parts of its peak, when the wavelength grows by a fifth; 0 where there is none."""
    p = model.resolve(given)
    if "wavelength" not in p:
        return 0.0
    view, light = _pairs()
    longer = {**given, "wavelength": model.parameter("wavelength").clamp(1.2 * p["wavelength"])}
    f = lobes.value(model, view, light, given)
    return float(np.abs(lobes.value(model, view, light, longer) - f).max() / f.max())


def half_vector_distribution(model, given) -> tuple:
    """(BECKMANN, POWER or NEITHER, {each: root mean square error}): what half vectors follow at normal incidence.

    The distribution is D = 4 f (N·L)(N·V) of microfacets without masking (Cook and Torrance 1982, as normalized by
    Neumann et al. eq. 9). Candidates fall to one half where D does. Errors are in parts of the peak, out to where D is
    one hundredth. NEITHER where the smaller error is more than half of the other.
    """
    beta = np.linspace(0.0, lobes.WIDEST - 0.1, 9000)
    d = lobes.seen_from_above(model, beta, given) * np.cos(np.radians(2.0 * beta))
    half, seen = np.radians(lobes.crossing(beta, d, 0.5)), beta <= lobes.crossing(beta, d, 0.01)
    # exp(-tan²β/m²) / cos⁴β and cos^n β, solved for 1/m² and n at one half.
    steepness = (np.log(2.0) - 4.0 * np.log(np.cos(half))) / np.tan(half) ** 2
    exponent = -np.log(2.0) / np.log(np.cos(half))
    t = np.radians(beta)
    fits = {BECKMANN: np.exp(-steepness * np.tan(t) ** 2) / np.cos(t) ** 4, POWER: np.cos(t) ** exponent}
    errors = {name: float(np.sqrt(np.mean((fit - d / d[0])[seen] ** 2))) for name, fit in fits.items()}
    best, other = sorted(errors, key=errors.get)
    return best if errors[best] <= 0.5 * errors[other] else NEITHER, errors


def conformity(model, given, reference=None):
    """Difference of the lobes from He-Torrance's with the parameters `reference`, in parts of these: 0 where equal.

    The model's shape is matched in width, each lobe divided by its peak, and the difference taken over all views in the
    plane of incidence: root mean square over that of He-Torrance's lobe, and the mean of CONFORMITY_ANGLES. None where
    the width cannot be matched.
    """
    theirs, reference = brdf.MODELS[REFERENCE], dict(reference or {})
    try:
        given = lobes.matched(model, lobes.half_angle(theirs, reference), given)
    except ValueError:
        return None
    views = np.linspace(-89.5, 89.5, 717)
    errors = []
    for angle in CONFORMITY_ANGLES:
        ours, other = (lobes.lobe(m, angle, views, p) for m, p in ((model, given), (theirs, reference)))
        ours, other = ours / ours.max(), other / other.max()
        errors.append(np.sqrt(((ours - other) ** 2).sum() / (other**2).sum()))
    return float(np.mean(errors))


def cost(model, given, repeats: int = 15, count: int = 5000) -> float:
    """Processor time of `evaluate` for `count` pairs over Phong's: the median of interleaved `repeats`.

    It is the time of this NumPy reference, with the albedos of pumped models already computed; a renderer's time
    differs.
    """
    mu = np.random.default_rng(1).uniform(0.1, 1.0, (2, count))
    view, light = (view_at(m) for m in mu)
    phong = brdf.MODELS["phong"]
    model.evaluate(view[:1], light[:1], **given)  # fills the model's caches

    def seconds(m, p):
        start = time.thread_time()
        m.evaluate(view, light, **p)
        return time.thread_time() - start

    return median(seconds(model, given) / seconds(phong, {}) for _ in range(repeats))


def _largest_difference(a, b, weight):
    """Largest |a - b| over the larger of both, where that times `weight` reaches 1e-3 of its own largest; all (N,)."""
    larger = np.maximum(a, b)
    counts = larger * weight >= 1e-3 * (larger * weight).max()
    return float((np.abs(a - b)[counts] / larger[counts]).max())


def _turned(direction):
    """Directions (N, 3) turned about the normal by a right angle."""
    return direction[:, [1, 0, 2]] * [-1.0, 1.0, 1.0]


def _pairs():
    """Views and lights (N, 3) each: all angles from 2.5 to 87.5 degrees, azimuths dense about the mirror direction."""
    angles = np.radians(np.arange(2.5, 90.0, 5.0))
    turns = np.radians([0.0, 35.0])  # of the view
    apart = np.radians([0.0, 2.0, 5.0, 12.0, 30.0, 60.0, 100.0, 180.0])  # of the light from the mirror's azimuth
    grid = np.meshgrid(angles, angles, turns, apart, indexing="ij")
    theta_view, theta_light, turn, away = (x.ravel() for x in grid)

    def spherical(theta, phi):
        return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)

    return spherical(theta_view, turn), spherical(theta_light, turn + np.pi + away)
