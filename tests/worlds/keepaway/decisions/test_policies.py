from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.policies import (
    HandCodedPolicy,
    HoldPolicy,
    RandomPolicy,
    decision_variables,
    hand_coded,
)
from relforest.worlds.keepaway.decisions.scene import NOBODY, decision, location_of, objects
from relforest.worlds.keepaway.decisions.variables import n_variables, state_variables


def described(near: float, to_taker: tuple[float, ...], angle: tuple[float, ...]) -> NDArray[np.float64]:
    """Variables of 3 against 2 or 4 against 3 with those that the hand-coded policy reads; the rest is 7."""
    keepers = len(angle) + 1
    variables = np.full(n_variables(keepers, keepers - 1), 7.0)
    variables[keepers] = near
    variables[-2 * len(angle) :] = (*to_taker, *angle)
    return variables


@pytest.mark.parametrize(
    ("near", "to_taker", "angle", "action"),
    [
        (5.01, (20.0, 20.0), (180.0, 180.0), 0),  # no taker within 5 m: hold, however open the others are
        (5.0, (20.0, 20.0), (180.0, 180.0), 1),  # 5 m exactly is close; both score 80 + 180: the first
        (3.0, (10.0, 5.0), (50.0, 71.0), 2),  # hold 90, K2 40 + 50 = 90, K3 20 + 71 = 91
        (3.0, (10.0, 5.0), (50.0, 70.0), 0),  # both score 90, no more than holding
        (3.0, (5.0, 4.0), (100.0, 104.0), 1),  # both score 120: the first
    ],
)
def test_hand_coded_three_against_two(
    near: float, to_taker: tuple[float, ...], angle: tuple[float, ...], action: int
) -> None:
    assert hand_coded(described(near, to_taker, angle), 3, 2) == action


def test_hand_coded_four_against_three() -> None:
    # Scores: hold 90, K2 4 + 80 = 84, K3 16 + 90 = 106, K4 40 + 70 = 110.
    assert hand_coded(described(4.0, (1.0, 4.0, 10.0), (80.0, 90.0, 70.0)), 4, 3) == 3


def state(actor: int) -> Decision:
    """Keeper 1 at (0, 0) is pressed from the right; keeper 0 is free on the left, keeper 2 is covered."""
    matrix = objects(3, 2)
    location_of(matrix)[:] = [(-8.0, 0.0), (0.0, 0.0), (7.0, 1.0), (2.0, 0.0), (6.0, 0.0)]
    receivers = [i for i in (2, 1, 0) if i != actor]
    return decision(matrix, actor, np.array(receivers))


def test_the_hand_coded_policy_passes_to_the_open_teammate() -> None:
    # Actions: 0 hold, 1 pass to keeper 2, 2 pass to keeper 0.
    assert HandCodedPolicy().choose(state(1), np.random.default_rng(0)) == 2


def test_the_hand_coded_policy_holds_while_nobody_is_near() -> None:
    # Keeper 0 is 10 m away from the nearest taker.
    assert HandCodedPolicy().choose(state(0), np.random.default_rng(0)) == 0


def test_the_hand_coded_policy_reads_the_action_and_not_its_position() -> None:
    whole = state(1)
    reversed_ = Decision(whole.objects, whole.types[::-1], whole.arguments[::-1], whole.indices[::-1])
    position = HandCodedPolicy().choose(reversed_, np.random.default_rng(0))
    assert reversed_.action(position).arguments == (1, 0)


def test_decision_variables_have_the_holder_as_k1() -> None:
    found = decision_variables(state(2))
    expected = np.empty(13)
    players = location_of(state(2).objects).copy()
    state_variables(players, players[2], 3, expected)
    assert found.tolist() == expected.tolist()
    # Keeper 2 at (7, 1): sqrt(50) from the centre, and as far from keeper 1, who is there.
    assert found[:2] == pytest.approx([50**0.5, 50**0.5])


def test_nobody_decides_at_the_end() -> None:
    over = decision(objects(3, 2), NOBODY, np.zeros(2, dtype=np.int64))
    for policy in (HandCodedPolicy(), HoldPolicy(), RandomPolicy()):
        with pytest.raises(InputError, match="offers no action: the episode has ended"):
            policy.choose(over, np.random.default_rng(0))


def test_the_hold_policy_holds() -> None:
    whole = state(1)
    assert HoldPolicy().choose(whole, np.random.default_rng(0)) == 0
    reversed_ = Decision(whole.objects, whole.types[::-1], whole.arguments[::-1], whole.indices[::-1])
    assert HoldPolicy().choose(reversed_, np.random.default_rng(0)) == 2


def test_the_random_policy_is_uniform() -> None:
    rng = np.random.default_rng(0)
    counts = np.bincount([RandomPolicy().choose(state(1), rng) for _ in range(3000)])
    # 1000 each; standard deviation sqrt(3000 * 2 / 9) = 26.
    assert np.abs(counts - 1000).max() < 4 * 26
