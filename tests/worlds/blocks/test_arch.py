from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.worlds.blocks.arch import Arch, arch_score, find_arch
from worlds.blocks.staged_blocks import LONG, UPRIGHT, portal, reordered, row, shifted, staged


def test_a_valid_arch_by_hand() -> None:
    # Supports 4 wide at -5 and 5: gap from -3 to 3. The top's lower face is at 10 - 2 = 8. 6 * 8 = 48.
    arch = find_arch(portal())
    assert arch is not None
    assert (arch.top, arch.left, arch.right) == (2, 0, 1)
    assert (arch.low_x, arch.high_x, arch.low_y, arch.high_y) == pytest.approx((-3.0, 3.0, 0.0, 8.0))
    assert arch_score(portal()) == pytest.approx(48.0)


def test_a_tilted_top_counts_from_its_lowest_point_above_the_gap() -> None:
    # Turned by 0.1, the lower face passes 2 / cos 0.1 below the centre and drops by tan 0.1 per unit to the
    # left, down to the gap's left end at -3: 10 - 2 / cos 0.1 - 3 tan 0.1 = 7.68896. Times 6.
    low = 10.0 - 2.0 / math.cos(0.1) - 3.0 * math.tan(0.1)
    assert arch_score(portal(tilt=0.1)) == pytest.approx(6.0 * low)
    assert arch_score(portal(tilt=-0.1)) == pytest.approx(6.0 * low)
    # Half a turn changes nothing.
    assert arch_score(portal(tilt=math.pi + 0.1)) == pytest.approx(6.0 * low)


def test_a_corner_that_hangs_into_the_gap_counts() -> None:
    # An upright top over a gap of 3 x 2: lower corners at -2 and 2, lower than anything between.
    state = staged(
        ((1, 5), (-2.5, 5, 0)),
        ((1, 5), (2.5, 5, 0)),
        ((2, 4), (0, 14.2, math.pi / 4)),
        contacts=[(0, 2), (1, 2)],
    )
    # Gap from -1.5 to 1.5. The lowest corner of the box turned by 45 degrees: (2, -4) turns to
    # x = (2 + 4) / sqrt 2 = 4.243, outside the gap; (-2, -4) to x = (-2 + 4) / sqrt 2 = 1.414, inside,
    # y = 14.2 - 6 / sqrt 2 = 9.957.
    assert arch_score(state) == pytest.approx(3.0 * (14.2 - 6.0 / math.sqrt(2.0)))


def test_supports_must_touch() -> None:
    assert find_arch(portal(contacts=False)) is None


def test_one_support_is_not_enough() -> None:
    state = portal()
    state.touching[1, 2] = state.touching[2, 1] = False
    assert find_arch(state) is None


def test_two_supports_on_one_side_make_no_arch() -> None:
    # The top is a long lever; both supports are left of its centre at 8.
    state = staged(((1, 4), (-2, 4, 0)), ((1, 4), (3, 4, 0)), ((12, 1), (8, 9, 0)), contacts=[(0, 2), (1, 2)])
    assert find_arch(state) is None


def test_a_block_under_the_centre_blocks_the_arch() -> None:
    blocked = staged(
        (LONG, (-5, 4, UPRIGHT)),
        (LONG, (5, 4, UPRIGHT)),
        (LONG, (0, 10, 0)),
        ((1, 1), (0.9, 1, 0)),
        contacts=[(0, 2), (1, 2)],
    )
    assert find_arch(blocked) is None
    # A block on top of the arch does not.
    crowned = staged(
        (LONG, (-5, 4, UPRIGHT)),
        (LONG, (5, 4, UPRIGHT)),
        (LONG, (0, 10, 0)),
        ((1, 1), (0.9, 13, 0)),
        contacts=[(0, 2), (1, 2), (2, 3)],
    )
    assert arch_score(crowned) == pytest.approx(48.0)


def test_a_block_in_the_gap_beside_the_centre_takes_room() -> None:
    # From its top at 2 to 8 there are 6 left: 6 * 6.
    state = staged(
        (LONG, (-5, 4, UPRIGHT)),
        (LONG, (5, 4, UPRIGHT)),
        (LONG, (0, 10, 0)),
        ((0.5, 1), (2, 1, 0)),
        contacts=[(0, 2), (1, 2)],
    )
    assert arch_score(state) == pytest.approx(36.0)


def test_a_top_that_rests_on_the_table_is_none() -> None:
    # A block leaning with a corner on the table: its lowest point is at 0.015, as the engine leaves it.
    low = 4.0 * math.sin(0.5) + 2.0 * math.cos(0.5) + 0.015
    state = staged(
        ((1, 1), (-2.6, 1, 0)), ((1, 1), (2.6, 1, 0)), (LONG, (0, low, 0.5)), contacts=[(0, 2), (1, 2)]
    )
    assert find_arch(state) is None


def test_supports_may_stand_on_other_blocks() -> None:
    # On slabs 2 high that reach a unit into the gap, the opening begins at 2 and ends at 12 - 2. 6 * 8.
    state = staged(
        (LONG, (-5, 6, UPRIGHT)),
        (LONG, (5, 6, UPRIGHT)),
        (LONG, (0, 12, 0)),
        ((4, 1), (-6, 1, 0)),
        ((4, 1), (6, 1, 0)),
        contacts=[(0, 2), (1, 2), (0, 3), (1, 4)],
    )
    assert arch_score(state) == pytest.approx(48.0)


def test_the_best_of_several_arches_counts() -> None:
    small = staged(((2, 2), (35, 2, 0)), ((2, 2), (41, 2, 0)), (LONG, (38, 6, 0)), contacts=[(0, 2), (1, 2)])
    # Gap 2, height 4.
    assert arch_score(small) == pytest.approx(8.0)
    both = staged(
        *((tuple(s.half_extents[i]), tuple(s.poses[i])) for s in (small, portal()) for i in range(3)),
        contacts=[(0, 2), (1, 2), (3, 5), (4, 5)],
    )
    arch = find_arch(both)
    assert arch is not None
    assert (arch.top, arch.score) == pytest.approx((5, 48.0))


def test_blocks_apart_and_an_empty_table_have_no_arch() -> None:
    assert arch_score(row(-20.0, 0.0, 20.0)) == 0.0
    assert arch_score(staged()) == 0.0


@given(st.permutations(range(3)), st.floats(-20.0, 20.0), st.floats(-0.3, 0.3))
def test_the_score_depends_neither_on_order_nor_on_place(order: list[int], x: float, tilt: float) -> None:
    state = portal(tilt=tilt, height=11.0)
    assert arch_score(shifted(reordered(state, order), x)) == pytest.approx(arch_score(state))


def test_the_rectangle_has_its_area() -> None:
    assert Arch(0, 1, 2, low_x=-1.0, high_x=2.0, low_y=1.0, high_y=5.0).score == 12.0


def test_a_mirrored_scene_scores_the_same() -> None:
    state = portal(tilt=0.2)
    state.poses[:, 0] *= -1.0
    state.poses[:, 2] *= -1.0
    assert arch_score(state) == pytest.approx(arch_score(portal(tilt=0.2)))
    assert np.isfinite(arch_score(state))
