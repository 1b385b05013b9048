from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from sklearn.ensemble import ExtraTreesRegressor

from experiments.run_folders import contents
from interpreted import compiled_only
from relforest.reports.run_report import run_report
from relforest.rl.fitted import CurveSettings, ForestSettings, QLearner, QSettings
from relforest.rl.fitted.forest_arrays import forest_mean, forests_of, joined, pruned, together
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.learner import QKnowledge, portions
from relforest.rl.fitted.policy_json import describe
from relforest.rl.fitted.sum import Sum
from relforest.rl.policy import GreedyPolicy, RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.saved_policy import read_policy
from relforest.runs.learner import advance
from relforest.runs.store import RunStore
from relforest.smdp import Decisions
from relforest.support.errors import InputError, ModelFormatError
from rl.small_worlds import Limited, Picking
from rl.test_explaining import check_sums

pytestmark = compiled_only

SETTINGS = QSettings(
    curves=CurveSettings(rounds=2, candidates=20, min_scenes=5, ridge=1.0),
    forests=ForestSettings(counts=10, trees=5),
)


def learner(env: gymnasium.Env[Any, Any], seed: int = 0) -> QLearner:
    return QLearner(env, SETTINGS, np.random.SeedSequence(seed), 30, 10)


def learned(env: gymnasium.Env[Any, Any], iterations: int = 2) -> QKnowledge:
    found = learner(env)
    state = found.start()
    for number in range(1, iterations + 1):
        state = found.iterate(state, number)
    return state


@pytest.mark.parametrize(("world", "made_of"), [(Picking, Sum), (Limited, Horizon)])
def test_it_learns_which_things_are_worth_picking(world: type[Picking], made_of: type[object]) -> None:
    state = learned(world(things=6))
    assert state.value is not None
    assert isinstance(state.value.learned, made_of)
    played = rollout(world(things=6), GreedyPolicy(state.value), 40, np.random.SeedSequence(9))
    # Half of six things are worth 1 each; at random, a pick earns half of that.
    assert played.episode_rewards.mean() > 2.3
    more = rollout(world(things=12), GreedyPolicy(state.value), 40, np.random.SeedSequence(9))
    assert more.episode_rewards.mean() > 3.0


@pytest.mark.parametrize("world", [Picking, Limited])
def test_values_do_not_depend_on_the_order_of_objects(world: type[Picking]) -> None:
    state = learned(world(things=4), 1)
    env = world(things=4)
    env.reset(seed=5)
    decision = env.decision()
    order = np.array([2, 0, 3, 1])
    back = np.argsort(order)
    arguments = np.where(decision.arguments < 0, -1, back[decision.arguments])
    turned = replace(decision, objects=decision.objects[order], arguments=arguments)
    assert state.value is not None
    np.testing.assert_allclose(state.value.values(turned), state.value.values(decision))


def test_states_with_other_numbers_of_remaining_actions_can_be_valued_together() -> None:
    value, env, rng = learned(Limited(things=6), 1).value, Limited(things=6), np.random.default_rng(0)
    assert value is not None
    seen = []
    for seed in range(8):
        env.reset(seed=seed)
        for _ in range(seed % 4):
            env.step(env.decision().indices[RandomPolicy().choose(env.decision(), rng)])
        seen.append(env.decision())
    assert {each.remaining for each in seen} == {1, 2, 3, 4}
    found = value.values_all(Decisions.of(seen))
    np.testing.assert_array_equal(found, np.concatenate([value.values(each) for each in seen]))


@pytest.mark.parametrize("world", [Picking, Limited])
def test_the_parts_of_values_add_up(world: type[Picking]) -> None:
    value, env = learned(world(things=4), 1).value, world(things=4)
    assert value is not None
    for seed in range(5):
        env.reset(seed=seed)
        check_sums(value, env.decision())


@pytest.mark.parametrize("world", [Picking, Limited])
def test_an_interrupted_run_ends_with_the_same_bytes(world: type[Picking], tmp_path: Path) -> None:
    found = learner(world(things=3))
    whole, parts = RunStore(tmp_path / "whole", found), RunStore(tmp_path / "parts", found)
    run = None
    for _ in range(3):
        run, _ = advance(found, run)
        whole.write(run)
        again, _ = advance(found, parts.resume())
        parts.write(again)
    assert contents(tmp_path / "whole") == contents(tmp_path / "parts")
    assert "iteration" in run_report(tmp_path / "whole")


@pytest.mark.parametrize("world", [Picking, Limited])
def test_a_saved_policy_has_the_same_values(world: type[Picking], tmp_path: Path) -> None:
    found = learner(world(things=3))
    run, _ = advance(found, advance(found, None)[0])
    RunStore(tmp_path, found).write(run)
    value, env = read_policy(tmp_path), world(things=5)
    env.reset(seed=1)
    assert run.state.value is not None
    np.testing.assert_array_equal(value.values(env.decision()), run.state.value.values(env.decision()))


def test_the_policy_of_a_run_that_has_not_learned_is_an_error(tmp_path: Path) -> None:
    found = learner(Picking())
    RunStore(tmp_path, found).write(advance(found, None)[0])
    with pytest.raises(InputError, match="has not learned anything yet"):
        read_policy(tmp_path)


