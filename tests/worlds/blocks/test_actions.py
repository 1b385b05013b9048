from __future__ import annotations

import numpy as np
import pytest

from relforest.smdp import UNBOUND, check_decision
from relforest.support.errors import InputError
from relforest.worlds.blocks.actions import flat_actions, position_of
from relforest.worlds.blocks.scene import SCHEMA
from relforest.worlds.blocks.tasks import ARCH_ACTIONS, HIGH_TOWERS_ACTIONS

NO_TARGETS = np.empty(0, dtype=np.int64)


def test_the_actions_of_three_blocks_by_hand() -> None:
    actions = flat_actions(HIGH_TOWERS_ACTIONS, 3, 0)
    assert actions.types.tolist() == [0] * 6 + [1] * 3
    pairs = [[0, 1], [0, 2], [1, 0], [1, 2], [2, 0], [2, 1]]
    assert actions.slots.tolist() == [*pairs, [0, UNBOUND], [1, UNBOUND], [2, UNBOUND]]


def test_actions_keep_their_numbers_when_a_block_is_gone() -> None:
    actions = flat_actions(HIGH_TOWERS_ACTIONS, 3, 0)
    objects = np.zeros((2, SCHEMA.width))
    decision = actions.decision(objects, np.array([True, False, True]), NO_TARGETS)
    check_decision(decision, SCHEMA, HIGH_TOWERS_ACTIONS)
    # put(0, 2), put(2, 0), rotate(0), rotate(2); the third block is the second object now.
    assert decision.indices.tolist() == [1, 4, 6, 8]
    assert decision.arguments.tolist() == [[0, 1], [1, 0], [0, UNBOUND], [1, UNBOUND]]


def test_a_move_binds_the_block_and_the_virtual_object_of_its_target() -> None:
    actions = flat_actions(ARCH_ACTIONS, 2, 3)
    # rotate 0, rotate 1, three moves, done; the second target does not exist now.
    objects = np.zeros((4, SCHEMA.width))
    present = np.array([True, True, True, False, True])
    decision = actions.decision(objects, present, np.array([0, 0, 1]))
    check_decision(decision, SCHEMA, ARCH_ACTIONS)
    assert decision.types.tolist() == [0, 0, 1, 1, 2]
    assert decision.indices.tolist() == [0, 1, 2, 4, 5]
    assert decision.arguments.tolist() == [[0, -1], [1, -1], [0, 2], [1, 3], [-1, -1]]


def test_after_the_end_there_is_no_action() -> None:
    decision = flat_actions(ARCH_ACTIONS, 2, 3).nothing(np.zeros((2, SCHEMA.width)))
    check_decision(decision, SCHEMA, ARCH_ACTIONS)
    assert len(decision) == 0


def test_an_action_is_found_by_its_objects() -> None:
    decision = flat_actions(HIGH_TOWERS_ACTIONS, 3, 0).decision(
        np.zeros((3, SCHEMA.width)), np.ones(3, dtype=np.bool_), NO_TARGETS
    )
    assert position_of(decision, 0, 2, 0) == 4
    assert position_of(decision, 1, 1) == 7
    with pytest.raises(InputError, match=r"no action of type 0 with the objects \(1, 1\)"):
        position_of(decision, 0, 1, 1)
