from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from relforest.rl.experience import Experience, concatenate
from relforest.rl.fitted.evidence import Evidence, check_values
from relforest.rl.fitted.returns import returns
from relforest.rl.fitted.view import View
from relforest.support.errors import InputError
from rl.small_worlds import ACTION_TYPES, PICK, SCHEMA, WAIT, two_episodes


def evidence(*batches: Experience) -> Evidence:
    view = View(SCHEMA, ())
    return Evidence.of(batches or (two_episodes(),), view, view.schemas(ACTION_TYPES), 0.5)


def test_waiting_is_offered_once_in_every_state() -> None:
    found = evidence()
    assert found.base_type() == WAIT
    # States 0, 1, 2, 3, 4 offer it as candidates 0, 3, 5, 6, 8.
    assert found.base_of(WAIT).tolist() == [0, 3, 5, 6, 8]


def test_an_action_that_is_offered_twice_is_no_base() -> None:
    batch = two_episodes()
    assert evidence(replace(batch, types=np.full(10, PICK))).base_type() is None


def test_every_transition_tells_about_the_base_and_about_the_action_taken() -> None:
    found = evidence()
    # Picked in states 0 and 1: candidates 1 and 4, the first and the third that pick (1, 2, 4, 7, 9).
    assert [each.tolist() for each in found.examples(PICK, is_base=False)] == [[0, 1], [0, 2]]
    assert [each.tolist() for each in found.examples(WAIT, is_base=True)] == [[0, 1, 2], [0, 1, 3]]


def test_nothing_follows_a_terminal_state_but_a_time_limit_hides_what_does() -> None:
    found = evidence()
    assert found.discounts.tolist() == [0.25, 0.0, 0.5]
    assert found.follows.tolist() == [True, False, False]
    joined = evidence(two_episodes(), two_episodes())
    assert joined.follows.tolist() == [True, False, False] * 2


def test_targets_worked_by_hand() -> None:
    found = evidence()
    values = np.array([0.0, 2.0, 1.0, 0.5, 4.0, 9.0, 0.0, 0.0, 3.0, 1.0])
    # Transition 0: picking in state 1 is greedy (4.0), so with lambda 1 its own return, 0, follows.
    assert found.targets(values, 1.0).tolist() == [0.5 + 0.25 * 0.0, 0.0, 0.5 * 3.0]
    assert found.targets(values, 0.0).tolist() == [0.5 + 0.25 * 4.0, 0.0, 1.5]
    assert found.targets(values, 0.5).tolist() == [0.5 + 0.25 * 2.0, 0.0, 1.5]
    # Action 4 is best in state 1, action 8 in state 4; others say what they are worth.
    judged = np.arange(10.0)
    assert found.targets(values, 0.0, judged).tolist() == [0.5 + 0.25 * 4.0, 0.0, 0.5 * 8.0]
    values[3] = 5.0  # now it is not
    assert found.targets(values, 1.0).tolist() == [0.5 + 0.25 * 5.0, 0.0, 1.5]


def test_returns_agree_with_the_sum_of_rewards() -> None:
    rng = np.random.default_rng(1)
    rewards, ends = rng.normal(size=12), np.isin(np.arange(12), [4, 11])
    discounts = np.where(ends, 0.0, 0.9)
    out = np.empty(12)
    returns(rewards, discounts, np.zeros(12), ~ends, 1.0, out)
    expected = [sum(0.9 ** (j - i) * rewards[j] for j in range(i, 5 if i < 5 else 12)) for i in range(12)]
    np.testing.assert_allclose(out, expected)


def test_best_and_mean_values_of_states() -> None:
    found, values = evidence(), np.arange(10.0)
    assert found.best(values).tolist() == [2.0, 4.0, 5.0, 7.0, 9.0]
    assert found.mean(values).tolist() == [1.0, 3.5, 5.0, 6.5, 8.5]


def test_values_beyond_what_rewards_allow_are_an_error() -> None:
    found = evidence()
    # A reward of 0.5 for two units of time at a discount of .5: 0.5 / (1 - .25).
    assert found.largest_value == pytest.approx(2 / 3)
    check_values(np.array([0.6, -0.6]), found)
    for values in ([5.0], [np.nan]):
        with pytest.raises(InputError, match="learning diverges"):
            check_values(np.array(values), found)
    with pytest.raises(InputError, match="diverges"):
        check_values(np.ones(3), evidence(replace(two_episodes(), rewards=np.zeros(3))))


def test_batches_are_joined_in_order() -> None:
    assert len(evidence(two_episodes(), two_episodes()).taken) == len(concatenate([two_episodes()] * 2))
