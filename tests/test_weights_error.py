"""The stated error of lobe rows: against sums that share nothing with it, and rows that are wrong on purpose."""
import json
from dataclasses import replace

import numpy as np
import pytest
from truth.hemisphere import half_vector_lights
from truth.rows import Row

from addon import cli
from addon.brdf import MODELS
from addon.forms.rows import error as rows_error
from addon.forms.rows import row_bake

CASES = [("ward", {}), ("cook_torrance", {"roughness": 0.7}), ("lafortune", {}),
         ("ashikhmin_shirley", {"base_color": (0.9, 0.5, 0.2), "diffuse_color": (0.1, 0.1, 0.5)})]


@pytest.mark.parametrize("name, given", CASES, ids=[name for name, _ in CASES])
def test_the_albedo_between_rows(name, given):
    """The mean of what both rows give there: bases as Cycles evaluates them, cells as the shader draws them."""
    model = MODELS[name]
    baked, found = row_bake.bake(model, given), rows_error.error(model, given)
    for i in (1, 3, 5):
        theta, row = found.theta[i], int(np.searchsorted(baked.layout.view_angles(), found.theta[i])) - 1
        view, shown = np.array([np.sin(theta), 0.0, np.cos(theta)]), []
        light, area = half_vector_lights(view, model, given)
        for index in (row, row + 1):
            one = Row(baked, index)
            one.view = view
            shown.append(area @ one.base(light)[:, : baked.channels] + one.kernels()[1].sum(axis=0))
        albedo = model.albedo(np.cos(theta), **given).reshape(-1)
        error = np.mean(shown, axis=0) / albedo - 1.0
        assert np.abs(error).max() == pytest.approx(abs(found.albedo[i]), abs=2e-3)
        assert found.lobe[i] >= abs(found.albedo[i]) - 1e-9


def test_what_a_closure_is_has_no_error():
    """Lambert's diffuse part is a base closure itself."""
    flat = replace(MODELS["blinn_original"], id="flat", lobe=lambda view, light, p: np.full(len(view), 0.3),
                   width=lambda p: 1.0)
    assert max(rows_error.error(flat, {}).largest()) < 2e-3


@pytest.mark.parametrize("which, lobe", [("facets", 0.08), ("cells", 0.006)])
def test_wrong_weights_are_told(monkeypatch, which, lobe):
    """Facets 10 % too bright; cells, which hold about 1 %, in the wrong rings."""
    model, given = MODELS["ward"], {}
    baked, before = row_bake.bake(model, given), rows_error.error(model, given).largest()
    if which == "facets":
        wrong = replace(baked, facets=replace(baked.facets, colour=1.1 * baked.facets.colour))
    else:
        rolled = np.roll(baked.residual.energies, baked.layout.cell_rings // 2, axis=1)
        wrong = replace(baked, residual=replace(baked.residual, energies=rolled))
    monkeypatch.setattr(row_bake, "bake", lambda *_: wrong)
    after = rows_error.error(model, given).largest()
    assert after[0] > before[0] + lobe
    assert (after[1] > before[1] + 0.05) == (which == "facets")


def test_the_command_states_it(capsys):
    assert cli.main(["bake", "--weights", "blinn_original", "--set", "exponent=30", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    error = rows_error.error(MODELS["blinn_original"], {"exponent": 30.0})
    assert found["lobe"] == error.lobe.tolist() and found["rows"] == 48
    assert cli.main(["bake", "--weights", "blinn_original"]) == 0
    assert capsys.readouterr().out.count("%") == 2 * len(error.theta) + 1
    assert cli.main(["bake", "--weights", "phong"]) == 2
    assert "shader of its own" in capsys.readouterr().err
