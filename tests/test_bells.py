"""The bells that make up a lump: what they leave, and where, against the lump itself on a grid of squares."""
import json

import numpy as np
import pytest

from addon.forms import bells
from addon.forms.albedo import tables

STORED = json.loads((tables.folder() / bells.FILE).read_text(encoding="utf-8"))
WIDTH = 2.4 / 600
X, Y = np.meshgrid(*[(np.arange(600) + 0.5) * WIDTH - 1.2] * 2)
R2 = X * X + Y * Y


def rows():
    """(exponent, the row of the table) at nodes of both tables."""
    for node in (4, 7, 10, 15, 20):
        yield bells.NODES / node - 1.0, STORED["table"][node]
        yield bells.NODES / node - 1.0, STORED["steep"][node - bells.STEEP_FROM][: -bells.KNOTS - 1]


def remainder(exponent, row):
    lump = np.where(R2 < 1.0, (exponent + 1.0) / np.pi * np.maximum(1.0 - R2, 0.0) ** exponent, 0.0)
    return lump - bells.bells(row, X, Y, 1.0 / np.sqrt(2.0 * (exponent + 2.0)))


def test_bells_hold_what_their_shares_say():
    for exponent, row in rows():
        held = bells.bells(row, X, Y, bells.deviation_of(exponent)).sum() * WIDTH**2
        assert held == pytest.approx(row[0] + sum(row[2::3]), abs=2e-3)


def test_bells_are_hardly_above_the_lump_and_many_leave_less_than_few():
    residual = {}
    for exponent, row in rows():
        excess = np.maximum(-remainder(exponent, row), 0.0).sum() * WIDTH**2
        assert excess < 0.004
        residual.setdefault(exponent, []).append(np.maximum(remainder(exponent, row), 0.0).sum() * WIDTH**2)
        assert bells.residual_and_excess(row, exponent) == pytest.approx((residual[exponent][-1], excess), abs=2e-3)
    assert all(many < 0.7 * few for few, many in residual.values())
    assert residual[1.0][1] < 0.1 and residual[4.0][1] < 0.02


def test_between_two_knots_lies_an_equal_part_of_what_is_left():
    for node in (4, 10, 20):
        row = STORED["steep"][node - bells.STEEP_FROM]
        residual = np.maximum(remainder(bells.NODES / node - 1.0, row[: -bells.KNOTS - 1]), 0.0)
        knots = row[-bells.KNOTS - 1 :]
        assert knots[0] == 0.0 and knots[-1] == 1.0
        parts = [residual[(low <= R2) & (high > R2)].sum() / residual[R2 < 1.0].sum()
                 for low, high in zip(knots, knots[1:], strict=False)]
        np.testing.assert_allclose(parts, 1.0 / bells.KNOTS, rtol=0.05)
