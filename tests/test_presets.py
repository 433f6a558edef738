"""Presets: each is a legal choice of its model's parameters, makes no light, and metals have their measured colours."""
import json

import numpy as np
import pytest

from addon import cli
from addon.backends.osl import estimator
from addon.brdf import MODELS
from addon.library import presets
from addon.library.metals import METALS
from addon.library.presets import GROUPS, PRESETS
from addon.models.channels import rgb
from addon.models.fresnel import conductor

ANGLES = np.arange(0.0, 81.0, 10.0)
FROM_MEASURED = 0.005  # of a metal's reflectance, at normal incidence
FIRST_SEVEN = ("brushed_metal", "satin", "coated_plastic", "road_paint", "retro_sheeting", "traffic_sign", "cats_eye")


def albedos(preset):
    return rgb(MODELS[preset.model].albedo(np.cos(np.radians(ANGLES)), **preset.parameters))


@pytest.mark.parametrize("name", PRESETS)
def test_preset_is_legal_and_makes_no_light(name):
    preset = PRESETS[name]
    model = MODELS[preset.model]
    resolved = model.resolve(preset.parameters)  # refuses unknown names and values out of range
    for key, value in preset.parameters.items():
        assert resolved[key] == model.parameter(key).check(value)
        assert model.parameter(key).evaluated
    albedo = albedos(preset)
    assert albedo.min() >= 0.0 and albedo.max() <= 1.0 + 1e-3
    assert albedo.max() > 0.05  # none is black
    assert preset.label and len(preset.help) > 30 and name.isidentifier()
    # It says where its numbers come from.
    assert any(word in preset.help for word in ("measured", "refractive index", "by eye")), preset.help


def test_albedo_above_one_is_seen():
    """Blinn's, of which the test above would let nothing pass."""
    assert MODELS["blinn"].albedo([1.0], exponent=20.0)[0] > 1.0 + 1e-3


def metals():
    return {name: preset for name, preset in PRESETS.items() if preset.group == "Metals"}


@pytest.mark.parametrize("name", metals())
def test_metal_has_its_measured_colour(name):
    preset = PRESETS[name]
    metal = METALS["aluminium" if name == "brushed_metal" else name.split("_")[0]]
    at_normal = albedos(preset)[0]
    assert np.abs(at_normal - metal.f0).max() <= FROM_MEASURED
    if preset.model == "pumped_phong":
        # Seen at 60 degrees it is as bright as the smooth metal, and no brighter, but for what a wide lobe loses.
        smooth = conductor([0.5], metal.ior, metal.extinction)[0]
        lost = 1.0 - albedos(preset)[6] / smooth
        assert lost.min() > -0.03 and lost.max() < (0.07 if name.endswith("polished") else 0.2)


def test_every_metal_is_there_and_widths_are_in_order():
    assert {f"{metal}_polished" for metal in METALS} <= set(PRESETS)
    exponents = [PRESETS[f"aluminium_{finish}"].parameters["exponent"] for finish in ("polished", "satin", "rough")]
    assert exponents == sorted(exponents, reverse=True)
    assert 30 <= len(PRESETS) <= 45


def test_groups_hold_all_presets_and_keys_stay_valid():
    grouped = presets.in_groups()
    assert list(grouped) == list(GROUPS)
    assert [name for group in grouped.values() for name in group] == list(PRESETS)
    assert all(len(group) >= 3 for group in grouped.values())
    assert set(FIRST_SEVEN) <= set(PRESETS)
    labels = [preset.label for preset in PRESETS.values()]
    assert len(set(labels)) == len(labels)


def test_all_render_without_a_bake():
    assert not any(estimator.is_baked(MODELS[preset.model]) for preset in PRESETS.values())


@pytest.mark.parametrize("name", [name for name, preset in PRESETS.items() if preset.group == "Retroreflectors"])
def test_retroreflectors_return_light(name):
    preset = PRESETS[name]
    view = np.array([[np.sin(0.6), 0.0, np.cos(0.6)]])
    back, other = (MODELS[preset.model].evaluate(view, light, **preset.parameters)[0].max()
                   for light in (view, view[:, [1, 0, 2]]))
    assert back > 3.0 * other


def test_list_shows_presets_by_group(capsys):
    assert cli.main(["list", "--presets"]) == 0
    text = capsys.readouterr().out
    places = [text.index(f"{group}\n") for group in GROUPS]
    assert places == sorted(places)
    assert all(f"  {name} " in text and preset.help in text for name, preset in PRESETS.items())
    assert ", baked" not in text
    assert cli.main(["list", "edwards_fit", "--presets", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert [entry["id"] for entry in shown] == [name for name, p in PRESETS.items() if p.model == "edwards_fit"]
    assert all(entry["group"] == "Paints" and entry["parameters"] for entry in shown)
