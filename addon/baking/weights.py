"""The weights that let any formula render: for rows of views, base closures, and cells of what they leave over.

A formula whose parameters are fixed is a function of view and light. For each of a set of views, a row, it is taken
apart over the half vectors H, where a lobe hardly moves as the view does:

- a base: Beckmann microfacets and a diffuse closure, which Cycles evaluates, fitted to the formula from below;
- what they leave over, cut into cells of equal energy. At a hit the shader draws some of the cells, in each a half
  vector, and puts a narrow facet about it (a splat).

Between two rows the shader takes either by chance, in proportion to how near it is: what is expected is then what
linear interpolation gives. osl/include/weights.h reads the rows. Where the base is above the formula nothing can take
light away; as much is taken from the whole base, so that no row makes light.
"""
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..brdf.microfacet import beckmann_lambda
from .closures import NARROWEST_FACET

STEEPEST = np.radians(89.5)  # view of the last row
CROWDED = 1.5  # how much denser rows are towards grazing
RINGS = 72  # of half vectors where the formula is looked at, over sin(theta_h)
SPIKES = 8  # mirror colours from one row to the next: they change faster than lobes
FACETS = 16  # base microfacets of a row; those off the plane of incidence come in pairs
FACET = 7  # numbers of each: its slopes along x and y, its widths along x and y, its colour
OVER = 9.0  # what more it counts to be above the formula than below it
STEPS, COARSE, SWEEPS = 14, 6, 40  # of reweighting, the same to choose by, and of coordinate descent in each
LEAST_HEIGHT = 0.05  # of the mirrored view over the horizon, in parts of the view's, for a facet to be of use
UNSEEN = 0.3  # share left of a direction's light above which more candidates are sought
DETAIL = 0.3  # slope: how finely at least bases are integrated
FINE = 0.35  # share of cells' edges that are spaced without regard to what is left over
EVEN = 0.35  # share of rings that are spaced without regard to energy

# Candidates for the base, in units of the spread of the formula's half vectors: width; and places of their middles.
WIDTHS = (0.35, 0.6, 0.85, 1.2, 1.7, 2.6)
PLACES = ((0.0, 0.0), (-1.0, 0.0), (1.0, 0.0), (-2.0, 0.0), (2.0, 0.0), (0.0, 1.2), (-1.0, 1.2), (1.0, 1.2))
WIDEST_PAIR = 1.3
STRETCHED_PLACES = tuple((x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)) + (
    (-2.0, 0.0), (2.0, 0.0), (0.0, -2.0), (0.0, 2.0))
BROAD = (((0.0, 0.0), (1.0, 1.0)), ((-0.5, 0.0), (1.0, 1.0)), ((0.5, 0.0), (1.0, 1.0)), ((0.0, 0.0), (0.5, 0.5)))


@dataclass(frozen=True)
class Layout:
    """Rows for `views` angles from the normal at each of `azimuths` from the tangent, 0 to 90 degrees or all around.

    With one azimuth the formula is round about the normal: half vectors on one side of the plane of incidence tell all.
    Azimuths of 0 to 90 degrees tell all of what is its own mirror image about both axes; of other formulas they are
    spread over the `whole` turn. It is looked at in `turns` directions around, and cut into `cell_rings` times
    `cell_turns` cells. Rings are ellipses of half vectors with the half axes s times `stretch`, s being their size.
    """

    views: int
    azimuths: int
    turns: int
    cell_rings: int
    cell_turns: int
    stretch: tuple = (1.0, 1.0)
    whole: bool = False

    @property
    def around(self) -> float:
        """Azimuths of half vectors that are looked at, in radians."""
        return np.pi if self.azimuths == 1 else 2.0 * np.pi

    def view_angles(self):
        """Angles of the rows of one azimuth in radians, (views,)."""
        return self.angle_at(np.arange(self.views))

    def angle_at(self, place):
        """Angle from the normal in radians at the `place` of a row, 0 .. views - 1, or between two."""
        return STEEPEST * (1.0 - (1.0 - place / (self.views - 1)) ** CROWDED)

    def seen_from(self):
        """The rows' views, (azimuths * views, 3)."""
        turn = 2.0 * np.pi if self.whole else 0.5 * np.pi
        theta, phi = self.view_angles(), np.linspace(0.0, turn, self.azimuths, endpoint=not self.whole)[:, None]
        x, y, z = np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))
        return np.stack([x, y, z], axis=-1).reshape(-1, 3)


