"""f(V, L) = f(L, V), of the formulas and of what Cycles renders, for all models that say so, and not for the others."""
from dataclasses import replace

import numpy as np
import pytest
from optics.directions import toward
from optics.names import name_of
from optics.pairs import peak, until_sharp
from optics.shapes import OTHER, PUMPED_SHAPES, RENDERED, STRETCHED

from addon import create_material
from addon.brdf import MODELS

# What the sources and the models' descriptions say is not reciprocal: lumps by the scaling projection, sums of lumps
# whose radius or share of light follows the view, and strands, which are lit by their own cosine.
ONE_WAY = ("disk_scaling", "edwards_empirical", "edwards_fit", "kajiya_kay")
GRADED = {"fresnel_type": "schlick", "base_color": (0.9, 0.5, 0.1), "f90": (1.0, 0.8, 0.9)}
MORE = {
    "phong": [{"exponent": 3.0, **GRADED}, {"exponent": 300.0}],
    "blinn": [{"exponent": 3.0, **GRADED}, {"exponent": 300.0}],
    "phong_limit": [{"exponent": 3.0, **GRADED}],
    "pumped_phong": [{"exponent": 3.0, "pumps": 2.5, "control": False, **GRADED}, {"exponent": 50.0, "pumps": 4.0}],
    "pumped_blinn": [{"exponent": 3.0, "pumps": 2.5, "control": False}, {"exponent": 50.0, "pumps": 0.5, **GRADED}],
    "reciprocal_disk": [{"exponent": 3.0, "pumps": 2.5}, {"exponent": 50.0, "pumps": 0.0, **GRADED}],
    "disk_orthogonal": [{"exponent": 3.0, "radius_u": 0.9, "radius_v": 0.4, "rotation": 0.1}],
    "disk_scaling": [{"exponent": 3.0, "radius_u": 0.9, "radius_v": 0.4, "rotation": 0.1}],
    "edwards_empirical": [{"exponent": 3.0, "retro": 0.5, "retro_exponent": 8.0, "base_color": 0.5}],
    "edwards_fit": [{"exponent": 3.0, "renormalize": False, "base_color": 0.5, "f90": 0.5, "diffuse_color": 0.0}],
}
CASES = [(name, given) for name in MODELS for given in
         [{}, *MORE.get(name, ()), *([OTHER[name]] if name in OTHER else ()),
          *(shape for shaped, shape in PUMPED_SHAPES if shaped == name)]]
TWO_WAYS = [(name, given) for name, given in CASES if name not in ONE_WAY]
# Sums of lumps that keep their place and size, of one colour at all angles, are functions of V+L alone.
FITS_OF_ONE_COLOUR = MORE["edwards_fit"][0]


def grid():
    """All pairs (27648, 3) of 12 x 24 views, from 3 degrees off the normal to 0.1 above the horizon, and 96 lights."""
    angles = np.concatenate([np.linspace(3.0, 85.0, 10), [89.0, 89.9]])
    view = toward(np.repeat(angles, 24), np.tile(np.arange(24) * 15.0, 12))
    light = toward(np.repeat(angles, 8), np.tile(np.arange(8) * 45.0, 12))
    return np.repeat(view, len(light), axis=0), np.tile(light, (len(view), 1))


def there_and_back(model, given, view, light):
    there, back = model.evaluate(view, light, **given), model.evaluate(light, view, **given)
    return (x if x.ndim == 2 else x[:, None] for x in (there, back))


def difference(there, back):
    """|f(V, L) - f(L, V)| over the larger of both; what underflows is as good as 0."""
    larger = np.maximum(np.abs(there), np.abs(back))
    return np.where(larger > 1e-280, np.abs(there - back) / np.maximum(larger, 1e-280), 0.0)


def test_the_models_say_so():
    assert {name for name, _ in CASES} == set(MODELS)
    for name, model in MODELS.items():
        assert getattr(model, "symmetric", name not in ONE_WAY) == (name not in ONE_WAY)
        if "not reciprocal" in model.description:
            assert name in ONE_WAY
        if "reciprocal" in model.description.lower().replace("not reciprocal", ""):
            assert name not in ONE_WAY


@pytest.mark.parametrize("name, given", TWO_WAYS, ids=name_of)
def test_reciprocal(name, given):
    view, light = grid()
    there, back = there_and_back(MODELS[name], given, view, light)
    assert np.isfinite(there).all() and there.min() >= 0.0
    assert (there > 0.0).sum() > 1000
    assert difference(there, back).max() <= 1e-10


@pytest.mark.parametrize("name", ONE_WAY)
def test_one_way(name):
    """By more than a half somewhere, and where there is a hundredth of the largest f at least."""
    given = {} if name != "edwards_fit" else {"diffuse_color": 0.0}
    there, back = there_and_back(MODELS[name], given, *grid())
    apart = difference(there, back)[np.maximum(there, back) > 0.01 * np.median(there[there > 0.0])]
    assert apart.max() > 0.5


def test_a_lump_by_the_orthogonal_projection_is_as_reciprocal_as_its_colour():
    """f = p(h), as |V+L| = 2 (L·H), times Schlick's factor of the view: reciprocal where that is one colour."""
    view, light = grid()
    there, back = there_and_back(MODELS["disk_orthogonal"], {"base_color": 0.3, "f90": 0.3}, view, light)
    assert difference(there, back).max() <= 1e-10
    there, back = there_and_back(MODELS["disk_orthogonal"], {"base_color": 0.3}, view, light)
    assert difference(there, back).max() > 0.5
    there, back = there_and_back(MODELS["edwards_fit"], FITS_OF_ONE_COLOUR, view, light)
    assert difference(there, back).max() <= 1e-10


