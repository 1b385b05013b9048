from __future__ import annotations

import numpy as np
import pytest

from relforest.forests import Condition
from relforest.forests.statements import Bound, Near, Statement
from relforest.mappings import Mapping
from relforest.rl.fitted.forest_arrays import ForestArrays, forest_mean, path_parts
from relforest.rl.fitted.horizon import Horizon, Measured
from relforest.rl.fitted.questions import Measures
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.smdp import Decision
from rl.small_worlds import ACTION_TYPES, LOCATION, PICK_SCHEMA, SCHEMA

NUMBER = Condition(0, (Statement(Mapping("identity", LOCATION), (0,), Bound(0, "at most", 0.0)),))
COUNTED = Condition(1, (Statement(Mapping("difference", LOCATION), (0, 1), Near(0, (0.0,), (0.2,))),))


def forests() -> ForestArrays:
    """Return two trees for picking: mean 1, then 0 or 2, and so on; the first has two comparisons.

    Features are the margins of `NUMBER` and `COUNTED`, how many objects satisfy the latter, and how many
    there are.
    """
    return ForestArrays(
        np.array([0, -1, 2, -1, -1, 3, -1, -1]),
        np.array([0.5, 0.0, 0.5, 0.0, 0.0, 2.5, 0.0, 0.0]),
        np.array([[1, 2], [-1, -1], [3, 4], [-1, -1], [-1, -1], [6, 7], [-1, -1], [-1, -1]]),
        np.array([1.0, 0.0, 2.0, 1.5, 3.0, 4.0, 3.5, 6.0]),
        np.array([[[-1, -1], [0, 5]]]),
    )


def test_a_path_is_the_mean_at_the_root_and_the_steps_below() -> None:
    features = np.array([[0.9, 0.0, 1.0, 3.0], [0.2, 0.0, 1.0, 2.0]], dtype=np.float32)
    found = path_parts(forests(), np.array([0, 5]), features)
    # Halves of: 1 + 4 at the roots; from 1 to 2 by feature 0 and from 2 to 3 by feature 2; from 4 to 6 by 3.
    np.testing.assert_allclose(found, [[2.5, 0.5, 0.0, 0.5, 1.0], [2.5, -0.5, 0.0, 0.0, -0.25]])


def test_paths_add_up_to_the_means_of_any_forest() -> None:
    rng = np.random.default_rng(0)
    for roots in (np.array([0, 5]), np.array([5, -1, 0]), np.array([-1])):
        features = rng.uniform(0.0, 4.0, (20, 4)).astype(np.float32)
        sums = path_parts(forests(), roots, features).sum(axis=1)
        np.testing.assert_allclose(sums, forest_mean(forests(), roots, features))


def test_counts_and_margins_of_a_condition_are_one_part() -> None:
    learned = Horizon((SCHEMA, PICK_SCHEMA), ((), (Measured(NUMBER), Measured(COUNTED))), forests())
    seen = Measures(np.array([[0.9, 0.0]]), np.array([[0.0, 1.0]]), np.array([3]))
    np.testing.assert_allclose(learned.shares(1, seen, 1), [[2.5, 0.5, 0.5, 1.0]])
    assert learned.shares(0, Measures(np.empty((1, 0)), np.empty((1, 0)), np.array([3])), 1).tolist() == [
        [0.0, 0.0]
    ]


def test_measures_are_told() -> None:
    learned = Horizon((SCHEMA, PICK_SCHEMA), ((), (Measured(NUMBER), Measured(COUNTED))), forests())
    value = QValue(View(SCHEMA, ()), ACTION_TYPES, learned)
    numbers = np.arange(4)
    things = np.array([[0.9], [0.8], [0.1]])
    decision = Decision(things, np.minimum(numbers, 1), numbers[:, None] - 1, numbers, remaining=1)
    assert value.tell(decision, 1, (1, 0))[:2] == ("the thing has location", "0.9")
    assert value.tell(decision, 1, (1, 1))[1:] == ("true", (("", 1),))
    assert value.tell(decision, 3, (1, 1))[1:] == ("off by 0.5", (("", 1),))
    assert value.tell(decision, 1, (1, 2)) == ("the number of objects", "3", ())
    assert sum(part.adds for part in value.parts(decision, 1)) == pytest.approx(value.values(decision)[1])
