from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.support.errors import InputError
from relforest.worlds.blocks.overlap import overlapping, widest_gap

ITEM = (0.0, 4.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("left", "right", "original", "interval"),
    [
        (3.0, 9.0, True, True),  # its left end is inside
        (-9.0, 1.0, True, True),  # its right end
        (1.0, 2.0, True, True),  # all of it
        (-2.0, 6.0, True, True),  # it covers the item, and its centre is inside
        (-1.0, 20.0, False, True),  # it covers the item, its centre is at 9.5
        (4.0, 9.0, True, True),  # it touches
        (4.5, 9.0, False, False),
        (-9.0, -0.5, False, False),
    ],
)
def test_overlap_of_intervals(left: float, right: float, *, original: bool, interval: bool) -> None:
    bounds = [(left, right, 5.0, 6.0), ITEM]

    assert overlapping(bounds, 1) == ([0] if original else [])
    assert overlapping(bounds, 1, overlap="interval") == ([0] if interval else [])


def test_the_original_test_is_not_symmetric() -> None:
    bounds = [ITEM, (-1.0, 20.0, 5.0, 6.0)]

    assert overlapping(bounds, 0) == []
    assert overlapping(bounds, 1) == [0]


def test_a_block_does_not_overlap_itself() -> None:
    assert overlapping([ITEM], 0) == []
    assert overlapping([ITEM, ITEM, ITEM], 1) == [0, 2]


def test_unknown_tests_are_refused() -> None:
    with pytest.raises(InputError, match="overlap must be one of 'original', 'interval'"):
        overlapping([ITEM], 0, overlap="exact")  # type: ignore[arg-type]


def test_the_widest_gap_is_one_that_nothing_covers() -> None:
    # Between 1 and 2 (1 wide), between 5 and 8 (3 wide); 9 to 11 is covered by the block from 8 to 20.
    intervals = [(8.0, 20.0), (0.0, 1.0), (2.0, 5.0), (8.5, 9.0), (11.0, 12.0)]

    assert widest_gap(intervals) == (5.0, 8.0)
    assert widest_gap([(0.0, 1.0), (2.0, 3.0), (4.0, 5.0)]) == (1.0, 2.0)


def test_there_may_be_no_gap() -> None:
    begin, end = widest_gap([(0.0, 5.0), (1.0, 2.0), (4.0, 9.0)])

    assert begin == end


intervals = st.lists(
    st.tuples(st.integers(-20, 20), st.integers(0, 9)).map(lambda pair: (float(pair[0]), float(sum(pair)))),
    min_size=1,
    max_size=6,
)


@given(intervals=intervals)
def test_no_gap_is_wider(intervals: list[tuple[float, float]]) -> None:
    begin, end = widest_gap(intervals)
    ends = [right for _, right in intervals]
    # A gap begins where an interval ends, and ends where the next one begins, if none covers its beginning.
    widths = [0.0]
    for right in ends:
        later = [left for left, _ in intervals if left > right]
        if later and not any(left <= right < other for left, other in intervals):
            widths.append(min(later) - right)

    assert end - begin == max(widths)
    assert not any(left < end and right > begin for left, right in intervals if begin < end)
