from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from relforest.rl.baselines import (
    DenseFeatures,
    FeatureMap,
    Features,
    SarsaLambda,
    SarsaSettings,
    TileCoding,
)
from relforest.rl.baselines.settings import Traces
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError
from rl.baselines.plain_sarsa import PlainSarsa


def table(n_states: int, n_actions: int) -> DenseFeatures[int]:
    """One weight per state and action, so that weights are action values."""

    def rows(state: int) -> FloatArray:
        return np.eye(n_states * n_actions)[state * n_actions : (state + 1) * n_actions]

    return DenseFeatures(rows, n_states * n_actions, n_active=1)


def agent_on(
    view: FeatureMap[Any], weights: list[float] | None = None, *, seed: int = 0, **options: Any
) -> SarsaLambda[Any]:
    begin = None if weights is None else np.array(weights)
    return SarsaLambda(view, SarsaSettings(**({"epsilon": 0.0} | options)), weights=begin, random_state=seed)


def test_an_update_on_tiles_worked_by_hand() -> None:
    # One variable, 2 tilings of width 1, 1 action: each of 2 active tiles gets alpha / 2 = 0.25 of the error.
    agent = agent_on(TileCoding([1.0], 1, tilings=2, upper=2.0), alpha=0.5)
    assert agent.start([0.0]) == 0  # tiles 0, 1
    assert agent.step(4.0, 1.0, [0.5]) == 0  # error 4 + 0 - 0; now tiles 1, 2
    assert agent.weights.tolist() == [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    agent.step(2.0, 1.0, [2.0])  # error 2 + 0 - (1 + 0) = 1; now tiles 4, 5
    assert agent.weights.tolist() == [1.0, 1.25, 0.25, 0.0, 0.0, 0.0]
    agent.end(8.0)  # error 8 - 0
    assert agent.weights.tolist() == [1.0, 1.25, 0.25, 0.0, 2.0, 2.0]
    assert agent.values([0.5]).tolist() == [1.5]


def test_the_next_action_is_chosen_before_the_update() -> None:
    agent = agent_on(table(1, 2), [1.0, 0.9], alpha=0.5)
    assert agent.start(0) == 0
    # Q is (1, .9) still, so action 0 again; error -2 + 1 - 1 = -2, and 1 - .5 * 2 = 0.
    assert agent.step(-2.0, 1.0, 0) == 0
    assert agent.weights.tolist() == [0.0, 0.9]
    # Now action 1 is best; error 0 + .9 - 0, and 0 + .5 * .9 = .45.
    assert agent.step(0.0, 1.0, 0) == 1
    np.testing.assert_allclose(agent.weights, [0.45, 0.9])


def test_the_discount_counts_the_duration() -> None:
    agent = agent_on(table(2, 1), [2.0, 8.0], alpha=1.0, gamma=0.5)
    agent.start(0)
    agent.step(3.0, 2.0, 1)  # 3 + .5**2 * 8 = 5
    assert agent.weights.tolist() == [5.0, 8.0]
    agent.step(1.0, 0.0, 0)  # 1 + .5**0 * 5 = 6
    assert agent.weights.tolist() == [5.0, 6.0]


def test_traces_credit_earlier_decisions() -> None:
    agent = agent_on(table(3, 1), alpha=0.5, gamma=0.8, trace_decay=0.5)
    agent.start(0)
    agent.step(1.0, 1.0, 1)  # error 1: w0 = .5; its trace is .8 * .5 = .4 now
    agent.step(0.0, 2.0, 2)  # error 0; traces: w0 .4 * .64 * .5 = .128, w1 .32
    agent.end(2.0)  # error 2, step 1: w0 = .5 + .128, w1 = .32, w2 = 1
    np.testing.assert_allclose(agent.weights, [0.628, 0.32, 1.0])


@pytest.mark.parametrize(("traces", "expected"), [("replacing", 1.0), ("accumulating", 1.5)])
def test_traces_of_a_feature_that_is_active_again(traces: Traces, expected: float) -> None:
    agent = agent_on(table(1, 1), alpha=1.0, trace_decay=0.5, traces=traces)
    agent.start(0)
    agent.step(0.0, 1.0, 0)  # the trace was 1, is .5, and is set to 1 or raised by 1
    agent.end(1.0)
    assert agent.weights.tolist() == [expected]


@pytest.mark.parametrize(("traces", "expected"), [("replacing", [0.0, 1.0]), ("accumulating", [0.5, 1.0])])
def test_replacing_traces_forget_the_other_actions(traces: Traces, expected: list[float]) -> None:
    agent = agent_on(table(1, 2), [1.0, 0.0], alpha=1.0, trace_decay=0.5, traces=traces)
    assert agent.start(0) == 0
    agent.weights[:] = [0.0, 5.0]
    assert agent.step(-5.0, 1.0, 0) == 1  # error -5 + 5 - 0 = 0; the trace of action 0 is .5, or gone
    agent.weights[:] = 0.0
    agent.end(1.0)
    assert agent.weights.tolist() == expected


def test_small_traces_are_dropped() -> None:
    agent = agent_on(table(3, 1), alpha=1.0, trace_decay=0.1, min_trace=0.05)
    agent.start(0)
    agent.step(0.0, 1.0, 1)
    agent.step(0.0, 1.0, 2)  # traces .01, .1, 1
    agent.end(1.0)
    np.testing.assert_allclose(agent.weights, [0.0, 0.1, 1.0])


def test_an_episode_leaves_no_traces_to_the_next() -> None:
    agent = agent_on(table(2, 1), alpha=1.0, trace_decay=1.0)
    agent.start(0)
    agent.end(1.0)
    agent.start(1)
    agent.end(1.0)
    assert agent.weights.tolist() == [1.0, 1.0]
    # Nor does one that is left unfinished.
    agent.start(0)
    agent.start(1)
    agent.end(2.0)
    assert agent.weights.tolist() == [1.0, 2.0]


def random_rows(rng: np.random.Generator, n_features: int) -> FloatArray:
    rows = rng.normal(size=(rng.integers(1, 5), n_features))
    rows[rng.random(rows.shape) < 0.6] = 0.0
    return rows


@pytest.mark.parametrize("trace_decay", [0.0, 0.9, 1.0])
@pytest.mark.parametrize("traces", ["replacing", "accumulating"])
@pytest.mark.parametrize("min_trace", [0.0, 0.1])
def test_it_agrees_with_a_plain_version(trace_decay: float, traces: Traces, min_trace: float) -> None:
    settings = SarsaSettings(0.3, 0.95, 0.2, trace_decay, traces, min_trace)
    view: DenseFeatures[FloatArray] = DenseFeatures(lambda rows: rows, 12, n_active=5)
    agent, plain = SarsaLambda(view, settings, random_state=3), PlainSarsa(5, settings, 3)
    rng = np.random.default_rng(8)
    for _ in range(12):
        rows = random_rows(rng, 12)
        assert agent.start(rows) == plain.start(rows)
        for _ in range(rng.integers(0, 12)):
            rows, reward, duration = random_rows(rng, 12), rng.normal(), float(rng.integers(0, 4))
            assert agent.step(reward, duration, rows) == plain.step(reward, duration, rows)
        reward = rng.normal()
        agent.end(reward)
        plain.end(reward)
    expected = [plain.weights.get(feature, 0.0) for feature in range(12)]
    assert np.abs(expected).max() > 0.01
    np.testing.assert_allclose(agent.weights, expected, rtol=1e-9, atol=1e-12)


def test_it_agrees_with_a_plain_version_on_tiles() -> None:
    tiles = TileCoding([2.0, 3.0], 3, tilings=4, upper=6.0)
    settings = SarsaSettings(epsilon=0.1, trace_decay=0.7)
    agent, plain = SarsaLambda(tiles, settings, random_state=1), PlainSarsa(8, settings, 1)

    def rows(observation: FloatArray) -> FloatArray:
        dense = np.zeros((3, tiles.n_features))
        np.put_along_axis(dense, tiles.features(observation).indices, 1.0, axis=1)
        return dense

    rng = np.random.default_rng(2)
    observations = rng.uniform(0, 6, (30, 2))
    assert agent.start(observations[0]) == plain.start(rows(observations[0]))
    for observation in observations[1:]:
        assert agent.step(1.0, 1.0, observation) == plain.step(1.0, 1.0, rows(observation))
    agent.end(1.0)
    plain.end(1.0)
    expected = [plain.weights.get(feature, 0.0) for feature in range(tiles.n_features)]
    np.testing.assert_allclose(agent.weights, expected, rtol=1e-9, atol=1e-12)


def two_states(agent: SarsaLambda[int], episodes: int) -> None:
    """State 0: end with 1, or go to state 1 in 2 units of time. State 1: end with 4, or with 0."""
    for _ in range(episodes):
        if agent.start(0) == 0:
            agent.end(1.0)
        else:
            agent.end(4.0 if agent.step(0.0, 2.0, 1) == 0 else 0.0)


@pytest.mark.parametrize("trace_decay", [0.0, 0.5])
def test_it_finds_the_values_of_the_best_policy(trace_decay: float) -> None:
    agent = agent_on(table(2, 2), [9.0] * 4, alpha=0.5, gamma=0.8, trace_decay=trace_decay)
    two_states(agent, 150)
    # Q(1, .) = (4, 0) and Q(0, 1) = .8**2 * 4 = 2.56 > 1. Others are tried while they look better.
    np.testing.assert_allclose(agent.values(0)[1], 2.56, rtol=1e-6)
    np.testing.assert_allclose(agent.values(1)[0], 4.0, rtol=1e-6)
    assert 1.0 <= agent.values(0)[0] < 2.56


def test_it_finds_the_values_of_the_policy_it_follows() -> None:
    agent = agent_on(table(2, 2), alpha=0.02, gamma=0.8, epsilon=1.0)
    two_states(agent, 1500)
    # Acting at random, state 1 is worth (4 + 0) / 2 = 2, so Q(0, 1) = .64 * 2 = 1.28; it follows the last
    # 1 / alpha = 50 samples of Q(1, a') in {4, 0}, with deviation .64 * 2 * sqrt(.02 / 1.98) = .13.
    np.testing.assert_allclose(agent.values(0), [1.0, 1.28], atol=0.4)
    np.testing.assert_allclose(agent.values(1), [4.0, 0.0], atol=0.01)


def test_an_agent_that_knows_nothing_acts_at_random() -> None:
    agent = agent_on(table(1, 3))
    chosen = np.bincount([agent.start(0) for _ in range(600)], minlength=3)
    # Binomial(600, 1/3): standard deviation 11.5.
    assert (np.abs(chosen - 200) <= 46).all()


def test_exploration_is_uniform() -> None:
    agent = agent_on(table(1, 3), [0.0, 1.0, 0.0], epsilon=0.3)
    chosen = np.bincount([agent.start(0) for _ in range(1000)], minlength=3)
    # Each of the others with 0.3 / 3: mean 100, standard deviation 9.5.
    assert abs(chosen[0] - 100) <= 38
    assert abs(chosen[2] - 100) <= 38


def actions_and_weights(seed: int) -> tuple[list[int], FloatArray]:
    agent = agent_on(TileCoding([1.0, 1.0], 3, tilings=4), seed=seed, epsilon=0.3)
    observations = np.random.default_rng(0).uniform(0, 5, (40, 2))
    actions = [agent.start(observations[0])]
    actions += [agent.step(1.0, 1.0, observation) for observation in observations[1:]]
    return actions, agent.weights


def test_a_seed_fixes_everything() -> None:
    once, again, other = actions_and_weights(5), actions_and_weights(5), actions_and_weights(6)
    assert once[0] == again[0]
    assert once[1].tobytes() == again[1].tobytes()
    assert once[0] != other[0]


def test_a_frozen_agent_acts_greedily_and_learns_nothing() -> None:
    weights = np.array([1.0, 3.0])
    agent = SarsaLambda(table(1, 2), SarsaSettings(epsilon=1.0), weights=weights, learn=False, random_state=0)
    assert agent.start(0) == 1
    assert {agent.step(-50.0, 1.0, 0) for _ in range(20)} == {1}
    agent.end(-50.0)
    assert weights.tolist() == [1.0, 3.0]


def test_a_greedy_question_leaves_the_episode_alone() -> None:
    agent = agent_on(table(2, 2), [0.0, 1.0, 3.0, 3.0], alpha=0.5)
    assert agent.start(0) == 1
    rng = np.random.default_rng(0)
    assert {agent.greedy(1, rng) for _ in range(30)} == {0, 1}
    agent.end(3.0)  # still of state 0 and action 1: error 3 - 1
    assert agent.weights.tolist() == [0.0, 2.0, 3.0, 3.0]


def test_divergence_says_what_to_do_and_spoils_nothing() -> None:
    view: DenseFeatures[None] = DenseFeatures(lambda _: [[1.0, 1.0]], 2, n_active=1)
    agent = agent_on(view, alpha=50.0)
    agent.start(None)

    def go_on() -> None:
        for _ in range(200):
            agent.step(1.0, 1.0, None)
            agent.start(None)
            agent.end(1.0)
            agent.start(None)

    with pytest.raises(InputError, match=r"learning diverges.*lower alpha \(now 50\)"):
        go_on()
    assert np.isfinite(agent.weights).all()


@pytest.mark.parametrize(
    # Weights that another agent spoiled, and an error of 1e100 + 9e99.
    ("weight", "reward"),
    [(float("nan"), 1.0), (1e101, 1.0), (-9e99, 1e100)],
)
def test_divergence_is_noticed_before_anything_changes(weight: float, reward: float) -> None:
    agent = agent_on(table(2, 1))
    agent.start(0)
    agent.weights[0] = weight
    for act in (lambda: agent.step(reward, 1.0, 1), lambda: agent.end(reward)):
        with pytest.raises(InputError, match="learning diverges"):
            act()
    np.testing.assert_array_equal(agent.weights, [weight, 0.0])


@pytest.mark.parametrize("reward", [float("nan"), float("inf"), 1e101, None, "1", 1j])
def test_bad_rewards_are_refused(reward: Any) -> None:
    agent = agent_on(table(1, 1), alpha=1.0)
    agent.start(0)
    with pytest.raises(InputError, match="reward must be a number"):
        agent.step(reward, 1.0, 0)
    with pytest.raises(InputError, match="reward must be a number"):
        agent.end(reward)
    agent.end(1.0)
    assert agent.weights.tolist() == [1.0]


@pytest.mark.parametrize("duration", [-1.0, float("nan"), float("inf"), None])
def test_bad_durations_are_refused(duration: Any) -> None:
    agent = agent_on(table(1, 1))
    agent.start(0)
    with pytest.raises(InputError, match="duration must be a number of at least 0"):
        agent.step(1.0, duration, 0)
    assert agent.weights.tolist() == [0.0]


@pytest.mark.parametrize("act", [lambda agent: agent.step(1.0, 1.0, 0), lambda agent: agent.end(1.0)])
def test_an_episode_must_be_started(act: Callable[[SarsaLambda[int]], Any]) -> None:
    agent = agent_on(table(1, 1))
    with pytest.raises(InputError, match="call start"):
        act(agent)
    agent.start(0)
    agent.end(1.0)
    with pytest.raises(InputError, match="call start"):
        act(agent)


class Broken:
    """A feature map that does not keep its word."""

    n_features = 4
    n_active = 1

    def __init__(self, indices: Any, values: Any) -> None:
        self.arrays = Features(np.array(indices), np.array(values))

    def features(self, _observation: object, /) -> Features:
        return self.arrays

    def to_dict(self) -> dict[str, Any]:
        return {"kind": "broken"}


@pytest.mark.parametrize(
    ("indices", "values", "message"),
    [
        ([[4]], [[1.0]], "index outside 0 to 3"),
        ([[0], [-1]], [[1.0], [1.0]], "index outside 0 to 3"),
        ([[0]], [[float("nan")]], "a feature is not finite"),
        ([[0, 1]], [[1.0]], r"one shape.*int64 \(1, 2\) and float64 \(1, 1\)"),
        ([0], [1.0], "one shape"),
        ([[0]], [[1]], "float64 values"),
        ([[0.0]], [[1.0]], "int64 indices"),
        (np.empty((0, 2), np.int64), np.empty((0, 2)), "at least one action"),
    ],
)
def test_broken_feature_maps_are_noticed(indices: Any, values: Any, message: str) -> None:
    agent = agent_on(Broken(indices, values))
    for act in (agent.start, agent.values):
        with pytest.raises(InputError, match=message):
            act(0)
    with pytest.raises(InputError, match=message):
        agent.greedy(0, np.random.default_rng(0))


@pytest.mark.parametrize(
    "weights",
    [
        [0.0, 0.0],
        np.zeros(3),
        np.zeros((2, 1)),
        np.zeros(2, np.float32),
        np.zeros(4)[::2],
        np.broadcast_to(0.0, 2),
    ],
)
def test_weights_of_another_kind_are_refused(weights: Any) -> None:
    with pytest.raises(InputError, match="contiguous array of 2 float64"):
        SarsaLambda(table(2, 1), weights=weights)


@pytest.mark.parametrize("bad", [float("nan"), float("-inf"), 1e101])
def test_weights_must_be_finite(bad: float) -> None:
    with pytest.raises(InputError, match="weights must be finite"):
        SarsaLambda(table(2, 1), weights=np.array([0.0, bad]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"settings": {"alpha": 0.1}}, "settings must be SarsaSettings"),
        ({"learn": 1}, "learn must be True or False"),
        ({"random_state": -1}, "random_state must be"),
    ],
)
def test_bad_options_of_an_agent_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        SarsaLambda(table(1, 1), **options)
