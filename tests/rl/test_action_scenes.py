from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.forests.tree_features import width
from relforest.mappings import Mapping
from relforest.rl.action_scenes import action_scenes
from relforest.rl.experience import BoolArray, Experience
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.settings import FEATURE_MODES, FeatureMode
from relforest.rl.value import ValueFunction, forest_features
from relforest.scenes import Scenes
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision
from relforest.trees import Instantiation, Leaf, Question, Tree
from relforest.trees.growth import grow
from rl.small_worlds import (
    LOCATION,
    PICK_SCHEMA,
    REACH_SCHEMA,
    REACHING_TYPES,
    SCHEMA,
    Reaching,
    near,
    two_episodes,
    within,
)

pytestmark = compiled_only

REACH = 1


def reaching(episodes: int = 6, things: int = 3) -> Experience:
    return rollout(Reaching(things), RandomPolicy(), episodes, np.random.SeedSequence(2))


def separate_scenes(experience: Experience, candidates: IntArray) -> Scenes:
    """Build the scene of each reach from copies of its own objects: the things, then the place."""
    matrices, arguments, counts, first = [], [], [], 0
    for candidate in candidates:
        state = np.flatnonzero(experience.candidates <= candidate)[-1]
        low, high = experience.objects[state : state + 2]
        thing, place = experience.arguments[candidate]
        things = experience.matrix[low : high - experience.private[state]]
        matrices.append(np.vstack([things, experience.matrix[low + place]]))
        arguments.append([first + thing, first + len(things)])
        counts.append(len(things) + 1)
        first += counts[-1]
    ends: IntArray = np.cumsum(counts)
    return Scenes(
        REACH_SCHEMA,
        np.concatenate(matrices),
        np.arange(ends[-1]),
        ends - counts,
        np.array(counts),
        np.array(arguments),
    )


def crowded() -> Tree:
    """Ask for another object near the place, and then whether it is near 0.5."""
    first = Question(Mapping("difference", LOCATION), (1, 2), within(0.0, 0.2, keys=9), 4, 5, 6)
    leaves = (Leaf(0.9, 1, 1), Leaf(0.2, 1, 1), Leaf(0.5, 0, 0))
    return Tree(REACH_SCHEMA, (Instantiation(1), Instantiation(2), Instantiation(3), first, *leaves))


def test_scenes_of_actions_share_the_objects_of_their_state() -> None:
    experience = two_episodes()
    # Candidates 1 and 2 pick the two things of state 0 (rows 0, 1), candidate 9 the thing of state 4 (row 4).
    scenes = action_scenes(experience, np.array([1, 2, 9]), PICK_SCHEMA)
    assert scenes.counts.tolist() == [2, 2, 1]
    assert [scenes.objects(i).tolist() for i in range(3)] == [[0, 1], [0, 1], [4]]
    assert scenes.arguments.tolist() == [[0], [1], [4]]
    assert scenes.matrix.base is experience.matrix.base or np.shares_memory(scenes.matrix, experience.matrix)


def test_scenes_of_actions_without_arguments_and_without_objects() -> None:
    # Candidate 5 waits in the empty terminal state.
    scenes = action_scenes(two_episodes(), np.array([5, 6]), SCHEMA)
    assert scenes.counts.tolist() == [0, 1]
    assert scenes.arguments.shape == (2, 0)


def test_private_objects_are_in_the_scenes_of_those_who_bind_them() -> None:
    # The second thing of state 0 is private: picking the first does not show it, and neither does waiting.
    experience = replace(two_episodes(), private=np.array([1, 0, 0, 0, 1]))
    picks = action_scenes(experience, np.array([1, 2, 4, 9]), PICK_SCHEMA)
    assert [picks.objects(i).tolist() for i in range(4)] == [[0], [0, 1], [2], [4]]
    assert picks.arguments.tolist() == [[0], [1], [2], [4]]
    waits = action_scenes(experience, np.array([0, 3, 8]), SCHEMA)
    assert [waits.objects(i).tolist() for i in range(3)] == [[0], [2], []]
    assert np.shares_memory(picks.matrix, experience.matrix)


def test_an_object_that_is_bound_twice_is_in_the_scene_once() -> None:
    experience = replace(reaching(episodes=1, things=1), arguments=np.tile([[2, 2]], (3 * 4, 1)))
    # One thing and two places in each of four states; both parameters are bound to the second place.
    scenes = action_scenes(experience, np.array([1, 4]), REACH_SCHEMA)
    assert [scenes.objects(i).tolist() for i in range(2)] == [[0, 2], [3, 5]]
    assert scenes.arguments.tolist() == [[2, 2], [5, 5]]


def test_learning_from_private_objects_is_learning_from_scenes_built_one_by_one() -> None:
    experience = reaching(episodes=12)
    reaches = np.flatnonzero(experience.types == REACH)[::3]
    together, apart = action_scenes(experience, reaches, REACH_SCHEMA), separate_scenes(experience, reaches)
    np.testing.assert_array_equal(together.counts, apart.counts)
    np.testing.assert_array_equal(together.matrix[together.rows], apart.matrix)
    # Worth 1: a thing other than the one that moves within 0.1 of the place.
    things, places = apart.matrix.reshape(-1, 4)[:, :3], apart.matrix[apart.arguments[:, 1]]
    is_near = np.abs(things - places) < 0.1
    is_near[np.arange(len(is_near)), apart.arguments[:, 0] % 4] = False
    labels: BoolArray = np.any(is_near, axis=1)
    grown = [grow(scenes, labels, rng=np.random.default_rng(0)).tree for scenes in (together, apart)]
    assert grown[0].n_leaves > 1
    assert grown[0].to_dict() == grown[1].to_dict()


@pytest.mark.parametrize("mode", FEATURE_MODES)
def test_the_value_of_an_action_is_that_of_its_own_scene(mode: FeatureMode) -> None:
    experience = reaching()
    forests = ((near(SCHEMA),), (crowded(), near(REACH_SCHEMA)))
    rng = np.random.default_rng(0)
    weights = [rng.standard_normal(1 + sum(width(tree, mode) for tree in trees)) for trees in forests]
    value = ValueFunction(SCHEMA, REACHING_TYPES, mode, forests, tuple(weights))
    for state in range(experience.n_states):
        objects = slice(*experience.objects[state : state + 2])
        candidates = slice(*experience.candidates[state : state + 2])
        offered = Decision(
            experience.matrix[objects],
            experience.types[candidates],
            experience.arguments[candidates],
            np.arange(candidates.stop - candidates.start),
            n_private=int(experience.private[state]),
        )
        reaches = np.arange(candidates.start + 1, candidates.stop)
        scenes = separate_scenes(experience, reaches)
        expected = forest_features(forests[REACH], scenes, mode) @ weights[REACH]
        np.testing.assert_allclose(value.values(offered)[1:], expected, rtol=1e-12, atol=1e-12)
