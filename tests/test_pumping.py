"""Albedo pumping-up against the paper's claims, the design's check values, and an integration of another kind."""
import numpy as np
import pytest
from truth import quadrature

from addon.brdf import MODELS
from addon.models import pumping
from addon.models.lobes import BLINN, PHONG
from addon.models.pump_stages import albedos as stage_albedos

N = 20.0
COSINES = np.cos(np.radians([40.0, 60.0, 80.0, 85.0]))
LOBES = {"phong": PHONG, "blinn": BLINN}
CHECKED = 3e-4  # the figures below are rounded to 5e-5; tables and quadratures add less than 1e-4 at these angles
PLAIN = [[0.7660, 0.5005, 0.2004, 0.1383], [0.9482, 0.8710, 0.6377, 0.5189], [0.9905, 0.9749, 0.8699, 0.7721],
         [0.9987, 0.9952, 0.9494, 0.8838]]
TWICE_CONTROLLED = [0.9480, 0.8713, 0.6776, 0.6034]


@pytest.fixture(scope="module")
def chains():
    """The chains integrated without the package, by (lobe, control)."""
    return {(lobe, control): quadrature.Chain(lobe, N, control) for lobe in LOBES for control in (False, True)}


@pytest.mark.parametrize("pumps", range(4))
def test_plain_phong_has_the_checked_albedos(pumps, chains):
    model = MODELS["pumped_phong"]

    def evaluate(view, light):
        return model.evaluate(view, light, exponent=N, pumps=pumps, control=False)

    for albedos in (
        stage_albedos(PHONG, N, COSINES, False)[:, pumps],
        model.albedo(COSINES, exponent=N, pumps=pumps, control=False),
        [quadrature.albedo(evaluate, "phong", mu, N) for mu in COSINES],
        chains["phong", False].at(COSINES, pumps),
    ):
        np.testing.assert_allclose(albedos, PLAIN[pumps], rtol=0.0, atol=CHECKED)


@pytest.mark.parametrize("pumps", [2, 3, 4])
def test_controlled_phong_ends_at_the_limit_after_two_pumps(pumps, chains):
    model, limit = MODELS["pumped_phong"], MODELS["phong_limit"]

    def evaluate(view, light):
        return model.evaluate(view, light, exponent=N, pumps=pumps, control=True)

    results = [model.albedo(COSINES, exponent=N, pumps=pumps, control=True),
               [quadrature.albedo(evaluate, "phong", mu, N) for mu in COSINES],
               limit.albedo(COSINES, exponent=N),
               [quadrature.albedo(lambda v, light: limit.evaluate(v, light, exponent=N), "phong", mu, N)
                for mu in COSINES]]
    if pumps < pumping.MAX_PUMPS:
        results += [stage_albedos(PHONG, N, COSINES, True)[:, pumps], chains["phong", True].at(COSINES, pumps)]
    for albedos in results:
        np.testing.assert_allclose(albedos, TWICE_CONTROLLED, rtol=0.0, atol=CHECKED)


def test_control_costs_phong_what_the_plain_second_pump_gains():
    """The other side of the above: without control the second pump goes well past the limit."""
    plain, limited = (MODELS["pumped_phong"].albedo(COSINES, exponent=N, pumps=2, control=c) for c in (False, True))
    assert np.all(plain - limited > 0.04)


def test_controlled_blinn_gains_nothing_after_the_first_pump(chains):
    first = MODELS["pumped_blinn"].albedo(COSINES, exponent=N, pumps=1)
    for pumps in (2, 3, 4):
        # "Nothing" is what a plot cannot show: the gain is 8e-4 at 40 degrees and falls towards grazing.
        assert np.abs(MODELS["pumped_blinn"].albedo(COSINES, exponent=N, pumps=pumps) - first).max() < 1e-3
    assert np.abs(chains["blinn", True].at(COSINES, 2) - chains["blinn", True].at(COSINES, 1)).max() < 1e-3
    assert np.all(first - MODELS["blinn"].albedo(COSINES, exponent=N) > 0.05)
    plain = [MODELS["pumped_blinn"].albedo(COSINES, exponent=N, pumps=p, control=False) for p in (1, 2)]
    assert np.all(plain[1] - plain[0] > 0.08)


def test_blinn_passes_one_at_normal_incidence_and_the_first_pump_mends_it():
    assert quadrature.exact_a0("blinn", 1.0, N) == pytest.approx(1.0607, abs=5e-5)
    assert MODELS["blinn"].albedo(1.0, exponent=N)[0] == pytest.approx(1.0607, abs=5e-5)
    assert stage_albedos(BLINN, N, 1.0, False)[0, 0] == pytest.approx(1.0607, abs=5e-5)
    # Exactly 1: a_0 is largest at the normal, so every light is divided by it. 1e-3 is the table's.
    assert MODELS["pumped_blinn"].albedo(1.0, exponent=N, pumps=1, control=False)[0] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("control", [False, True])
