"""The directions that the shaders draw kernels at, as Cycles draws them, against the density that they divide by.

Shaders are changed by a hook: where they would put a kernel they emit its direction, or its density, and nothing
else. A million pixels are a million draws, of which chi-square tells whether they have the density; the densities are
NumPy's, and the shaders' own are held against these number by number.
"""
import json

import numpy as np
import pytest
from optics import emission
from optics.directions import toward
from optics.names import name_of

from addon import brdf, create_material
from addon.backends.osl import definitions, estimator
from addon.forms import bells
from addon.forms.albedo import tables
from addon.forms.rows import layout as row_layout
from addon.forms.rows import row_bake
from addon.models import disk
from addon.models.geometry import dot, half, mirror, normalize
from addon.models.lobes import BLINN, PHONG
from addon.statistics import chi_square

pytestmark = [pytest.mark.blender, pytest.mark.keeps_bakes]

WRONG = 1e-3  # chance that a sound sampler fails anywhere in this file
SIZE, FINE = 1000, (200, 100)  # a million draws in 20 000 cells
SMALL, COARSE = 300, (60, 30)
MANY = {"samples": 8}
EDGE = 1e-6  # single precision tells directions to a tenth of this

# What is put into a shader instead of a kernel. Which of the hit's draws is shown is chosen by a number of its own:
# together they have the density, each alone a part of it.
HOOK = "AT_KERNEL(light, beside, count)"
SHOWN = "if (k == min((int)((count) * hit_apart(P, 77.7, 0.5)), (count) - 1)) return color({what}) * emission();"


