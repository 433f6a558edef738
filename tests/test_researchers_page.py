"""The example of docs/researchers.md, taken from the page: it is a model as the page says, and renders as one."""
import contextlib
import re
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from addon import brdf

PAGE = Path(__file__).resolve().parents[1] / "docs" / "researchers.md"
BLOCK = re.compile(r"<!-- tests/test_researchers_page\.py[^\n]*-->\n```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAME = "addon.models.formulas.trowbridge_of_the_page"
FOUR = "(4.0 * dot(view, h)"  # the factor that a wrong one is put in place of


def source():
    blocks = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert len(blocks) == 1
    return blocks[0]


@contextlib.contextmanager
def registered(text):
    """The model that the module `text` registers, until the context ends."""
    module = types.ModuleType(NAME)
    module.__package__ = "addon.models.formulas"
    sys.modules[NAME] = module  # dataclasses look for their module
    before = set(brdf.MODELS)
    try:
        exec(compile(text, NAME, "exec"), module.__dict__)
        assert set(brdf.MODELS) - before == {"trowbridge"}
        yield brdf.MODELS["trowbridge"]
    finally:
        brdf.MODELS.pop("trowbridge", None)
        del sys.modules[NAME]


@pytest.fixture
def model():
    with registered(source()) as found:
        yield found


def albedo(mu, m, count=1500):
    """Mean of N·L / (N·L + N·V - N·L N·V) over half vectors spread as the page's p(H), by the midpoint rule.

    Written from the page's formulas alone: with dω_L = 4 V·H dω_H, p(H) dω_H is what the midpoints are even in.
    """
    u = (np.arange(count) + 0.5) / count
    tangent, turn = m * np.sqrt(u / (1.0 - u))[:, None], np.pi * u
    z = 1.0 / np.sqrt(1.0 + tangent**2)
    facing = np.sqrt(1.0 - mu * mu) * z * tangent * np.cos(turn) + mu * z
    light = 2.0 * facing * z - mu
    seen = (facing > 0.0) & (light > 0.0)
    return np.where(seen, light / np.where(seen, light + mu - light * mu, 1.0), 0.0).mean()


@pytest.mark.parametrize("m", [0.1, 0.5])
def test_the_example_is_what_the_page_says(m, model):
    mu = np.array([1.0, 0.7, 0.3, 0.1])
    expected = np.array([albedo(x, m) for x in mu])
    np.testing.assert_allclose(model.albedo(mu, roughness=m), expected, atol=2e-3)
    assert expected.max() < 1.0 and expected.min() > 0.3
    rng = np.random.default_rng(1)
    view, light = rng.normal(size=(2, 500, 3))
    view, light = (np.abs(d) / np.linalg.norm(d, axis=1, keepdims=True) for d in (view, light))
    there, back = (model.evaluate(*pair, roughness=m) for pair in ((view, light), (light, view)))
    np.testing.assert_allclose(there, back, rtol=1e-9)
    # Weights f (N·L) / density of its own samples have the albedo for their mean, which they have by no other density.
    u = (np.stack(np.meshgrid(np.arange(400), np.arange(40), indexing="ij"), -1).reshape(-1, 2) + 0.5) / [400, 40]
    view = np.array([[np.sqrt(1.0 - 0.49), 0.0, 0.7]])
    drawn = model.sample(view, u, roughness=m)
    weight = model.evaluate(view, drawn, roughness=m) * np.maximum(drawn[:, 2], 0.0)
    assert (weight / model.pdf(view, drawn, roughness=m)).mean() == pytest.approx(expected[1], abs=2e-3)


def test_a_wrong_factor_is_caught():
    assert source().count(FOUR) == 1
    with registered(source().replace(FOUR, "(4.1 * dot(view, h)")) as wrong:
        assert abs(wrong.albedo([0.7], roughness=0.1)[0] - albedo(0.7, 0.1)) > 0.01
    assert "trowbridge" not in brdf.MODELS and NAME not in sys.modules


def test_the_reference_is_called_as_the_page_says():
    text = PAGE.read_text(encoding="utf-8")
    names = {}
    exec(re.search(r"```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)[1], names)
    assert names["f"].shape == (2,) and names["a"].shape == (2,)
    assert names["drawn"].shape == (1000, 3) and names["density"].min() > 0.0
    # The mirror direction of 36.9 degrees at n = 50, before pumping (n+2)/(2 pi): pumps divide by an albedo below 1.
    assert names["f"][0] > 52.0 / (2.0 * np.pi) > names["f"][1]


@pytest.mark.blender
def test_the_example_renders(model):
    from addon import create_material, measure

    given, angles = {"roughness": 0.3}, np.array([0.0, 50.0])
    with measure.quiet():
        material = create_material("trowbridge", **given)
    measured, noise = measure.furnace(material, angles, 256, 16, 0)
    expected = np.array([albedo(mu, 0.3) for mu in np.cos(np.radians(angles))])
    assert noise.max() < 2e-3
    np.testing.assert_allclose(measured.mean(axis=1), expected, atol=0.01)
    np.testing.assert_allclose(model.albedo(np.cos(np.radians(angles)), **given), expected, atol=2e-3)
