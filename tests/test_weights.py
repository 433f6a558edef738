"""Lobe rows: what a row of them draws is the formula, by integrals that share nothing with the bake."""
from dataclasses import replace

import kept_bakes
import numpy as np
import pytest
from optics.names import name_of
from optics.shapes import COPPER, STRETCHED
from truth.hemisphere import even_lights, half_vector_lights
from truth.rows import Row

from addon.backends.osl import assembler
from addon.brdf import MODELS
from addon.forms.rows import layout, lobe_rows, row_bake

CASES = [
    ("ward", {}), ("ward", {"roughness_u": 1.0, "roughness_v": 1.0}), ("ward_duer", {"diffuse_color": (0.1, 0.2, 0.3)}),
    ("cook_torrance", {"roughness": 0.05}), ("cook_torrance", {"roughness": 0.7, **COPPER}), ("he_torrance", {}),
    ("embrechts", {"smoothness": 2.0}), ("lafortune", {}), ("weighted_lobes", COPPER),
    ("ashikhmin_shirley", {"base_color": (0.9, 0.5, 0.2), "diffuse_color": (0.1, 0.1, 0.5), "exponent_u": 5.0,
                           "exponent_v": 5.0}),
    ("phong_original", {"exponent": 1.0}), ("pumped_cook_torrance", {"roughness": 0.4}),
    ("pumped_lafortune", {"pumps": 2.0}),
]
ROWS = (0, 15, 30, 40)  # up to 77 degrees


def arrays(baked):
    """All arrays of lobe rows."""
    return [*vars(baked.facets).values(), baked.diffuse, *vars(baked.residual).values(), baked.spike]


def lights_felt(view):
    """Smooth functions of a light: everywhere 1; wide, and narrower, about the mirror direction, the view, the side."""
    mirrored = view * [-1.0, -1.0, 1.0]
    side = np.array([-0.3, 0.8, 0.5]) / np.linalg.norm([-0.3, 0.8, 0.5])
    return [lambda light: np.ones(len(light)), *[
        lambda light, c=c, k=k: np.maximum(light @ c, 0.0) ** k for c, k in ((mirrored, 4), (mirrored, 40), (side, 10),
                                                                            (view, 10))]]


def errors(model, given, baked, index, scale=1.0):
    """Largest error of the integrals of a row times smooth functions of the light, in parts of the albedo."""
    row = Row(baked, index)
    light, energy = row.kernels()
    x, area = (even_lights if model.id == "kajiya_kay" else half_vector_lights)(row.view, model, given)
    value = model.evaluate(row.view[None], x, **given)
    exact = (value if value.ndim == 2 else value[:, None]) * (x[:, 2] * area)[:, None]
    base = scale * row.base(x) * area[:, None]
    found = [(felt(x) @ base + felt(light) @ energy, felt(x) @ exact) for felt in lights_felt(row.view)]
    return max(np.abs(one - other).max() for one, other in found) / found[0][1].max()


@pytest.mark.parametrize("name, given", CASES, ids=name_of)
def test_rows_are_the_formula(name, given):
    """Sums of base and cells feel any wide light as the formula does, within 0.3 % of all light.

    Lobes that the horizon cuts, and what reflects back, leave more to cells that are not small: 1.5 %. A few hundredths
    off in the base are seen: the bound is no looser than what it is for.
    """
    model = MODELS[name]
    bound = 0.015 if name in ("phong_original", "lafortune", "pumped_lafortune") else 0.003
    baked = row_bake.bake(model, given)
    assert baked.layout == layout.ROUND
    assert all(np.isfinite(array).all() for array in arrays(baked)) and baked.residual.albedo.min() >= 0.0
    # Cycles has 64 places for a hit's closures, and a material may hold other shaders too.
    closures = 1 + (baked.facets.used * np.where(baked.facets.slopes[..., 1] != 0.0, 2, 1)).sum(axis=1)
    assert closures.max() + 8 <= 48
    for index in ROWS:
        assert errors(model, given, baked, index) < bound, index
    assert errors(model, given, baked, 15, scale=0.97) > bound


@pytest.mark.parametrize("name, given", STRETCHED, ids=name_of)
def test_stretched_rows_are_the_formula(name, given):
    model = MODELS[name]
    baked = row_bake.bake(model, given)
    azimuths, views = baked.layout.azimuths, baked.layout.views
    assert azimuths == layout.STRETCHED.azimuths and len(baked) == azimuths * views
    for azimuth, row in ((0, 0), (1, 8), (2, 15), (4, 15)):
        assert errors(model, given, baked, azimuth * views + row) < (0.03 if name == "kajiya_kay" else 0.015)


