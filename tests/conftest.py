"""What all tests share: tables put back after each test."""
import numpy as np
import pytest

from addon.baking import weights, weights_error
from addon.brdf import tables


@pytest.fixture
def table_folder(tmp_path):
    """An empty folder that tables are read from and baked to during one test."""
    tables.use_folder(tmp_path)
    yield tmp_path
    tables.use_folder()


@pytest.fixture
def no_weights(monkeypatch):
    """Baked models get a few zeros for weights, at once, in tests that do not render; nobody else gets to see them."""
    from addon.blender import cache

    monkeypatch.setattr(cache, "_memory", {})
    few = weights.Weights(weights.ROUND, np.zeros((1, 1)), np.zeros((0, 3)), 1, np.zeros(1))
    known = weights_error.WeightsError(np.zeros(1), np.array([0.012]), np.array([-0.001]))
    monkeypatch.setattr(weights, "weights", lambda model, parameters: few)
    monkeypatch.setattr(weights_error, "error", lambda model, parameters: known)
