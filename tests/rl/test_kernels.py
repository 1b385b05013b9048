from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from relforest.rl.kernels import segment_argmax
from relforest.scenes.arrays import IntArray


def argmax_of(segments: list[list[float]]) -> IntArray:
    values = np.array([value for segment in segments for value in segment], dtype=np.float64)
    starts = np.cumsum([0, *map(len, segments)]).astype(np.int64)
    out = np.empty(len(segments), dtype=np.int64)
    segment_argmax(values, starts, out)
    return out


def test_largest_of_each_segment_first_of_equals() -> None:
    assert argmax_of([[1.0, 3.0, 3.0], [], [-2.0], [5.0, 4.0]]).tolist() == [1, -1, 3, 4]


@given(st.lists(st.lists(st.integers(-3, 3).map(float), max_size=5), max_size=8))
def test_agrees_with_a_plain_loop(segments: list[list[float]]) -> None:
    expected, start = [], 0
    for segment in segments:
        expected.append(start + segment.index(max(segment)) if segment else -1)
        start += len(segment)
    assert argmax_of(segments).tolist() == expected
