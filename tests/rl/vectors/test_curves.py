from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.rl.experience import concatenate
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.view import View
from relforest.rl.settings import LSPISettings
from relforest.rl.vectors import LSPI, LinearQ
from relforest.rl.vectors.approximator import Rows
from relforest.rl.vectors.curves import Curves
from relforest.support.errors import InputError, ModelFormatError
from rl.small_worlds import ACTION_TYPES, SCHEMA, two_episodes
from rl.vectors.picked_things import learned, reward

CURVES = Curves(
    np.array([[0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 10.0, 20.0, 30.0, 40.0]]),
    np.array([[[0.0, 1.0, 4.0, 9.0, 16.0], [5.0] * 5], [[0.0] * 5, [0.0, 1.0, 2.0, 3.0, 4.0]]]),
    np.array([100.0, -2.0]),
)


def test_a_value_is_that_of_the_first_action_and_an_advantage() -> None:
    rows = Rows(np.array([[2.5, 0.0], [1.0, 15.0], [9.0, -1.0]]), np.array([0, 0, 2]))
    # The first: 4 + (9 - 4) / 2 = 6.5, 5 and the constant; it is the base of the second, whose own curves say
    # 0 and 1.5 beside the constant -2. Beyond the last knot, the curve stays at 16.
    assert CURVES.values(rows).tolist() == [111.5, 111.5 + 1.5 - 2.0, 16.0 + 5.0 + 100.0]


def test_a_ridge_of_almost_nothing_fits_what_was_earned() -> None:
    # Every return is different, and so is every vector: it can be explained.
    batch = two_episodes()
    view = View(SCHEMA, ())
    evidence = Evidence.of([batch], view, view.schemas(ACTION_TYPES), 0.5)
    vectors = np.arange(20.0).reshape(10, 2)
    base = np.repeat([0, 3, 5, 6, 8], [3, 2, 1, 2, 2])
    rows = Rows(vectors, base)
    found = LinearQ(ridge=1e-6, sweeps=1).improved(None, evidence, rows, np.random.default_rng(0))
    # Picking at once earns half a unit, after that nothing is earned.
    assert evidence.earned().tolist() == [0.5, 0.0, 0.0]
    assert found.values(rows)[evidence.taken] == pytest.approx([0.5, 0.0, 0.0], abs=1e-3)


@compiled_only
@pytest.mark.parametrize("approximator", [LinearQ(ridge=1.0), LSPI(ridge=1.0)])
def test_it_learns_which_things_are_worth_picking(approximator: LinearQ | LSPI) -> None:
    assert reward(learned(approximator)) > 2.2


def test_values_beyond_what_rewards_allow_are_an_error() -> None:
    batch, view = concatenate([two_episodes()]), View(SCHEMA, ())
    evidence = Evidence.of([batch], view, view.schemas(ACTION_TYPES), 0.5)
    rows = Rows(np.zeros((10, 2)), np.repeat([0, 3, 5, 6, 8], [3, 2, 1, 2, 2]))
    huge = Curves(CURVES.knots, CURVES.heights, np.array([1e9, 0.0]))
    with pytest.raises(InputError, match="learning diverges"):
        LinearQ().improved(huge, evidence, rows, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("name", "array", "message"),
    [
        ("knots", np.zeros((2, 5)), "knots must be in ascending"),
        ("knots", np.zeros((3, 5)), "knots must be finite numbers in the shape"),
        ("heights", np.full((2, 2, 5), np.nan), "heights must be finite"),
        ("constants", np.zeros(2, dtype=np.int64), "constants must be finite"),
    ],
)
def test_damaged_curves_are_refused(name: str, array: Any, message: str) -> None:
    assert Curves.of(CURVES.arrays(), 2, origin="file").arrays() == CURVES.arrays()
    with pytest.raises(ModelFormatError, match=f"file: {message}"):
        Curves.of({**CURVES.arrays(), name: array}, 2, origin="file")


def test_a_ridge_shrinks_what_lspi_learns() -> None:
    batch, view = two_episodes(), View(SCHEMA, ())
    evidence = Evidence.of([batch], view, view.schemas(ACTION_TYPES), 0.5)
    rows = Rows(np.arange(20.0).reshape(10, 2), np.repeat([0, 3, 5, 6, 8], [3, 2, 1, 2, 2]))
    weak, strong = (
        LSPI(ridge=ridge).improved(None, evidence, rows, np.random.default_rng(0)) for ridge in (1e-6, 1e3)
    )
    # Short of the 0.5 that the first transition earns, as the matrix must not be ill-conditioned.
    assert 0.3 < weak.values(rows)[evidence.taken[0]] < 0.5
    assert np.abs(strong.heights).max() < 0.1 * np.abs(weak.heights).max()


@pytest.mark.parametrize("options", [{"ridge": 0.0}, {"sweeps": 0}])
def test_options_out_of_range_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        LinearQ(**options)


def test_options_are_told() -> None:
    assert LinearQ().to_dict() == {"name": "linear-q", "ridge": 30.0, "sweeps": 15}
    assert LSPI(settings=LSPISettings(max_iterations=3)).to_dict()["max_iterations"] == 3
