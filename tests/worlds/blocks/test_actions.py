from __future__ import annotations

import numpy as np
import pytest

from relforest.smdp import UNBOUND, Decision, check_decision
from relforest.support.errors import InputError
from relforest.worlds.blocks.actions import Offer, flat_actions, position_of
from relforest.worlds.blocks.scene import SCHEMA
from relforest.worlds.blocks.tasks import ARCH_ACTIONS, HIGH_TOWERS_ACTIONS

NO_TARGETS = np.empty(0, dtype=np.int64)


def decision_of(offer: Offer, n_objects: int, n_private: int = 0) -> Decision:
    objects = np.zeros((n_objects, SCHEMA.width))
    return Decision(objects, offer.types, offer.arguments, offer.indices, n_private)


def test_the_actions_of_three_blocks_by_hand() -> None:
    actions = flat_actions(HIGH_TOWERS_ACTIONS, 3, 0)
    assert actions.types.tolist() == [0] * 6 + [1] * 3
    pairs = [[0, 1], [0, 2], [1, 0], [1, 2], [2, 0], [2, 1]]
    assert actions.slots.tolist() == [*pairs, [0, UNBOUND], [1, UNBOUND], [2, UNBOUND]]


def test_actions_keep_their_numbers_when_a_block_is_gone() -> None:
    actions = flat_actions(HIGH_TOWERS_ACTIONS, 3, 0)
    offer = actions.offer(np.array([True, False, True]), NO_TARGETS)
    check_decision(decision_of(offer, 2), SCHEMA, HIGH_TOWERS_ACTIONS)
    # put(0, 2), put(2, 0), rotate(0), rotate(2); the third block is the second object now.
    assert offer.indices.tolist() == [1, 4, 6, 8]
    assert offer.mask.tolist() == [0, 1, 0, 0, 1, 0, 1, 0, 1]
    assert offer.arguments.tolist() == [[0, 1], [1, 0], [0, UNBOUND], [1, UNBOUND]]


def test_a_move_binds_the_block_and_the_virtual_object_of_its_target() -> None:
    actions = flat_actions(ARCH_ACTIONS, 2, 3)
    # rotate 0, rotate 1, three moves, done; the second target does not exist now.
    present = np.array([True, True, True, False, True])
    offer = actions.offer(present, np.array([0, 0, 1]))
    check_decision(decision_of(offer, 4, n_private=2), SCHEMA, ARCH_ACTIONS)
    assert offer.types.tolist() == [0, 0, 1, 1, 2]
    assert offer.indices.tolist() == [0, 1, 2, 4, 5]
    assert offer.arguments.tolist() == [[0, -1], [1, -1], [0, 2], [1, 3], [-1, -1]]


def test_moves_to_reserved_targets_come_last() -> None:
    actions = flat_actions(ARCH_ACTIONS, 2, 3, 2)
    assert actions.types.tolist() == [0, 0, 1, 1, 1, 2, 1, 1]
    movers = np.array([0, 0, 1, 1, 0])
    before = actions.offer(np.array([True, True, True, False, True, False, False]), movers)
    after = actions.offer(np.array([True, True, True, False, True, True, False]), movers)
    # All others keep their positions, numbers and objects.
    assert after.indices.tolist() == [*before.indices, 6]
    assert after.arguments.tolist() == [*before.arguments.tolist(), [1, 4]]


def test_what_is_offered_again_is_the_same_and_what_changes_is_not() -> None:
    actions = flat_actions(ARCH_ACTIONS, 2, 3)
    present, movers = np.ones(5, dtype=np.bool_), np.array([0, 0, 1])
    first = actions.offer(present, movers)
    assert actions.offer(present.copy(), movers.copy()) is first
    assert actions.offer(present, np.array([0, 1, 1])).arguments.tolist() != first.arguments.tolist()
    for pattern in range(1, 128):
        present = np.array([pattern & 1 << i > 0 for i in range(5)])
        moved = np.array([pattern >> 6 & 1, 0, 1])
        expected = flat_actions(ARCH_ACTIONS, 2, 3).offer(present, moved)
        np.testing.assert_array_equal(actions.offer(present, moved).arguments, expected.arguments)


def test_after_the_end_there_is_no_action() -> None:
    offer = flat_actions(ARCH_ACTIONS, 2, 3).nothing()
    check_decision(decision_of(offer, 2), SCHEMA, ARCH_ACTIONS)
    assert (len(offer.indices), offer.mask.tolist()) == (0, [0] * 6)


def test_an_action_is_found_by_its_objects() -> None:
    decision = decision_of(
        flat_actions(HIGH_TOWERS_ACTIONS, 3, 0).offer(np.ones(3, dtype=np.bool_), NO_TARGETS), 3
    )
    assert position_of(decision, 0, 2, 0) == 4
    assert position_of(decision, 1, 1) == 7
    with pytest.raises(InputError, match=r"action type 0 with objects \(1, 1\)"):
        position_of(decision, 0, 1, 1)
