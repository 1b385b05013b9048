from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesRegressor, HistGradientBoostingRegressor

from interpreted import compiled_only
from relforest.rl.vectors import TreesQ
from relforest.rl.vectors.approximator import Rows
from relforest.rl.vectors.trees import Regressor, _boosting, _extra_trees
from relforest.support.errors import InputError
from rl.vectors.picked_things import learned, reward


@pytest.mark.parametrize(
    ("grow", "peer"),
    [
        (
            _extra_trees,
            ExtraTreesRegressor(30, min_samples_leaf=4, max_features=1 / 3, random_state=5),
        ),
        (_boosting, HistGradientBoostingRegressor(early_stopping=False, random_state=5)),
    ],
)
def test_values_are_those_of_scikit_learn(grow: Any, peer: Any) -> None:
    rng = np.random.default_rng(0)
    examples = rng.normal(size=(60, 3)).astype(np.float32)
    targets = examples[:, 0] * 3.0 + np.abs(examples[:, 1]) + 7.0
    others = rng.normal(size=(20, 3)).astype(np.float32)
    found = grow(examples, targets, 5).values(Rows(others.astype(np.float64), np.arange(20)))
    np.testing.assert_allclose(found, peer.fit(examples, targets).predict(others), rtol=1e-9)


@compiled_only
@pytest.mark.parametrize("regressor", ["trees", "boosting"])
def test_it_learns_which_things_are_worth_picking(regressor: Regressor) -> None:
    assert reward(learned(TreesQ(regressor))) > 2.2


def test_options_are_checked_and_told() -> None:
    assert TreesQ("boosting").to_dict() == {"name": "boosting-q", "sweeps": 5}
    with pytest.raises(InputError, match="regressor must be one of 'trees', 'boosting'"):
        TreesQ("oaks")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="sweeps must be an integer of at least 1"):
        TreesQ("trees", sweeps=0)