def test_the_residual_of_kernels():
    """Little: it is what makes noise. Of what no base closure is like, such as strands, more."""
    shares = {name: row_bake.bake(MODELS[name], {}).residual.share
              for name in ("ward", "cook_torrance", "blinn_fresnel", "he_torrance", "lafortune")}
    for name in ("ward", "cook_torrance", "blinn_fresnel", "he_torrance"):
        assert np.median(shares[name]) < 0.06, name
    assert np.median(shares["lafortune"]) < 0.15


@pytest.mark.parametrize("name, given", [("ward", {}), STRETCHED[0], ("he_torrance", {})], ids=name_of)
def test_blank_rows_are_as_long_as_baked_ones(name, given):
    blank, baked = row_bake.blank(MODELS[name], given), row_bake.bake(MODELS[name], given)
    assert blank.layout.stretch == pytest.approx(baked.layout.stretch, rel=1e-6)  # single precision in the baked ones
    assert replace(blank.layout, stretch=baked.layout.stretch) == baked.layout
    assert blank.channels == baked.channels and blank.numbers == baked.numbers
    assert [array.shape for array in arrays(blank)] == [array.shape for array in arrays(baked)]
    assert not any(array.any() for array in arrays(blank))


def test_spikes_are_kept_apart():
    baked = row_bake.bake(MODELS["he_torrance"], {"sigma": 0.02})
    p = MODELS["he_torrance"].resolve({"sigma": 0.02})
    angles = baked.layout.view_angles()
    np.testing.assert_allclose(baked.spike[:: lobe_rows.SPIKES], MODELS["he_torrance"].spike(np.cos(angles), p))
    assert len(row_bake.bake(MODELS["ward"], {}).spike) == 0


def test_rows_are_kept_and_the_same_again():
    model, given = MODELS["blinn_original"], {"exponent": 33.0}
    kept_bakes.allow(False)
    baked = row_bake.bake(model, given)
    assert row_bake.bake(model, {"exponent": 33.0, "samples": 2}) is baked
    row_bake._baked.cache_clear()
    again = row_bake.bake(model, given)
    assert again is not baked
    for one, other in zip(arrays(again), arrays(baked), strict=True):
        np.testing.assert_array_equal(one, other)


def test_the_shader_is_given_rows_number_by_number():
    """The order that osl/include/weights.h reads: each number is another one here."""
    zeros = lobe_rows.LobeRows.zeros(layout.Layout(2, 1, 1, cell_rings=2, cell_turns=3, stretch=(0.5, 1.0)), 3, True)
    numbered = list(range(1, 1 + sum(array.size for array in arrays(zeros))))
    left = iter(numbered)
    for array in arrays(zeros):
        array[...] = np.reshape([next(left) for _ in range(array.size)], array.shape)
    flat = assembler._flat(zeros, 3)
    facets, residual, head, row = zeros.facets, zeros.residual, 3, zeros.numbers // 2
    second = flat[head + row : head + 2 * row]
    assert flat[:2].tolist() == [0.5, 1.0] and flat[2] == zeros.brightness and len(flat) == head + 2 * row + 3 * 9
    assert second[0] == residual.albedo[1]
    assert second[1:8].tolist() == [*facets.slopes[1, 0], *facets.widths[1, 0], *facets.colour[1, 0]]
    assert second[8:15].tolist() == [*facets.slopes[1, 1], *facets.widths[1, 1], *facets.colour[1, 1]]
    rest = 1 + 7 * lobe_rows.FACETS
    assert second[rest:].tolist() == [*zeros.diffuse[1], *residual.ring_edges[1], *residual.cell_edges[1].ravel(),
                                      *residual.energies[1].ravel()]
    assert flat[head + 2 * row :].tolist() == zeros.spike.ravel().tolist()


@pytest.mark.parametrize("bad", [-1e-3, np.nan, np.inf])
def test_what_is_no_reflectance(bad):
    broken = replace(MODELS["blinn_original"], id="broken",
                     lobe=lambda view, light, p: np.where(view[:, 2] < 0.9, bad, 1.0))
    with pytest.raises(ValueError, match="broken: the formula gives") as caught:
        row_bake.bake(broken, {})
    assert f"{bad:g}" in str(caught.value) and "degrees" in str(caught.value)


def test_any_formula_has_rows():
    """One line of NumPy, and nothing else: here light that comes back, in a ring about the view."""
    def ring(view, light, p):
        return 0.5 * np.exp(-30.0 * ((view * light).sum(axis=1) - 0.9) ** 2)

    model = replace(MODELS["blinn_original"], id="ring", lobe=ring, width=lambda p: 0.2)
    baked = row_bake.bake(model, {})
    for index in ROWS:
        assert errors(model, {}, baked, index) < 0.02, index
