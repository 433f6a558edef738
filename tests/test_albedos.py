"""What models divide by: integrated without any file, against integrals of other kinds and against the tables."""
import ast

import numpy as np
import pytest
from truth import quadrature

from addon import resources
from addon.brdf import MODELS, TableError
from addon.forms.albedo.tables import TABLES
from addon.forms.albedo.tabulated import TABULATED
from addon.models import disk, lobes, pump_stages
from addon.models.albedos import INTEGRATED
from addon.models.geometry import view_at
from addon.models.pumped_model import PumpedModel

LOBES = {"phong": lobes.PHONG, "blinn": lobes.BLINN, "disk": lobes.DISK}
CHAINS = [("phong", False), ("phong", True), ("blinn", False), ("blinn", True), ("disk", False)]
EXPONENTS = [1.0, 1.5, 3.0, 20.0, 1000.0, 100000.0]
DIVIDED = {"pumped_phong": {}, "pumped_blinn": {}, "reciprocal_disk": {}, "edwards_fit": {"renormalize": True}}
NODE = 2.1e-5  # of the tables' nodes, 2e-5, and of what is read from curves


def directions(count, seed):
    """Random directions above the horizon, some of them near it."""
    rng = np.random.default_rng(seed)
    mu, phi = rng.random(count) ** 2 + 1e-6, 2.0 * np.pi * rng.random(count)
    return np.stack([np.sqrt(np.maximum(1.0 - mu**2, 0.0)) * np.cos(phi),
                     np.sqrt(np.maximum(1.0 - mu**2, 0.0)) * np.sin(phi), np.minimum(mu, 1.0)], axis=-1)


# No files


@pytest.mark.parametrize("name", MODELS)
def test_every_model_works_without_a_table(name, table_folder):
    assert not any(table_folder.iterdir())
    model = MODELS[name]
    # Albedos of pumped formulas take seconds; few pumps are as good.
    given = {"pumps": 1.0} if isinstance(model, PumpedModel) else DIVIDED.get(name, {})
    view = directions(40, 1)
    light = np.where(np.arange(40)[:, None] % 2, directions(40, 2), view * [-1.0, -1.0, 1.0])
    value = model.evaluate(view, light, **given)
    assert np.isfinite(value).all() and value.max() > 0.0
    assert np.min(model.albedo([0.5], **given)) > 0.0
    drawn = model.sample(view, np.random.default_rng(3).random((40, 2)), **given)
    pdf = model.pdf(view, drawn, **given)
    assert np.isfinite(drawn).all() and np.isfinite(pdf).all() and pdf.max() > 0.0
    if name in DIVIDED:
        with pytest.raises(TableError, match="missing"):
            model.with_albedos(TABULATED).evaluate(view, light, **given)
    else:
        np.testing.assert_array_equal(model.with_albedos(TABULATED).evaluate(view, light, **given), value)


def test_models_know_no_tables():
    """Formulas import nothing that reads albedos from files; what does knows them only through what they are given."""
    room = resources.PACKAGE / "models"
    names = [*room.glob("*_model.py"), *(room / f"{name}.py" for name in (
        "registry", "albedos", "pumping", "pump_stages", "quadrature", "lobes", "disk", "interpolation"))]
    for path in names:
        imported = {alias.name for node in ast.walk(ast.parse(path.read_text("utf-8")))
                    if isinstance(node, ast.ImportFrom) for alias in node.names} | {
                    node.module for node in ast.walk(ast.parse(path.read_text("utf-8")))
                    if isinstance(node, ast.ImportFrom)}
        assert not imported & {"tables", "tabulated", "exr", "axes"}, path
    assert len(names) == 12


def test_pumping_is_written_once():
    """D is made and stages are integrated in pumping.py alone; all others call what takes albedos as a function."""
    users = {"correction": set(), "correction_at": set(), "stage_albedos": set()}
    for path in resources.PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "pumping" and node.attr in users:
                users[node.attr].add(path.stem)
    assert users == {"correction": set(), "correction_at": {"lobe_model", "pumped_model", "quick"},
                     "stage_albedos": {"pump_stages", "pumped_model", "quick"}}