@pytest.mark.parametrize("lobe", LOBES)
def test_chain_agrees_with_integration_over_the_lobe(lobe, control, chains):
    """Normal to grazing. The other integration errs by up to 1e-4 (midpoint rule, curves between its views)."""
    mu = np.cos(np.radians([0.0, 20.0, 40.0, 60.0, 70.0, 80.0, 85.0]))
    expected = [[chains[lobe, control].albedo(m, stage) for stage in range(4)] for m in mu]
    np.testing.assert_allclose(stage_albedos(LOBES[lobe], N, mu, control), expected, rtol=0.0, atol=2e-4)


@pytest.mark.parametrize("control", [False, True])
@pytest.mark.parametrize("lobe", LOBES)
def test_models_divide_by_the_correction_of_the_chain(lobe, control, chains):
    """evaluate() against f_0 / D with D from the other integration, fractions of pumps included."""
    view = quadrature.view_at(0.4)
    light, _ = quadrature.lobe_nodes(lobe, 0.4, N, rings=12, turns=9)
    light = light[light[:, 2] > 0.05]
    for pumps in (0.0, 0.3, 1.0, 1.7, 2.0, 3.5, 4.0):
        value = MODELS[f"pumped_{lobe}"].evaluate(view, light, exponent=N, pumps=pumps, control=control)
        expected = quadrature.f0(lobe, view, light, N) / chains[lobe, control].d(view, light, pumps)
        # Each factor of D is one reading of a table: 1e-3, beside the chain's own 2e-4.
        np.testing.assert_allclose(value, expected, rtol=1.2e-3 * max(pumps, 1e-9))


@pytest.mark.parametrize("control", [False, True])
@pytest.mark.parametrize("model", ["pumped_phong", "pumped_blinn"])
@pytest.mark.parametrize("pumps", [1, 2, 3])
def test_fractional_pumps_are_continuous_across_whole_ones(model, control, pumps):
    view = quadrature.view_at(0.3)
    light, _ = quadrature.lobe_nodes(model[7:], 0.3, N, rings=10, turns=9)
    light = light[light[:, 2] > 0.01]
    below, at, above, half = (MODELS[model].evaluate(view, light, pumps=p, control=control)
                              for p in (pumps - 1e-9, pumps, pumps + 1e-9, pumps - 0.5))
    np.testing.assert_allclose(below, at, rtol=1e-7)  # |ln m| < 10, so 1e-9 of a pump changes less than 1e-8
    np.testing.assert_allclose(above, at, rtol=1e-7)
    if pumps == 1 or not control:  # later controlled pumps may change nothing at all
        assert np.abs(half / at - 1.0).max() > 0.01


@pytest.mark.parametrize("control", [False, True])
@pytest.mark.parametrize("exponent", [1.0, 3.0, 20.0, 700.0, 100000.0])
def test_fractional_pumps_are_legal_and_gain(exponent, control):
    """Albedo <= 1 and never less with more pumps; 2e-4 is for what the tables' reading leaves."""
    mu = np.array([0.0, 0.003, 0.03, 0.2, 0.5, 0.8, 1.0])
    series = [MODELS["pumped_phong"].albedo(mu, exponent=exponent, pumps=p, control=control)
              for p in np.arange(0.0, 4.01, 0.25)]
    assert np.max(series) <= 1.0 + 2e-4
    # D may grow for a pair where control holds it up, but no albedo falls by more than control moves.
    assert np.min(np.diff(series, axis=0)) > -1e-3
    assert np.all(series[4][1:-1] > series[0][1:-1])


def test_correction_by_hand():
    """One pair of directions, every stage worked out on paper from eq. 20 and the cumulative eq. 21."""
    at_view, at_light = np.array([[0.5, 0.8, 0.9, 1.0]]), np.array([[0.6, 0.7, 0.95, 1.0]])
    mu_view, mu_light = np.array([0.55]), np.array([0.3])

    def d(pumps, control):
        return pumping.correction(at_view, at_light, mu_view, mu_light, pumps, control).item()

    assert d(0, False) == d(0, True) == 1.0
    assert d(1, False) == pytest.approx(0.6)
    assert d(2, False) == pytest.approx(0.48)
    assert d(3, False) == pytest.approx(0.456)
    assert d(1.5, False) == pytest.approx(0.6 * 0.8**0.5)
    assert d(1, True) == pytest.approx(0.6)
    assert d(2, True) == pytest.approx(0.55)
    assert d(3, True) == pytest.approx(0.55)
    assert d(3, True) == pumping.limit(mu_view, mu_light).item()