@pytest.mark.parametrize("world", [Picking, Limited])
def test_threads_do_not_change_what_is_learned(world: type[Picking]) -> None:
    one, two = (
        replace(learner(world(things=4)), n_jobs=n_jobs).iterate(QKnowledge(None, ()), 1) for n_jobs in (1, 2)
    )
    assert one.value is not None
    assert two.value is not None
    assert describe(one.value) == describe(two.value)


def test_it_learns_again_when_there_is_a_share_more() -> None:
    assert list(portions(0, 100, QSettings())) == [25, 25, 25, 25]
    assert list(portions(200, 100, QSettings())) == [50, 50]
    # The last portion takes what would be left over.
    assert list(portions(100, 100, QSettings())) == [25, 31, 44]
    assert list(portions(1000, 100, QSettings())) == [100]
    for episodes in (1, 30, 500):
        assert sum(portions(0, episodes, QSettings())) == episodes


class Generous(Picking):
    """Every action earns the same."""

    def step(self, action: np.int64 | int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        observation, _, terminated, truncated, info = super().step(action)
        return observation, 1.0, terminated, truncated, info | {"discounted_reward": 1.0}


def test_constant_rewards_are_learned_as_a_constant() -> None:
    state = learned(Generous(), 1)
    assert state.value is not None
    env = Generous()
    env.reset(seed=0)
    assert np.isfinite(state.value.values(env.decision())).all()


def test_forests_in_arrays_agree_with_scikit_learn() -> None:
    rng = np.random.default_rng(0)
    features, target = rng.normal(size=(80, 4)).astype(np.float32), rng.normal(size=80)
    model = ExtraTreesRegressor(4, random_state=0).fit(features, target)
    found = joined([[[tree.tree_ for tree in model.estimators_], []]])
    np.testing.assert_allclose(forest_mean(found, found.roots[0, 0], features), model.predict(features))
    assert forest_mean(found, found.roots[0, 1], features).tolist() == [0.0] * 80


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("children", lambda array: array * 0),
        ("feature", lambda array: np.where(array >= 0, 4, array)),
        ("feature", lambda array: array - 5),
        ("value", lambda array: array * np.nan),
        ("threshold", lambda array: array[:-1]),
        ("roots", lambda array: array + 10_000),
        ("roots", lambda array: array.astype(float)),
    ],
)
def test_damaged_forests_are_refused(name: str, change: Any) -> None:
    features = np.random.default_rng(0).normal(size=(30, 4))
    model = ExtraTreesRegressor(2, random_state=0).fit(features, features[:, 0])
    arrays = joined([[[tree.tree_ for tree in model.estimators_]]])._asdict()
    forests_of(arrays, [4], origin="file")
    with pytest.raises(ModelFormatError, match=r"^file: "):
        forests_of(arrays | {name: change(arrays[name])}, [4], origin="file")


def test_trees_of_two_action_types_have_no_node_in_common() -> None:
    features = np.random.default_rng(0).normal(size=(30, 4))
    grown = ExtraTreesRegressor(2, random_state=0).fit(features, features[:, 0]).estimators_
    arrays = joined([[[grown[0].tree_], [grown[1].tree_]]])._asdict()
    forests_of(arrays, [4, 4], origin="file")
    shared = np.repeat(arrays["roots"][:, :1], 2, axis=1)
    below = arrays["roots"].copy()
    below[0, 1, 0] = arrays["children"][0, 1]
    for roots in (shared, below):
        with pytest.raises(ModelFormatError, match=r"^file: its trees are damaged"):
            forests_of(arrays | {"roots": roots}, [4, 4], origin="file")


def test_with_fewer_features_a_comparison_of_another_one_is_answered_by_the_mean() -> None:
    rng = np.random.default_rng(0)
    features, target = rng.normal(size=(60, 3)).astype(np.float32), rng.normal(size=60)
    grown = [
        [tree.tree_ for tree in ExtraTreesRegressor(3, random_state=seed).fit(features, target).estimators_]
        for seed in (0, 1)
    ]
    whole = joined([grown])

    def mean_below(tree: Any, node: int, row: np.ndarray[Any, Any], kept: list[int]) -> float:
        if tree.children_left[node] < 0 or tree.feature[node] not in kept:
            return float(tree.value[node, 0, 0])
        is_first = row[tree.feature[node]] <= tree.threshold[node]
        return mean_below(tree, (tree.children_left if is_first else tree.children_right)[node], row, kept)

    fewer = pruned(whole, [np.array([0, -1, 1]), np.array([-1, -1, -1])])
    for number, kept in enumerate(([0, 2], [])):
        found = forest_mean(fewer, fewer.roots[0, number], np.ascontiguousarray(features[:, kept]))
        expected = [np.mean([mean_below(tree, 0, row, kept) for tree in grown[number]]) for row in features]
        np.testing.assert_allclose(found, expected)


def test_forests_put_together_give_the_mean_of_all_trees() -> None:
    rng = np.random.default_rng(0)
    features, target = rng.normal(size=(60, 3)).astype(np.float32), rng.normal(size=60)
    models = [ExtraTreesRegressor(n, random_state=n).fit(features, target) for n in (2, 3)]
    parts = [joined([[[tree.tree_ for tree in model.estimators_]]]) for model in models]
    # Of the first, one tree only.
    found = together(parts[0]._replace(roots=parts[0].roots[:, :, :1]), parts[1])
    expected = (models[0].estimators_[0].predict(features) + 3 * models[1].predict(features)) / 4
    np.testing.assert_allclose(forest_mean(found, found.roots[0, 0], features), expected)