# Accuracy


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("lobe", ["phong", "blinn"])
def test_first_stage_is_the_exact_albedo(lobe, n):
    rng = np.random.default_rng(7)
    mu = np.concatenate([[0.0, 1.0], rng.random(12), rng.random(12) ** 6, 1.0 - 1e-3 * rng.random(6)])
    exact = [quadrature.exact_a0(lobe, m, n) for m in mu]
    for control in (False, True):
        found = INTEGRATED.stages(LOBES[lobe], control, mu, n, 1)
        np.testing.assert_allclose(found[:, 0], exact, rtol=2e-6)


@pytest.mark.parametrize("n", [3.0, 20.0])
@pytest.mark.parametrize("control", [False, True])
@pytest.mark.parametrize("lobe", ["phong", "blinn"])
def test_all_stages_by_another_quadrature(lobe, control, n):
    """Up to 80 degrees: nearer to grazing a lobe is too narrow for the other's even nodes over the azimuth."""
    grid = quadrature.Grid(lobe, n, control)
    near = grid.cosines > np.cos(np.radians(80.0))
    found = INTEGRATED.stages(LOBES[lobe], control, grid.cosines[near], n, 4)
    np.testing.assert_allclose(found, grid.curves.T[near], rtol=1e-5)


@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("lobe, control", CHAINS)
def test_reading_between_the_nodes_of_a_curve(lobe, control, n):
    """Against integrals at the very cosines, crowded about the places where curves have kinks."""
    curves = pump_stages.curves(LOBES[lobe], n, control)
    x = np.random.default_rng(8).random(120)
    kinks = pump_stages.kinks_of_control(curves, 3.0) if control else np.array(LOBES[lobe].kinks)
    near = (curves.angles.coordinate(kinks)[:, None] + np.array([-2e-3, -1e-4, 1e-4, 2e-3])).ravel()
    mu = curves.angles.cosine(np.clip(np.concatenate([x, near]), 0.0, 1.0))
    exact = pump_stages.albedos(LOBES[lobe], n, mu, control, polar=16, azimuthal=48)
    np.testing.assert_allclose(curves.at(mu), exact, rtol=5e-6)


@pytest.mark.parametrize("n", [1.0, 20.0, 100000.0])
@pytest.mark.parametrize("lobe, control", CHAINS)
def test_finer_integrals_are_the_same(lobe, control, n):
    mu = np.cos(np.radians([0.0, 10.0, 31.0, 50.0, 70.0, 85.0, 89.5, 90.0]))
    finer = pump_stages.albedos(LOBES[lobe], n, mu, control, polar=28, azimuthal=64)
    np.testing.assert_allclose(INTEGRATED.stages(LOBES[lobe], control, mu, n, 4), finer, rtol=1e-5)


@pytest.mark.parametrize("n", [1.5, 20.0, 1000.0])
@pytest.mark.parametrize("lobe, control", CHAINS)
def test_the_albedo_of_a_whole_pump_is_the_next_stage(lobe, control, n):
    """The model's own quadrature of f against the stages: they share D, not the nodes."""
    model = MODELS["reciprocal_disk" if lobe == "disk" else f"pumped_{lobe}"]
    mu = np.array([0.0, 1e-3, 0.05, 0.3, 0.6, 0.866, 0.95, 1.0])
    stages = INTEGRATED.stages(LOBES[lobe], control, mu, n, 4)
    for pumps in range(4):
        given = {"pumps": float(pumps)} | ({} if lobe == "disk" else {"control": control})
        np.testing.assert_allclose(model.albedo(mu, exponent=n, **given), stages[:, pumps], rtol=1e-5)


@pytest.mark.parametrize("n", [0.0, 0.3, 1.0, 50.0, 3000.0, 100000.0])
@pytest.mark.parametrize("radius", [0.01, 0.4, 1.0])
def test_volumes_are_those_of_the_lump(n, radius):
    rng = np.random.default_rng(9)
    mu = np.concatenate([[0.0, 1.0], rng.random(60) ** 2, 1.0 - rng.random(40) ** 4])
    one = np.ones_like(mu)
    exact = disk.Lump(np.zeros(2), np.full(2, radius), n).volume(view_at(mu)[:, :2], order=12)
    np.testing.assert_allclose(INTEGRATED.volumes(mu, n * one, radius * one), exact, rtol=1e-6)