ROUND = Layout(views=48, azimuths=1, turns=40, cell_rings=20, cell_turns=24)
STRETCHED = Layout(views=24, azimuths=5, turns=64, cell_rings=16, cell_turns=24)
# Lobes of any shape need small cells, and change little from view to view.
PAINTED = Layout(views=12, azimuths=4, turns=96, cell_rings=32, cell_turns=48)
PAINTED_WHOLE = Layout(views=10, azimuths=12, turns=96, cell_rings=22, cell_turns=30, whole=True)


@dataclass(frozen=True)
class Weights:
    """`rows` (views, numbers), laid out as osl/include/weights.h reads it, with `channels` (1 or 3) of energy per cell.

    `spikes` (angles, 3), empty without a spike, are the colours of the perfect mirror at the rows' angles and between
    them. `left` (views,) is the share of the light that is left over to splats.
    """

    layout: Layout
    rows: np.ndarray
    spikes: np.ndarray
    channels: int
    left: np.ndarray

    @property
    def energies(self):
        """Energies of the cells, (rows, cells, channels)."""
        return self.rows[:, sum(_sizes(self.layout)) :].reshape(len(self.rows), -1, self.channels)

    @property
    def brightness(self) -> float:
        """About how much light it reflects in all, over views: 0 where it is black."""
        facets = self.rows[:, 1 : 1 + FACETS * FACET].reshape(len(self.rows), FACETS, FACET)[..., 4:].sum(axis=1)
        flat = self.rows[:, 1 + FACETS * FACET : 4 + FACETS * FACET]
        spike = self.spikes.mean() if len(self.spikes) else 0.0
        return float((facets + flat).max(axis=1).mean() + self.rows[:, 0].mean() + spike)

    def with_channels(self, channels: int) -> "Weights":
        """The same with `channels` for each energy; 1 is for what is gray."""
        if channels == self.channels:
            return self
        energies = self.energies[..., :1].repeat(channels, axis=-1).reshape(len(self.rows), -1)
        rows = np.concatenate([self.rows[:, : sum(_sizes(self.layout))], energies], axis=1)
        return replace(self, rows=rows, channels=channels)


def weights(model, parameters: dict, layout: Layout | None = None) -> Weights:
    """Weights of a model for its parameters, in the precision of sockets; the last few are kept.

    Without a `layout` it is what the parameters ask for; one that is given has its stretch from them all the same.
    Raises ValueError where the formula gives what is no reflectance: numbers that are negative or not finite.
    """
    p = model.resolve(parameters)
    used = [q for q in model.parameters if q.evaluated]
    key = tuple(sorted((q.id, q.single(p[q.id])) for q in used))
    return _weights(model, key, tuple(q.stamp(p[q.id]) for q in used), layout and replace(layout, stretch=(1.0, 1.0)))


def layout_of(model, p, common: Layout | None = None) -> Layout:
    """The layout that resolved parameters ask for, or `common` with its stretch for them."""
    if model.mirrored:
        return common or (PAINTED if model.mirrored(p) else PAINTED_WHOLE)
    stretch = model.stretched(p) if model.stretched else (1.0, 1.0)
    return replace(common or (ROUND if stretch[0] == stretch[1] else STRETCHED), stretch=stretch)


def common_layout(model, several) -> Layout:
    """The layout that can hold weights for `several` resolved parameters: the one of most azimuths."""
    return max((layout_of(model, p) for p in several), key=lambda layout: layout.azimuths)


