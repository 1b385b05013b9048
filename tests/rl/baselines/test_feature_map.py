from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.rl.baselines import DenseFeatures
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError


def powers(count: int) -> FloatArray:
    return np.vander(np.arange(1.0, count + 1), 3, increasing=True)


def test_any_function_gives_features_and_the_number_of_actions_may_vary() -> None:
    view = DenseFeatures(powers, 3)
    for count in (2, 4, 1, 4):
        indices, values = view.features(count)
        assert indices.tolist() == [[0, 1, 2]] * count
        np.testing.assert_array_equal(values, powers(count))


def test_features_are_copied_from_what_the_function_keeps() -> None:
    kept = np.ones((1, 3))
    view: DenseFeatures[None] = DenseFeatures(lambda _: kept, 3)
    found = view.features(None)
    kept[:] = 7
    assert found.values.tolist() == [[1.0, 1.0, 1.0]]


def test_all_columns_are_active_unless_said_otherwise() -> None:
    assert DenseFeatures(powers, 3).n_active == 3
    assert DenseFeatures(powers, 3, n_active=2).to_dict() == {
        "kind": "dense",
        "name": "dense",
        "n_features": 3,
        "n_active": 2,
    }


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (None, "row per action and 3 columns"),
        (np.zeros(3), r"row per action and 3 columns, got the shape \(3,\)"),
        (np.zeros((2, 4)), "3 columns"),
        (np.zeros((0, 3)), "row per action"),
        ([[0.0, 1.0, 2.0], [1.0]], "must be an array of numbers"),
        ("abc", "must be an array of numbers"),
        ([[0.0, 1.0, 2.0], [1.0, 1.0, float("nan")]], "of action 1 hold nan in column 2"),
        ([[0.0, float("-inf"), 2.0]], "of action 0 hold -inf in column 1"),
        ([[1e200, 0.0, 2.0]], r"of action 0 hold 1e\+200"),
    ],
)
def test_bad_features_are_refused(returned: Any, message: str) -> None:
    view: DenseFeatures[None] = DenseFeatures(lambda _: returned, 3, name="ours")
    with pytest.raises(InputError, match=r"the features 'ours'.*" + message):
        view.features(None)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"n_features": 0}, "n_features must be an integer of at least 1"),
        ({"n_features": 10**8}, "n_features must be at most 10000000"),
        ({"n_active": 0}, "n_active must be an integer of at least 1"),
        ({"name": ""}, "name must be a non-empty string"),
        ({"name": 3}, "name must be a non-empty string"),
    ],
)
def test_bad_options_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        DenseFeatures(powers, **({"n_features": 3} | options))
