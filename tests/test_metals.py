"""Metals: against published figures, against the formula they are made for; the derivation on made-up spectra."""
import sys

import numpy as np
import pytest

from addon.library.metals import METALS
from addon.models.fresnel import conductor

# Linear Rec. 709 reflectances at normal incidence that others publish: Unity's Metal Reflectance node, Adobe's table
# of metals for the Standard Material. Samples differ (a fresh film outshines a scratched plate), hence a tolerance
# for each; iron and titanium are known worst.
UNITY = {
    "silver": ((0.972, 0.960, 0.915), 0.07), "aluminium": ((0.913, 0.921, 0.925), 0.01),
    "gold": ((1.000, 0.766, 0.336), 0.02), "copper": ((0.955, 0.637, 0.538), 0.06),
    "chromium": ((0.550, 0.556, 0.554), 0.002), "iron": ((0.560, 0.570, 0.580), 0.09),
    "nickel": ((0.660, 0.609, 0.526), 0.04), "titanium": ((0.542, 0.497, 0.449), 0.1),
    "platinum": ((0.672, 0.637, 0.585), 0.01),
}
ADOBE = {
    "silver": ((0.9868, 0.9830, 0.9667), 0.015), "aluminium": ((0.9157, 0.9226, 0.9236), 0.01),
    "chromium": ((0.5496, 0.5561, 0.5531), 0.002), "nickel": ((0.7014, 0.6382, 0.5593), 0.005),
}
PUBLISHED = [(name, *figures) for table in (UNITY, ADOBE) for name, figures in table.items()]


@pytest.mark.parametrize(("name", "expected", "tolerance"), PUBLISHED)
def test_normal_reflectance_is_the_published_one(name, expected, tolerance):
    np.testing.assert_allclose(METALS[name].f0, expected, atol=tolerance)


@pytest.mark.parametrize("name", METALS)
def test_conductor_formula_reproduces_the_reflectances(name):
    metal = METALS[name]
    n, k = np.array(metal.ior), np.array(metal.extinction)
    at_normal, at_82 = conductor([1.0, 1.0 / 7.0], n, k)
    np.testing.assert_allclose(at_normal, ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2), atol=1e-12)
    np.testing.assert_allclose(at_normal, metal.f0, atol=metal.fit_error + 1e-4)
    np.testing.assert_allclose(at_82, metal.f82, atol=metal.fit_error + 1e-4)


@pytest.mark.parametrize("name", METALS)
def test_metal_is_a_metal(name):
    metal = METALS[name]
    assert all(0.0 < x <= 1.0 for x in metal.f0 + metal.f82)
    assert all(x > 0.0 for x in metal.ior + metal.extinction)
    curve = conductor(np.cos(np.radians(np.linspace(0.0, 90.0, 400))), metal.ior, metal.extinction)
    assert curve.min() > 0.3 and curve.max() <= 1.0 + 1e-12
    np.testing.assert_allclose(curve[-1], metal.f90, atol=1e-9)
    # One dip at most: falling, then rising to 1 at grazing.
    for channel in np.diff(curve, axis=0).T:
        signs = np.sign(channel[np.abs(channel) > 1e-12])
        assert np.all(np.diff(signs) >= 0)
    assert metal.fit_error < 0.002
    assert "doi:10." in metal.reference


def test_colours_tell_the_metals_apart():
    red, green, blue = METALS["gold"].f0
    assert red > green > blue and blue < 0.4
    assert METALS["silver"].f0[1] > METALS["aluminium"].f0[1] > METALS["nickel"].f0[1] > METALS["iron"].f0[1]


def test_metals_need_no_numpy_of_their_own():
    assert "numpy" not in vars(sys.modules["addon.library.metals"])


@pytest.fixture(scope="module")
def derivation():
    pytest.importorskip("colour")
    pytest.importorskip("scipy")
    from addon.dev.demo import derive_metals

    return derive_metals


@pytest.mark.filterwarnings("ignore")
def test_a_mirror_is_white_and_monochrome_light_is_not(derivation):
    weights = derivation.observer_weights()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-12)
    peaks = derivation.WAVELENGTHS[np.argmax(weights, axis=1)]
    assert 590 < peaks[0] < 620 and 520 < peaks[1] < 560 and 440 < peaks[2] < 460


def test_fit_finds_the_index_that_made_the_curve(derivation):
    mu = np.cos(derivation.ANGLES)
    for pair in [(0.2, 3.9), (2.9, 3.1), (1.2, 6.8)]:
        found, error = derivation.fit_constants(conductor(mu, pair[:1], pair[1:])[:, 0], mu)
        np.testing.assert_allclose(found, pair, atol=2e-4)
        assert error < 1e-6


@pytest.mark.filterwarnings("ignore")
def test_file_of_one_grey_metal(derivation, tmp_path):
    path = tmp_path / "Xx-Doe.yml"
    rows = "".join(f"        {um:.2f} 1.5 5.0\n" for um in np.arange(0.35, 0.86, 0.01))
    path.write_text("REFERENCES: |\n    J. Doe.\n    <a href=\"https://doi.org/10.1/x\"><i>Journal</i></a>\n"
                    "DATA:\n  - type: tabulated nk\n    data: |\n" + rows)
    figures = derivation.derive(path, derivation.observer_weights())
    np.testing.assert_allclose(figures["ior"], 1.5, atol=1e-3)
    np.testing.assert_allclose(figures["extinction"], 5.0, atol=1e-3)
    assert figures["overshoot"] == 0.0 and figures["reference"] == "J. Doe. Journal, doi:10.1/x"


@pytest.mark.parametrize("text", ["", "DATA:\n  - type: tabulated nk\n    data: |\n        0.5 1 2\n        0.6 1 2\n"])
def test_file_that_is_no_measurement_is_refused(derivation, tmp_path, text):
    path = tmp_path / "bad.yml"
    path.write_text(text)
    with pytest.raises(ValueError, match="bad.yml"):
        derivation.read_constants(path)