def numbers(layout: Layout, channels: int) -> int:
    """How many numbers the rows of a layout are."""
    return layout.azimuths * layout.views * (sum(_sizes(layout)) + layout.cell_rings * layout.cell_turns * channels)


def blank(model, parameters: dict) -> Weights:
    """Weights of the form that a model's have, all zero: for what only asks whether its shader compiles."""
    layout = layout_of(model, model.resolve(parameters))
    spikes = np.zeros((((layout.views - 1) * SPIKES + 1) if model.spike else 0, 3))
    rows = np.zeros((layout.azimuths * layout.views, numbers(layout, 1) // (layout.azimuths * layout.views)))
    return Weights(layout, rows, spikes, 1, rows[:, 0])


@lru_cache(maxsize=32)
def _weights(model, key, _, common):
    p = model.resolve(dict(key))
    layout = layout_of(model, p, common)
    looks = [Look.at(model, p, view, layout) for view in layout.seen_from()]
    share = _fitted(looks)
    rows = [_row(look, weight) for look, weight in zip(looks, share, strict=True)]
    spikes = np.zeros((0, 3))
    if model.spike:
        between = np.interp(np.arange((layout.views - 1) * SPIKES + 1) / SPIKES, np.arange(layout.views),
                            layout.view_angles())
        spikes = model.spike(np.cos(between), p)
    return Weights(layout, np.array([row for row, _ in rows]), spikes, looks[0].density.shape[-1],
                   np.array([left for _, left in rows]))


@dataclass(frozen=True)
class Look:
    """A formula seen from one view, on a polar grid of half vectors; of round ones on the side y >= 0.

    `s` (RINGS + 1,) are the rings' edges; `light`, `half` (RINGS, turns, 3), `area` (RINGS, turns) the
    solid angle of half vectors, of both sides together. `density` (.., channels) is f (N·L) dω_L / dω_H.
    `albedo` (channels,) is what its sum would be on a grid without end. `lights()` gives lights and weights, as
    `FormulaModel.lights`, that resolve bases.
    """

    layout: Layout
    view: np.ndarray
    s: np.ndarray
    light: np.ndarray
    half: np.ndarray
    lit: np.ndarray
    area: np.ndarray
    density: np.ndarray
    albedo: np.ndarray
    lights: object

    @classmethod
    def at(cls, model, p, view, layout):
        most = 1.0 / min(layout.stretch)
        coarse = np.unique(np.concatenate([[0.0], np.geomspace(0.01 * model.width(p), most, 160),
                                           np.linspace(0.0, most, 80)]))
        s = _quantiles(coarse, *cls._ring_energies(model, p, view, coarse, layout), model.width(p))
        light, half, lit, area = _grid(view, s, layout.turns, layout)
        density = _density(model, p, view, light, half, lit)
        return cls(layout, view, s, light, half, lit, area, density, np.atleast_1d(model.albedo_from(view, p)),
                   lambda: model.lights(view, p, DETAIL, polar=6, azimuthal=24))

    @staticmethod
    def _ring_energies(model, p, view, s, layout):
        light, half, lit, area = _grid(view, s, 24, layout)
        energy = (_density(model, p, view, light, half, lit).max(axis=-1) * area).sum(axis=1)
        return energy, s[1:][lit.any(axis=1)].max()


def _given(model, p):
    return {q.id: p[q.id] for q in model.parameters if q.evaluated}


def _quantiles(edges, energy, last, width):
    """RINGS + 1 edges, most of them at equal energies, the others evenly over the logarithm of their distance."""
    done = np.concatenate([[0.0], np.cumsum(energy)])
    if not done[-1] > 0.0:
        return np.linspace(0.0, last, RINGS + 1)
    apart = np.log1p(np.minimum(edges, last) / width) / np.log1p(last / width)
    mixed = (1.0 - EVEN) * done / done[-1] + EVEN * apart
    kept = edges <= last * (1.0 + 1e-12)
    return np.interp(np.linspace(0.0, 1.0, RINGS + 1), mixed[kept] / mixed[kept][-1], edges[kept])


def _grid(view, s, turns, layout):
    """Of the cells between the edges s: lights, half vectors (rings, turns, 3), whether lit, areas (rings, turns)."""
    middle2 = 0.5 * (s[1:] ** 2 + s[:-1] ** 2)
    ring, phi = np.meshgrid(np.sqrt(middle2), (np.arange(turns) + 0.5) / turns * layout.around,
                            indexing="ij")
    half = _half_vectors(layout, ring, phi)
    up = half[..., 2]
    view_half = half @ view
    light = 2.0 * view_half[..., None] * half - view
    lit = (view_half > 1e-6) & (light[..., 2] > 1e-9) & (up > 1e-3)
    area = np.pi / turns * (s[1:] ** 2 - s[:-1] ** 2)[:, None] * np.prod(layout.stretch) / np.maximum(up, 1e-3)
    return light, half, lit, area


def _half_vectors(layout, s, phi):
    """Half vectors (..., 3) at the size `s` of their ring and the azimuth `phi` on it, which broadcast."""
    x, y = s * np.cos(phi) * layout.stretch[0], s * np.sin(phi) * layout.stretch[1]
    return np.stack([x, y, np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))], axis=-1)