def test_volumes_of_several_lumps_at_once():
    mu, n, r = np.array([0.1, 0.5, 0.1]), np.array([2.0, 30.0, 30.0]), np.array([0.5, 0.5, 0.9])
    each = [INTEGRATED.volumes(mu[i:i + 1], n[i:i + 1], r[i:i + 1])[0] for i in range(3)]
    assert INTEGRATED.volumes(mu, n, r).tolist() == each and len(set(each)) == 3


# Against the tables


@pytest.mark.parametrize("lobe, control", CHAINS)
def test_integrated_stages_are_the_tables_nodes(lobe, control):
    """At the nodes of a table within 2e-5; elsewhere a reading of the table errs by up to 1e-3."""
    table = TABLES[f"{lobe}_{'controlled' if control else 'plain'}"]
    exponents = table.rows.exponents()
    for n in exponents[[0, 3, table.rows.rows // 2, -2, -1]]:
        mu = table.columns.cosines(n)
        there = TABULATED.stages(LOBES[lobe], control, mu, n, 4)
        np.testing.assert_allclose(INTEGRATED.stages(LOBES[lobe], control, mu, n, 4), there, rtol=NODE)
    for n in np.sqrt(exponents[[0, 3]] * exponents[[1, 4]]):
        mu = np.random.default_rng(4).random(200)
        there = TABULATED.stages(LOBES[lobe], control, mu, n, 4)
        np.testing.assert_allclose(INTEGRATED.stages(LOBES[lobe], control, mu, n, 4), there, rtol=1.01e-3)


@pytest.mark.parametrize("model, lobe, control", [
    ("pumped_phong", "phong", False), ("pumped_phong", "phong", True), ("pumped_blinn", "blinn", False),
    ("pumped_blinn", "blinn", True), ("reciprocal_disk", "disk", False)])
def test_evaluate_is_the_tabulated_one(model, lobe, control):
    """Within 2e-5 for each pump where view and light are at the columns of a row; within 1e-3 anywhere."""
    table = TABLES[f"{lobe}_{'controlled' if control else 'plain'}"]
    given = {} if lobe == "disk" else {"control": control}
    fast = MODELS[model].with_albedos(TABULATED)
    for row in (0, table.rows.rows // 3, table.rows.rows - 1):
        n = float(table.rows.exponents()[row])
        at_columns = view_at(table.columns.cosines(n)[1:])
        # Lights in the plane of incidence, each near the mirror direction of its view.
        view, light = at_columns[:-1], at_columns[1:] * [-1.0, 1.0, 1.0]
        for pumps in (1.0, 2.5, 4.0):
            here, there = (m.evaluate(view, light, exponent=n, pumps=pumps, **given) for m in (MODELS[model], fast))
            np.testing.assert_allclose(here, there, rtol=NODE * pumps)
    for n, pumps in ((17.0, 1.0), (730.0, 3.0)):
        view = view_at(np.linspace(0.01, 1.0, 80))
        light = view[::-1] * [-1.0, 1.0, 1.0]
        here, there = (m.evaluate(view, light, exponent=n, pumps=pumps, **given) for m in (MODELS[model], fast))
        np.testing.assert_allclose(here, there, rtol=1.01e-3 * pumps)


def test_integrated_volumes_are_the_tables_nodes():
    table = TABLES["disk_volume"]
    for row, layer in ((0, 3), (20, 7), (39, 11)):
        n, radius = table.rows.exponents()[row] - 1.0, table.radii[layer]
        room = table.columns.cosines(n + 1.0) * radius
        mu = np.sqrt(1.0 - (1.0 - room) ** 2)
        given = mu, np.full_like(mu, n), np.full_like(mu, radius)
        np.testing.assert_allclose(INTEGRATED.volumes(*given), TABULATED.volumes(*given), rtol=NODE)