@pytest.mark.parametrize("power", [1e-3, 1e-7])
def test_a_wrong_factor_is_found(power):
    right = MODELS["cook_torrance"]
    wrong = replace(right, lobe=lambda v, light, p: right.lobe(v, light, p) * v[:, 2] ** power)
    there, back = there_and_back(wrong, {"roughness": 0.5}, *grid())
    assert 3.0 * power < difference(there, back).max() < 8.0 * power  # ln(cos 3 deg / cos 89.9 deg) = 6.35


# Through Cycles: sun and camera change places.

SIGMAS = 5.0
BLUR = 0.02  # of a lobe's peak, up to 65 degrees: README's Limits
BLURRED = 0.35  # of that is noise at most
# (angle and azimuth of V, of L): within the lobe and beside it, in the plane of incidence and out of it.
PAIRS = [((20.0, 0.0), (35.0, 180.0)), ((60.0, 0.0), (40.0, 180.0)), ((30.0, 10.0), (55.0, 165.0)),
         ((10.0, 60.0), (25.0, 270.0)), ((62.0, 200.0), (50.0, 40.0))]
WRITTEN = [
    ("phong", {"exponent": 7.0, "fresnel_type": "schlick", "base_color": 0.3}), ("blinn", {"exponent": 20.0}),
    ("pumped_phong", {"exponent": 20.0}), ("pumped_phong", {"exponent": 4.0, "pumps": 3.0, "control": False}),
    ("pumped_blinn", {"exponent": 20.0, "pumps": 1.0}), ("phong_limit", {"exponent": 7.0}),
    ("reciprocal_disk", {"exponent": 20.0}), ("disk_orthogonal", {"exponent": 20.0}),
    ("disk_scaling", {"exponent": 5.0}), ("edwards_fit", {"exponent": 8.0, "base_color": 0.8, "diffuse_color": 0.0}),
    ("edwards_empirical", {"base_color": 0.9, "exponent": 5.0, "retro": 0.3, "retro_exponent": 10.0}),
]
EVERYDAY = ("pumped_phong", "pumped_blinn", "reciprocal_disk")  # the others are proofs
# Each baked model once, as test_render_weights.py renders it; not so sharp that only noise would be seen.
BAKED = [*{name: (name, given) for name, given in reversed(RENDERED + STRETCHED)
           if given.get("exponent", 0.0) < 1e3}.values(), ("blinn_original", {})]
# Wide lobes with kinks and of several colours, and strands, are further off: README's Limits.
WIDER = {"lafortune": 0.05, "kajiya_kay": 0.3, "ashikhmin_shirley": 0.04}


def swapped(model, given, pairs=PAIRS):
    """(f(V, L), f(L, V), noise of their difference, allowed blur of that) in Cycles, of one channel, (N,) each."""
    angles = np.array(pairs)
    view, light = (toward(*angles[:, i].T) for i in (0, 1))
    material = create_material(model, **given)
    views, lights = np.concatenate([view, light]), np.concatenate([light, view])
    shape = {k: v for k, v in given.items() if k not in ("samples",)}
    bound = WIDER.get(model, BLUR) * np.array([peak(MODELS[model], shape, v) for v in views])
    value, noise = until_sharp(material, views, lights, BLURRED * 0.2 * bound)
    f, noise, bound = value[:, 0] / lights[:, 2], noise[:, 0] / lights[:, 2], bound / lights[:, 2]
    n = len(pairs)
    return f[:n], f[n:], np.hypot(noise[:n], noise[n:]), bound[:n] + bound[n:]


def assert_as_the_formula(model, given, pairs=PAIRS):
    there, back, noise, blur = swapped(model, given, pairs)
    angles = np.array(pairs)
    view, light = (toward(*angles[:, i].T) for i in (0, 1))
    one, other = (x[:, 0] for x in there_and_back(MODELS[model], given, view, light))
    z = np.abs((there - back) - (one - other)) - blur
    assert (SIGMAS * noise <= blur).all(), f"too noisy to decide: {noise / blur}"
    assert (z <= SIGMAS * noise).all(), np.round([there, back, one, other, noise, blur], 5)
    return there - back, one - other, noise, blur


@pytest.mark.blender
@pytest.mark.parametrize("model, given", [pytest.param(*case, marks=() if case[0] in EVERYDAY else pytest.mark.proof)
                                          for case in WRITTEN], ids=name_of)
def test_sun_and_camera_change_places(model, given):
    """What is one way differs, in Cycles too, by as much as the formula says, and by more than blur and noise."""
    found, expected, noise, blur = assert_as_the_formula(model, given)
    if model in ONE_WAY:
        clear = np.abs(expected) > 2.0 * (blur + SIGMAS * noise)
        assert clear.any() and (found[clear] * expected[clear] > 0.0).all()
    else:
        np.testing.assert_allclose(expected, 0.0, atol=1e-9)


@pytest.mark.blender
@pytest.mark.proof
@pytest.mark.parametrize("model, given", BAKED, ids=name_of)
def test_baked(model, given):
    assert_as_the_formula(model, given, PAIRS[:3])


@pytest.mark.blender
def test_a_planted_error_is_found_in_cycles(monkeypatch):
    """The usual mistake: what is pumped is divided by the view's albedo, whatever the light's is."""
    from blender_help.materials import plant

    plant(monkeypatch, "SPOILT_LARGER(at_view, at_light)", "at_view")
    there, back, noise, blur = swapped("pumped_phong", {"exponent": 20.0, "control": False})  # control would mend it
    assert (np.abs(there - back) > blur + SIGMAS * noise).any()