def _density(model, p, view, light, half, lit):
    value = model.evaluate(view, light[lit], **_given(model, p)) if lit.any() else np.zeros(0)
    value = value if value.ndim == 2 else value[:, None]
    if not np.isfinite(value).all() or value.min(initial=0.0) < 0.0:
        bad = value[~np.isfinite(value) | (value < 0.0)][0]
        raise ValueError(f"{model.id}: the formula gives {bad:g} at a view of {np.degrees(np.arccos(view[2])):.1f} "
                         "degrees; a reflectance is a finite number, 0 or more")
    density = np.zeros((*lit.shape, value.shape[1]))
    density[lit] = value * (4.0 * light[lit][:, 2] * (half[lit] @ view))[:, None]
    return density


# The base.


def facet_value(slopes, widths, view, light):
    """f (N·L) of Cycles' Beckmann closure whose normal leans by `slopes` (2,), of `widths` (2,) along x and y.

    `light` (..., 3). Source: Walter et al. 2007, eq. 20, 25; masking and shadowing apart, with their rational fit.
    """
    normal = np.array([*slopes, 1.0]) / np.sqrt(1.0 + slopes[0] ** 2 + slopes[1] ** 2)
    across = np.cross(normal, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    frame = np.stack([np.cross(across, normal), across, normal])
    v, lit, h = frame @ view, light @ frame.T, (light + view) @ frame.T
    seen = (lit[..., 2] > 0.0) & (h[..., 2] > 0.0)
    if v[2] <= 0.0:
        return np.zeros(light.shape[:-1])
    slope2 = sum((h[..., i] / (np.maximum(h[..., 2], 1e-9) * widths[i])) ** 2 for i in (0, 1))
    cos2 = np.maximum(h[..., 2], 0.0) ** 2 / np.maximum((h * h).sum(axis=-1), 1e-18)
    d = np.exp(-slope2) / (np.pi * widths[0] * widths[1] * np.maximum(cos2, 1e-9) ** 2)
    return np.where(seen, d / (4.0 * v[2] * (1.0 + _lambda(v, widths) + _lambda(lit, widths))), 0.0)


def sides_value(look, slopes, widths, light):
    """`facet_value`; of a round formula's facets off the plane of incidence, that of the pair on either side of it."""
    value = facet_value(slopes, widths, look.view, light)
    if slopes[1] and look.layout.azimuths == 1:
        value = value + facet_value((slopes[0], -slopes[1]), widths, look.view, light)
    return value


def _lambda(direction, widths):
    slope2 = sum((direction[..., i] * widths[i]) ** 2 for i in (0, 1)) / np.maximum(direction[..., 2] ** 2, 1e-12)
    return beckmann_lambda(slope2)


def _candidates(look, density):
    """[(slopes, widths)] of microfacets that may be of use for a `density` (RINGS, turns), by its spread."""
    energy = (density * look.area).ravel()
    if not energy.any():
        return []

    def quantiles(slope, shares):
        order = np.argsort(slope.ravel())
        done = np.cumsum(energy[order])
        return np.interp(np.array(shares) * done[-1], done, slope.ravel()[order])

    up = np.maximum(look.half[..., 2], 1e-3)
    low, middle, high = np.transpose([quantiles(look.half[..., i] / up, (0.16, 0.5, 0.84)) for i in (0, 1)])
    if look.layout.azimuths == 1:
        low[1], middle[1], high[1] = 0.0, 0.0, 2.0 * quantiles(look.half[..., 1] / up, (0.68,))[0]
    spread = np.maximum(0.5 * (high - low), 1e-4)
    found = []
    for width in WIDTHS:
        for x, y in PLACES if look.layout.azimuths == 1 else STRETCHED_PLACES:
            if not y or width < WIDEST_PAIR:
                slopes = (middle[0] + x * spread[0], middle[1] + y * spread[1])
                found.append((slopes, tuple(np.clip(np.sqrt(2.0) * width * spread, NARROWEST_FACET, 1.0))))
    return [facet for facet in found if _mirrors(look.view, facet[0])]


def _mirrors(view, slopes):
    """Whether a facet mirrors the view above the horizon: Cycles bends the normals of others until they do."""
    normal = np.array([*slopes, 1.0]) / np.sqrt(1.0 + slopes[0] ** 2 + slopes[1] ** 2)
    return 2.0 * (normal @ view) * normal[2] - view[2] > LEAST_HEIGHT * view[2]


def _shown(look, candidates):
    """Densities of the candidates, pairs together, and of a diffuse closure last: (candidates + 1, RINGS, turns)."""
    stretch = np.where(look.lit, 4.0 * np.maximum(look.half @ look.view, 0.0), 0.0)
    found = [sides_value(look, slopes, widths, look.light) * stretch for slopes, widths in candidates]
    found.append(np.where(look.lit, look.light[..., 2] / np.pi, 0.0) * stretch)
    return np.array(found)


def _bases(looks, candidates):
    """Densities of each look's candidates, and the same of all looks, (views, candidates + 1, nodes)."""
    most = max(len(c) for c in candidates)
    shown = [_shown(look, c) for look, c in zip(looks, candidates, strict=True)]
    shown = [np.concatenate([np.zeros((most + 1 - len(s), *s.shape[1:])), s]) for s in shown]
    return shown, np.array([s.reshape(len(s), -1) for s in shown], dtype=np.float32)


def _fitted(looks):
    """[(candidates, their densities, colours)] of each look's base: FACETS microfacets and a diffuse closure."""
    gray = [look.density.mean(axis=-1) for look in looks]
    channels = looks[0].density.shape[-1]
    target = np.array([g.ravel() for g in gray], dtype=np.float32)
    area = np.array([look.area.ravel() for look in looks], dtype=np.float32)
    candidates = [[*_candidates(look, g), *(b for b in BROAD if _mirrors(look.view, b[0]))]
                  for look, g in zip(looks, gray, strict=True)]
    shown, basis = _bases(looks, candidates)
    weight = _from_below(basis, target, area, COARSE)
    # A lobe that these do not see at all, such as one that reflects back, gets candidates of its own.
    left = target - np.einsum("vj,vjn->vn", weight, basis)
    unseen = np.where(left > UNSEEN * target, left, 0.0)
    if (unseen * area).sum() > 0.01 * (target * area).sum():
        more = [_candidates(look, u.reshape(g.shape)) for look, u, g in zip(looks, unseen, gray, strict=True)]
        candidates = [c + m for c, m in zip(candidates, more, strict=True)]
        shown, basis = _bases(looks, candidates)
        weight = _from_below(basis, target, area, COARSE)
    # The few that carry most, and once more for these alone, for each channel.
    colour = np.array([look.density.reshape(-1, channels) for look in looks], dtype=np.float32)
    carried = np.einsum("vjn,vn->vj", basis, area)
    energy = weight * carried
    if channels > 1:
        whole = np.maximum(np.einsum("vnc,vn->vc", colour, area), 1e-12)
        energy = sum(_from_below(basis, colour[..., c], area, COARSE) * carried / whole[:, c, None]
                     for c in range(channels))
    energy[:, -1] = np.inf
    kept = np.argsort(-energy, axis=1)[:, : FACETS + 1]
    few = np.take_along_axis(basis, kept[..., None], axis=1)
    fewer = np.stack([_from_below(few, colour[..., c], area) for c in range(channels)], axis=-1)
    most = basis.shape[1] - 1

    def named(i, j):
        # What was put before the candidates of a look that has few weighs nothing.
        return None if j == most else candidates[i][max(j - most, -len(candidates[i]))]

    return [([named(i, j) for j in kept[i]], shown[i][kept[i]], fewer[i]) for i in range(len(looks))]


def _from_below(basis, target, area, steps=STEPS):
    """Weights >= 0, (views, candidates), of the sum of `basis` (views, candidates, nodes) nearest below `target`.

    Least is the integral of |target - sum|, OVER times it where the sum is above: by reweighted least squares.
    """
    views, count, _ = basis.shape
    weight = np.zeros((views, count))
    small = 5e-4 * target.max(axis=1, keepdims=True) + 0.01 * target + 1e-12
    importance = area / np.maximum(target, np.maximum(1e-3 * target.max(axis=1, keepdims=True), 1e-12))
    for _ in range(steps):
        gram = ((basis * importance[:, None]) @ basis.transpose(0, 2, 1)).astype(np.float64)
        right = (basis @ (importance * target)[..., None])[..., 0].astype(np.float64)
        diagonal = np.einsum("vjj->vj", gram)
        diagonal = np.where(diagonal > 0.0, diagonal, 1.0)
        for _ in range(SWEEPS):
            for j in range(count):
                step = (right[:, j] - np.einsum("vk,vk->v", gram[:, j], weight)) / diagonal[:, j]
                weight[:, j] = np.maximum(weight[:, j] + step, 0.0)
        left = target - (weight.astype(np.float32)[:, None] @ basis)[:, 0]
        importance = area * np.where(left < 0.0, np.float32(OVER), np.float32(1.0)) / np.maximum(np.abs(left), small)
    return weight


def _sizes(layout):
    """Numbers of a row's parts, but for the energies, which end it."""
    return 1, FACETS * FACET, 3, layout.cell_rings + 1, layout.cell_rings * (layout.cell_turns + 1)


def parts(row, layout, channels):
    """The facets (FACETS, FACET), diffuse colour (3,), edges of rings, of cells around each, and energies of a row."""
    facets, diffuse, rings, turns, energies = np.split(row, np.cumsum(_sizes(layout)))[1:]
    return (facets.reshape(-1, FACET), diffuse, rings, turns.reshape(layout.cell_rings, -1),
            energies.reshape(layout.cell_rings, layout.cell_turns, channels))


# What is left over.


def _row(look, fitted):
    """Numbers of one row, and the share that is left over."""
    candidates, shown, colours = fitted
    base = np.einsum("jc,jrt->rtc", colours, shown)
    left, over = np.maximum(look.density - base, 0.0), np.maximum(base - look.density, 0.0)
    owed = np.einsum("rt,rtc->c", look.area, over) / np.maximum(np.einsum("rt,rtc->c", look.area, base), 1e-12)
    colours = colours * (1.0 - np.minimum(owed, 1.0))
    facets = np.zeros((FACETS, FACET))
    diffuse = np.zeros(3)
    at = 0
    for candidate, rgb in zip(candidates, colours, strict=True):
        if candidate is None:
            diffuse = np.broadcast_to(rgb, 3)
        else:
            facets[at] = [*candidate[0], *candidate[1], *np.broadcast_to(rgb, 3)]
            at += 1
    # The grid is coarse where the horizon cuts it: the row's energy is the albedo without what the base truly has.
    rest = look.albedo - _base_energy(look, facets, diffuse)[: len(look.albedo)]
    left = left * np.maximum(rest, 0.0) / np.maximum(np.einsum("rt,rtc->c", look.area, left), 1e-12)
    energy = max(rest.max(), 0.0)
    return np.concatenate([[energy], facets.ravel(), diffuse, _cells(look, left)]), energy / max(*look.albedo, 1e-12)


def _base_energy(look, facets, diffuse):
    """Albedo of a base (3,)."""
    light, weight = look.lights()
    total = np.zeros((len(light), 3))
    for facet in facets[facets[:, 4:].any(axis=1)]:
        total += sides_value(look, facet[:2], facet[2:4], light)[:, None] * facet[4:]
    return diffuse + (weight / light[:, 2]) @ total


def _cells(look, left):
    """Edges of rings (rings + 1), of cells around each (rings, turns + 1), energies (rings, turns, channels), flat.

    Rings, and the cells of a ring, are cut where the strongest channel has energy, but are nowhere wide: what a cell
    holds is spread evenly over it. The energies are those of both sides of the plane of incidence, times the number of
    cells.
    """
    layout = look.layout
    energy = look.area[..., None] * left
    before = np.concatenate([np.zeros((1, *energy.shape[1:])), np.cumsum(energy, axis=0)])  # (RINGS + 1, turns, c)
    strongest = before[-1].sum(axis=0).argmax()
    by_ring = before[..., strongest].sum(axis=1)
    if not by_ring[-1] > 0.0:
        by_ring = np.linspace(0.0, 1.0, RINGS + 1)
    share = (1.0 - FINE) * by_ring / by_ring[-1] + FINE * np.linspace(0.0, 1.0, RINGS + 1)
    edges2 = np.interp(np.linspace(0.0, 1.0, layout.cell_rings + 1), share, look.s**2)
    at = np.stack([[np.interp(edges2, look.s**2, before[:, t, c]) for t in range(energy.shape[1])]
                   for c in range(energy.shape[2])], axis=-1)  # (turns, edges, c)
    turns, energies = [], []
    phi = np.linspace(0.0, layout.around, energy.shape[1] + 1)
    for ring in np.diff(at, axis=1).transpose(1, 0, 2):
        around = np.concatenate([np.zeros((1, ring.shape[1])), np.cumsum(ring, axis=0)])
        total = around[-1, strongest]
        steps = around[:, strongest] / total if total > 0.0 else phi / phi[-1]
        steps = (1.0 - FINE) * steps + FINE * phi / phi[-1]
        edges = np.interp(np.linspace(0.0, steps[-1], layout.cell_turns + 1), steps, phi)
        turns.append(edges)
        energies.append(np.diff([np.interp(edges, phi, around[:, c]) for c in range(ring.shape[1])], axis=1).T)
    rings, turns = np.sqrt(edges2), np.array(turns)
    energies = np.array(energies) * layout.cell_rings * layout.cell_turns / _lit(look, rings, turns)[..., None]
    return np.concatenate([rings, turns.ravel(), energies.ravel()])


def _lit(look, rings, turns, parts=4):
    """Share of each cell (rings, turns) whose lights are above the horizon: only there splats can hold its energy."""
    at = (np.arange(parts) + 0.5) / parts
    s2 = rings[:-1, None] ** 2 + np.diff(rings**2)[:, None] * at
    phi = turns[:, :-1, None] + np.diff(turns, axis=1)[..., None] * at
    half = _half_vectors(look.layout, np.sqrt(s2)[:, None, :, None], phi[:, :, None, :])
    above = 2.0 * (half @ look.view) * half[..., 2] > look.view[2]
    return np.maximum(above.mean(axis=(2, 3)), 1.0 / parts**2)
