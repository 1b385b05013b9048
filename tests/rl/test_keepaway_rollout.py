"""Episodes of keepaway that learners play together."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest

from interpreted import compiled_only
from relforest.forests import Condition
from relforest.forests.statements import Bound, Statement
from relforest.mappings import Mapping
from relforest.playing import Frame
from relforest.rl.fitted.questions import Question as Curve
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.rl.policy import EpsilonGreedyPolicy, GreedyPolicy, Policy, RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.value import ValueFunction, action_schemas
from relforest.trees import Instantiation, Leaf, Question, Tree
from relforest.volumes import Ellipsoid
from relforest.worlds.keepaway import ACTION_TYPES, SCHEMA
from relforest.worlds.keepaway.env import KeepawayEnv
from rl.test_rollout import OneByOne, assert_equal

pytestmark = compiled_only

SEED = np.random.SeedSequence(5)
COLORS = np.array([[0.0, 1.0, 1.0], [1.0, 1.0, 0.0]])


def q_value() -> QValue:
    """Hold unless someone is close; pass to whom nobody is close."""
    view, knots = View(SCHEMA, (("color", COLORS),)), (-3.0, 0.0, 2.0, 5.0, 9.0)
    schemas = view.schemas(ACTION_TYPES)
    distance = Mapping("distance", schemas[0]["location"])

    def curve(last: int, heights: tuple[float, ...]) -> Curve:
        statement = Statement(distance, (last, last + 1), Bound(0, "at most", 4.0))
        return Curve(Condition(1, (statement,)), knots, heights)

    questions = ((curve(0, (1.0, 2.0, 4.0, 6.0, 9.0)),), (curve(1, (-3.0, -1.0, 0.0, 0.5, 1.0)),))
    return QValue(view, ACTION_TYPES, Sum(schemas, 0, (5.0, 0.5), questions))


def tree_value() -> ValueFunction:
    """Pass to whoever has somebody near."""
    schema = action_schemas(SCHEMA, ACTION_TYPES)[1]
    close = Question(
        Mapping("difference", schema["location"]),
        (1, 2),
        Ellipsoid(np.zeros(2), np.eye(2), 6.0, 2, 0.0),
        4,
        5,
        6,
    )
    leaves = (Leaf(0.9, 1, 9), Leaf(0.2, 8, 2), Leaf(0.5, 0, 0))
    tree = Tree(schema, (Instantiation(1), Instantiation(2), Instantiation(3), close, *leaves))
    weights = (np.zeros(1), np.array([0.1, 0.5, -0.5, 0.0]))
    return ValueFunction(SCHEMA, ACTION_TYPES, "bits", ((), (tree,)), weights)


@pytest.mark.parametrize(
    ("policy", "options"),
    [
        (RandomPolicy(), {}),
        (RandomPolicy(), {"max_cycles": 12}),
        (RandomPolicy(), {"keepers": 4, "takers": 3, "size": 25.0}),
        (EpsilonGreedyPolicy(GreedyPolicy(q_value()), 0.2), {}),
        (GreedyPolicy(tree_value()), {}),
    ],
)
def test_the_experience_is_the_same(policy: Policy, options: dict[str, Any]) -> None:
    expected = rollout(KeepawayEnv(**options), OneByOne(policy), 6, SEED)
    assert_equal(rollout(KeepawayEnv(**options), policy, 6, SEED), expected)
    assert_equal(rollout(KeepawayEnv(**options), policy, 6, SEED, n_jobs=2), expected)
    assert expected.truncated.any() == ("max_cycles" in options)
    wrapped = gymnasium.make("relforest/Keepaway-v0", **options)
    assert_equal(rollout(wrapped, policy, 6, SEED), expected)
    recorded = gymnasium.wrappers.RecordEpisodeStatistics(wrapped)
    assert_equal(rollout(recorded, policy, 6, SEED), expected)
    assert len(recorded.return_queue) == 6


def test_a_discount_of_ones_own_counts() -> None:
    env = KeepawayEnv()
    vars(env)["discount"] = 1.0
    found = rollout(env, RandomPolicy(), 3, SEED)
    np.testing.assert_array_equal(found.rewards, found.durations)


def test_somebody_who_watches_sees_every_game() -> None:
    env = KeepawayEnv()
    seen: list[Frame] = []
    env.watch(seen.append)
    found = rollout(env, RandomPolicy(), 2, SEED)
    assert len(seen) > found.durations.sum()