def shown(monkeypatch, model, given, view, size, planted=None):
    """(directions (N, 3), NaN where nothing was drawn; what goes with the first of them (M, 3)) of a model's shader.

    What goes with them is rendered of a tenth of the picture; of baked models it is the directions themselves. `view`
    (angle, azimuth) in degrees; `planted` a hook and what is in its place.
    """
    from addon.blender.host import row_cache

    pictures, baked = [], estimator.is_baked(brdf.MODELS[model])
    for what, rows in (("0.5 + 0.5 * (light)", None), ("beside", size // 10))[:1 if baked else 2]:
        with monkeypatch.context() as changed:
            changed.setitem(definitions.HOOKS, HOOK, SHOWN.format(what=what))
            if planted:
                changed.setitem(definitions.HOOKS, *planted)
            # What is compiled of a baked model is kept by its values: neither is it to be found here nor left behind.
            changed.setattr(row_cache, "_memory", {})
            material = create_material(model, **given)
            picture = emission.shown(material, size, rows=rows, side=40.0, view_deg=view[0], azimuth_deg=view[1])
            pictures.append(picture.reshape(-1, 3))
    lights, beside = pictures[0], pictures[-1]
    drawn = (lights > 0.0).any(axis=1)
    return np.where(drawn[:, None], normalize(2.0 * lights - 1.0), np.nan), beside


def sidak():
    return chi_square.significance(WRONG, len(LOBES) + len(LUMPS) + len(BAKED) + 3)


def held(lights, pdf, cells):
    """The p-value of draws against their density."""
    return chi_square.compare(lights, pdf, cells=cells).p_value


def close(found, expected, accuracy=2e-3):
    """Numbers of the shaders, of single precision, near the expected ones."""
    assert len(found) > 100
    np.testing.assert_allclose(found, expected, rtol=accuracy, atol=accuracy * np.max(expected) * 0.02)


def size_of(everyday):
    return (SMALL, COARSE) if everyday else (SIZE, FINE)


def marked(cases, everyday):
    """The cases, all but the first `everyday` ones marked as proofs; those are drawn in smaller number."""
    return [pytest.param(*case, i < everyday, marks=() if i < everyday else pytest.mark.proof)
            for i, case in enumerate([*cases[:everyday], *cases])]


# Phong and Blinn.

TINTED = {"fresnel_type": "schlick", "base_color": 0.04}
LOBES = [
    ("pumped_phong", {"exponent": 20.0, "pumps": 1.0}, 60.0), ("pumped_blinn", {"exponent": 20.0, "pumps": 2.0}, 40.0),
    ("phong", {"exponent": 20.0, **TINTED}, 40.0), ("phong", {"exponent": 1.0, **TINTED}, 80.0),
    ("pumped_phong", {"exponent": 1.5, "pumps": 2.0, "control": False}, 25.0),
    ("pumped_phong", {"exponent": 1.5, "pumps": 2.0, "control": False}, 85.0),
    ("pumped_phong", {"exponent": 150.0, "pumps": 3.0, "control": False}, 80.0),
    ("pumped_phong", {"exponent": 5000.0, "pumps": 1.0}, 45.0), ("phong_limit", {"exponent": 20.0}, 60.0),
    ("blinn", {"exponent": 2.0}, 5.0), ("blinn", {"exponent": 20.0}, 80.0),
    ("pumped_blinn", {"exponent": 1.5, "pumps": 1.0}, 65.0), ("pumped_blinn", {"exponent": 150.0, "pumps": 1.0}, 85.0),
    ("pumped_blinn", {"exponent": 5000.0, "pumps": 1.0}, 45.0),
]


def drawn_lobe(model, given, view_deg):
    """The density that estimator.h draws from: the lobe of 0.6 times the exponent, over the whole sphere."""
    lobe = PHONG if "phong" in model else BLINN

    def pdf(light):
        views = np.broadcast_to(toward(view_deg), light.shape)
        edge = EDGE * mirror(views) if lobe is PHONG else 0.0  # what is drawn at its very end is rounded over it
        return lobe.pdf(views, light + edge, 0.6 * given["exponent"])

    return pdf


@pytest.mark.parametrize("model, given, view_deg, everyday", marked(LOBES, 2), ids=name_of)
def test_lobes(monkeypatch, model, given, view_deg, everyday):
    size, cells = size_of(everyday)
    lights, beside = shown(monkeypatch, model, {**given, **MANY}, (view_deg, 0.0), size)
    known = lights[:len(beside)]
    drawn = np.isfinite(known[:, 0])
    density, chance, count = beside[drawn].T
    pdf = drawn_lobe(model, given, view_deg)
    assert np.ptp(chance) == 0.0 and 0.0 < chance[0] <= 1.0 and 1 <= count[0] <= 8
    # Below the horizon the shader uses neither. A direction is told to 1e-7: so much of an exponent's slope.
    used = known[drawn, 2] > 1e-6
    close(density[used], pdf(known[drawn][used]), 2e-3 + 4e-7 * given["exponent"])
    assert held(lights, lambda light: chance[0] * pdf(light), cells) > sidak()


# Lumps on the disk.

THIN = {"radius_u": 1.0, "radius_v": 0.1, "rotation": 0.1}
ONE = {"base_color": 1.0, "f90": 1.0}
LUMPS = [
    ("disk_scaling", {"exponent": 20.0}, (40.0, 0.0)), ("disk_orthogonal", {"exponent": 20.0, **THIN}, (70.0, 30.0)),
    ("disk_scaling", {"exponent": 0.0}, (5.0, 0.0)), ("disk_scaling", {"exponent": 0.0}, (70.0, 0.0)),
    ("disk_scaling", {"exponent": 2.0}, (40.0, 0.0)), ("disk_scaling", {"exponent": 10.0, **THIN}, (70.0, 50.0)),
    ("disk_scaling", {"exponent": 500.0, "radius_u": 0.3, "radius_v": 0.2}, (80.0, 0.0)),
    ("disk_orthogonal", {"exponent": 1.0}, (60.0, 0.0)), ("disk_orthogonal", {"exponent": 50.0}, (85.0, 0.0)),
    ("edwards_empirical", {"base_color": 1.0, "exponent": 5.0}, (40.0, 0.0)),
    ("edwards_empirical", {"base_color": 1.0, "retro": 1.0, "retro_exponent": 20.0}, (50.0, 0.0)),
    ("edwards_empirical", {"base_color": 1.0, "retro": 1.0, "retro_exponent": 3.0, "retro_radius_u": 0.5,
                           "rotation": 0.1}, (75.0, 20.0)),
    ("edwards_fit", {**ONE, "blend": 0.0, "exponent": 20.0, "radius": 0.5}, (40.0, 0.0)),
    ("edwards_fit", {**ONE, "blend": 1.0, "second_exponent": 8.0, "second_radius": 1.0}, (75.0, 0.0)),
    ("reciprocal_disk", {"exponent": 50.0}, (10.0, 0.0)), ("reciprocal_disk", {"exponent": 7.0}, (65.0, 0.0)),
]


def lump_of(model, given, view):
    """(projection, the lump that the shader draws about) for one view."""
    p = brdf.MODELS[model].resolve(given)
    if model == "reciprocal_disk":
        room = float(disk.room(view[2:])[0])
        return disk.SCALING, disk.Lump(np.zeros(2), np.array([room, room]), p["exponent"])
    second = p.get("retro") == 1.0 or p.get("blend") == 1.0
    lump = brdf.MODELS[model].lumps_of(view[None], p)[int(second)][1]
    return brdf.MODELS[model].projection, disk.Lump(np.reshape(lump.centre, (-1, 2))[0], lump.radii[0],
                                                    float(lump.exponent[0]), lump.turn)


def distances(exponent, steep):
    """The density over the unit disk's area at r² (N,) that disk_estimator.h draws by."""
    power = 1.23 * exponent + 1.28

    def density(r2):
        inside = np.maximum(1.0 - r2 / 1.45**2, 0.0)
        bell = (power + 1.0) / (np.pi * 1.45**2) * inside**power
        if not steep:
            return bell
        row = json.loads((tables.PACKAGED / bells.FILE).read_text())["steep"]
        at = bells.NODES / (exponent + 1.0) - bells.STEEP_FROM
        low = min(int(at), len(row) - 2)
        knots = np.array([a + (at - low) * (b - a) for a, b in zip(row[low], row[low + 1], strict=True)])
        knots = knots[-bells.KNOTS - 1:]
        ring = np.searchsorted(knots, r2, side="right") - 1
        within = (ring >= 0) & (ring < bells.KNOTS)
        share = 1.0 / (bells.KNOTS * np.pi * np.diff(knots))[np.clip(ring, 0, bells.KNOTS - 1)]
        return 0.2 * bell + 0.8 * np.where(within, share, 0.0)

    return density


def drawn_lump(projection, lump, view, steep):
    """The density of lights, in 1/sr, of points drawn about a lump; 0 below the horizon, where none is kept."""
    density = distances(lump.exponent, steep)
    unit = disk.Lump(lump.centre, lump.radii, 0.0, lump.turn)

    def pdf(light):
        views = np.broadcast_to(view, light.shape)
        point, stretch = projection.reached(views, light)
        at = (point - unit.centre) @ unit._axes().T / unit.radii
        value = density(dot(at, at)) / np.prod(unit.radii) * stretch
        lit = light[:, 2] > -EDGE
        if projection is disk.SCALING:  # a light is drawn by the half vector before it
            lit &= dot(views, half(views, light)) > 0.0
        return np.where(lit, value, 0.0)

    return pdf


@pytest.mark.parametrize("model, given, view, everyday", marked(LUMPS, 2), ids=name_of)
def test_lumps(monkeypatch, model, given, view, everyday):
    size, cells = size_of(everyday)
    lights, beside = shown(monkeypatch, model, {**given, **MANY}, view, size)
    known = lights[:len(beside)]
    drawn = np.isfinite(known[:, 0])
    density, chance, count = beside[drawn].T
    assert np.ptp(chance) == 0.0 and 0.05 - 1e-6 <= chance[0] <= 1.0
    steep = count[0] < 0.0
    seen = toward(*view) if brdf.MODELS[model].axes else toward(view[0])
    projection, lump = lump_of(model, given, seen)
    pdf = drawn_lump(projection, lump, seen, steep)
    # The shaders' density is one over the lump's own disk.
    known = known[drawn]
    stretch = projection.reached(np.broadcast_to(seen, known.shape), known)[1] / np.prod(lump.radii)
    near = np.median(np.abs(density * stretch / np.maximum(pdf(known), 1e-30) - 1.0))
    assert near < 1e-3
    assert held(lights, lambda light: chance[0] * pdf(light), cells) > sidak()


# Cells of baked weights.

BAKED = [
    ("ward", {}, (40.0, 0.0)), ("ward", {"roughness_u": 0.3, "roughness_v": 0.08}, (50.0, 35.0)),
    ("cook_torrance", {"roughness": 0.7}, (75.0, 0.0)), ("lafortune", {}, (60.0, 0.0)), ("ndf_map", {}, (30.0, 70.0)),
]


def drawn_cells(baked, view):
    """{row: (how often, pdf)}: density of lights of the rows of weights about a view, each cell alike."""
    layout = baked.layout
    angle = np.arccos(view[2])
    place = (layout.views - 1) * (1.0 - (1.0 - angle / row_layout.STEEPEST) ** (1.0 / row_layout.CROWDED))
    azimuth = np.arctan2(abs(view[1]), abs(view[0])) * 2.0 / np.pi * (layout.azimuths - 1)
    rows = []
    for i, how_often in _beside(place, layout.views - 1):
        for j, and_that in _beside(azimuth, layout.azimuths - 1) if layout.azimuths > 1 else [(0, 1.0)]:
            rows.append((how_often * and_that, layout.views * j + i))
    left = baked.residual.albedo
    parts = [(often * min(max(left[row] / 0.02, 0.05), 1.0), _cells_of(baked, row, view)) for often, row in rows
             if left[row] > 1e-5]
    return lambda light: sum(often * pdf(light) for often, pdf in parts)


def _beside(place, last):
    low = min(int(place), last - 1)
    return [(low, 1.0 - (place - low)), (low + 1, place - low)]


def _cells_of(baked, row, view):
    layout, residual = baked.layout, baked.residual
    rings, turns = layout.cell_rings, layout.cell_turns
    s, edges = residual.ring_edges[row], residual.cell_edges[row]
    sides = 2.0 if layout.azimuths == 1 else 1.0

    def pdf(light):
        views = np.broadcast_to(view, light.shape)
        h = half(views, light)
        h = h * np.where(h[:, 2:] < 0.0, -1.0, 1.0)
        x, y = h[:, 0] / layout.stretch[0], h[:, 1] / layout.stretch[1]
        size, phi = np.hypot(x, y), np.arctan2(y, x)
        phi = np.abs(phi) if sides == 2.0 else phi
        ring = np.searchsorted(s, size, side="right") - 1
        inside = (ring >= 0) & (ring < rings) & (light[:, 2] > -EDGE)  # of the others there are no kernels
        ring = np.clip(ring, 0, rings - 1)
        phi = edges[ring, 0] + (phi - edges[ring, 0]) % (2.0 * np.pi) if sides == 1.0 else phi
        turn = (phi[:, None] >= edges[ring]).sum(axis=1) - 1
        inside &= (turn >= 0) & (turn < turns)
        turn = np.clip(turn, 0, turns - 1)
        area = np.diff(s * s)[ring] * np.diff(edges, axis=1)[ring, turn]  # of s² and the azimuth
        flat = 2.0 / (rings * turns * sides * layout.stretch[0] * layout.stretch[1] * np.maximum(area, 1e-30))
        return np.where(inside, flat * h[:, 2] / (4.0 * np.maximum(np.abs(dot(views, h)), 1e-12)), 0.0)

    return pdf


@pytest.mark.parametrize("model, given, view, everyday", marked(BAKED, 1), ids=name_of)
def test_cells(monkeypatch, model, given, view, everyday):
    # A density that jumps from cell to cell takes long to integrate: chi-square's are larger.
    size, cells = (SMALL if everyday else SIZE), COARSE
    lights, _ = shown(monkeypatch, model, {**given, **MANY}, view, size)
    seen = toward(*view) if brdf.MODELS[model].stretched else toward(view[0])
    baked = row_bake.bake(brdf.MODELS[model], given)
    assert held(lights, drawn_cells(baked, seen), cells) > sidak()


# Planted errors.

PLANTED = {
    "a lobe of another width": (*LOBES[0], ("SPOILT_U(u)", "pow(u, 0.91)")),
    "a lobe turned": (*LOBES[1], ("SPOILT_V(v)", "(v) * (v)")),
    "a wider lump": (*LUMPS[0], ("SPOILT_U(u)", "pow(u, 1.06)")),
    "cells not even in area": (*BAKED[0], ("SPOILT_U(u)",
                                           "(floor(20.0 * (u)) + pow(mod(20.0 * (u), 1.0), 2.0)) / 20.0")),
}


@pytest.mark.proof
@pytest.mark.parametrize("error", PLANTED)
def test_a_planted_error_is_found(monkeypatch, error):
    model, given, view, planted = PLANTED[error]
    view = view if isinstance(view, tuple) else (view, 0.0)
    lights, beside = shown(monkeypatch, model, {**given, **MANY}, view, 500, planted)
    seen = toward(*view) if getattr(brdf.MODELS[model], "stretched", None) else toward(view[0])
    chance = beside[np.isfinite(lights[:len(beside), 0])][0, 1]
    if estimator.is_baked(brdf.MODELS[model]):
        pdf, chance = drawn_cells(row_bake.bake(brdf.MODELS[model], given), seen), 1.0
    elif estimator.base_family(brdf.MODELS[model]):
        pdf = drawn_lobe(model, given, view[0])
    else:
        pdf = drawn_lump(*lump_of(model, given, seen), seen, False)
    assert held(lights, lambda light: chance * pdf(light), (100, 50)) < 1e-6


def test_the_mirror_direction_is_the_middle_of_what_is_drawn():
    """The densities' own check: of a lump about the normal, and of both lobes, it is largest there."""
    view = toward(40.0)
    peak = mirror(view[None])
    for pdf in (drawn_lobe("phong", {"exponent": 20.0}, 40.0), drawn_lobe("blinn", {"exponent": 20.0}, 40.0)):
        assert pdf(peak)[0] > pdf(normalize(peak + [[0.0, 0.1, 0.0]]))[0] > 0.0
