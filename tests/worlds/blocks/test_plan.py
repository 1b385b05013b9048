from __future__ import annotations

import pytest

from relforest.worlds.blocks.plan import ArchPlan, arch_plan
from relforest.worlds.blocks.state import BlocksState
from worlds.blocks.staged_blocks import LONG, UPRIGHT, Pose, portal, row, shifted, staged


def lying(x: float) -> tuple[tuple[float, float], Pose]:
    return LONG, (x, 2.0, 0.0)


def upright(x: float) -> tuple[tuple[float, float], Pose]:
    return LONG, (x, 4.0, UPRIGHT)


def planned(state: BlocksState) -> ArchPlan:
    plan = arch_plan(state)
    assert plan is not None
    return plan


def test_with_three_lying_blocks_the_leftmost_is_the_top() -> None:
    plan = planned(staged(lying(20), lying(-20), lying(0)))
    assert (plan.top, plan.lying) == (1, (2, 0))


def test_a_lying_block_is_the_top_wherever_it_is() -> None:
    plan = planned(staged(upright(-20), upright(0), lying(20)))
    assert (plan.top, plan.lying) == (2, ())


def test_without_a_lying_block_the_leftmost_is_the_top_and_nothing_is_rotated() -> None:
    plan = planned(staged(upright(20), upright(0), upright(-20)))
    assert (plan.top, plan.lying) == (2, ())
    # The top is 4 wide: a gap of 2, centres 6 apart; the nearest way is to move 20 to 6.
    assert (plan.block, plan.x) == pytest.approx((0, 6.0))


def test_supports_are_brought_ten_apart() -> None:
    # Top 8 wide, gap 6, supports 4 wide: 0 goes to 24 - 10, as far as 24 to 10; of equals the first moves.
    plan = planned(staged(lying(-20), upright(0), upright(24)))
    assert (plan.block, plan.x) == pytest.approx((1, 14.0))


def test_a_support_goes_where_nothing_is_in_its_way() -> None:
    # The top at 9 (5 to 13) is where 24 would go, 10, and reaches under 14, where 0 would go. The other ways
    # are 24 to -10 and 0 to 34, both 34; of equals the first block moves.
    plan = planned(staged(lying(9), upright(0), upright(24)))
    assert (plan.block, plan.x) == pytest.approx((1, 34.0))
    # From 23, -10 is 33 away, and 0 to 33 as well; a block on the right leaves the left only.
    crowded = planned(staged(lying(9), upright(0), upright(23), ((1, 1), (34, 1, 0))))
    assert (crowded.block, crowded.x) == pytest.approx((2, -10.0))


def test_a_support_on_another_block_is_the_one_to_move() -> None:
    # The second support lies on the top; only the first stands on the table.
    state = staged(lying(0), upright(-15), (LONG, (1.0, 8.0, UPRIGHT)))
    plan = planned(state)
    # Right of -15 the top is in the way, so it goes left, to -25.
    assert (plan.block, plan.x) == pytest.approx((2, -25.0))


def test_supports_that_stand_well_wait_for_the_top() -> None:
    # Gap 6 +- 1. At -5 and 5.9 it is 6.9, the middle of the gap 0.45.
    good = planned(staged(upright(-5), upright(5.9), lying(30)))
    assert (good.top, good.block, good.x) == pytest.approx((2, 2, 0.45))
    # 7.1 is too wide.
    assert planned(staged(upright(-5), upright(6.1), lying(30))).block != 2


def test_lying_supports_may_carry_the_top_if_their_rotation_is_skipped() -> None:
    # Gap 6 between blocks 8 wide: 14 apart.
    plan = planned(staged(lying(-30), lying(0), lying(14)))
    assert plan.lying == (1, 2)
    assert (plan.block, plan.x) == pytest.approx((0, 7.0))


def test_a_finished_arch_is_topped_again() -> None:
    plan = planned(portal())
    assert (plan.top, plan.lying, plan.block) == (2, (), 2)
    assert plan.x == pytest.approx(0.0)


def test_the_plan_moves_with_the_blocks() -> None:
    state = staged(lying(-20), upright(0), upright(24))
    assert planned(shifted(state, 8.0)).x == pytest.approx(planned(state).x + 8.0)


def test_an_arch_needs_three_blocks() -> None:
    assert arch_plan(row(0.0, 10.0)) is None
