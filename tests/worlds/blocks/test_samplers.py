from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.support.errors import InputError
from relforest.worlds.blocks.samplers import SAMPLERS, Targets, nearby_targets, target_sampler
from relforest.worlds.blocks.state import BlocksState
from worlds.blocks.staged_blocks import LONG, UPRIGHT, row, staged

NAN = float("nan")


def sampled(name: str, state: BlocksState, slots: list[int] | None = None, n: int | None = None) -> Targets:
    own = np.arange(len(state)) if slots is None else np.array(slots)
    return SAMPLERS[name].sample(state, own, len(state) if n is None else n)


def test_the_test_sampler_by_hand() -> None:
    # Blocks at 0, 10 and 30. For the first: between the others 20; onto them 10, 30; half way 5, 15; a tenth
    # of the distance away -1, -3.
    targets = sampled("test", row(0.0, 10.0, 30.0))
    assert targets.slots.tolist() == [0] * 7 + [1] * 7 + [2] * 7
    assert targets.x[:7] == pytest.approx([20, 10, 30, 5, 15, -1, -3])
    # The second: between 15; onto 0, 30; half way 5, 20; away 11, 8.
    assert targets.x[7:14] == pytest.approx([15, 0, 30, 5, 20, 11, 8])
    # The third: between 5; onto 0, 10; half way 15, 20; away 33, 32.
    assert targets.x[14:] == pytest.approx([5, 0, 10, 15, 20, 33, 32])


def test_the_training_sampler_by_hand() -> None:
    # Widths 8, 4 and 4. The first beside the others at 0.75 * (8 + 4) = 9; the others at 9 and 0.75 * 8 = 6.
    state = staged((LONG, (0, 2, 0)), (LONG, (20, 4, UPRIGHT)), (LONG, (40, 4, -UPRIGHT)))
    targets = sampled("training", state)
    assert targets.x[:5] == pytest.approx([30, 11, 31, 29, 49])
    assert targets.x[5:10] == pytest.approx([20, -9, 34, 9, 46])
    assert targets.x[10:] == pytest.approx([10, -9, 14, 9, 26])


def test_more_targets_take_the_free_slots_in_order_and_none_twice() -> None:
    targets = sampled("test", row(0.0, 10.0)).with_reserved(3)
    # Onto, half way and away for each of the two; nothing in the slots that are free.
    np.testing.assert_allclose(targets.x, [10, 5, -1, 0, 5, 11, NAN, NAN, NAN])
    assert targets.also(1, 5.0) is targets
    assert targets.also(1, 5.0 + 1e-12) is targets
    found = targets.also(1, 7.0).also(0, 7.0)
    np.testing.assert_allclose(found.x[6:], [7, 7, NAN])
    assert (found.slots[6:8].tolist(), found.free) == ([1, 0], 1)
    assert (found.place(0, 7.0), found.place(0, 8.0), targets.place(0, 7.0)) == (7, None, None)
    assert found.also(0, 8.0, n_kept=1) is found
    full = found.also(0, 8.0)
    assert full.also(0, 9.0) is full


def test_what_depends_on_a_lost_block_is_no_candidate() -> None:
    # Block 1 of three is gone: what is left is onto, half way and away, for 0 and 2.
    targets = sampled("test", row(0.0, 30.0), slots=[0, 2], n=3)
    expected = [NAN, NAN, 30, NAN, 15, NAN, -3, *[NAN] * 7, NAN, 0, NAN, 15, NAN, 33, NAN]
    np.testing.assert_allclose(targets.x, expected)


def test_a_target_is_offered_once_per_block() -> None:
    # The second stands at -10: half way to 10 is 0, which is where "onto the third" goes already.
    targets = sampled("test", row(10.0, -10.0, 0.0))
    second = targets.x[7:14]
    np.testing.assert_allclose(second, [5, 10, 0, NAN, -5, -12, -11])


@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_there_are_always_as_many_candidates(n: int, seed: int) -> None:
    state = row(*np.random.default_rng(seed).uniform(-50, 50, n))
    for name, sampler in SAMPLERS.items():
        targets = sampled(name, state)
        assert len(targets.x) == len(targets.slots) == sampler.size(n)
        assert sampled(name, state).x.tobytes() == targets.x.tobytes()
        assert sampled(name, row(3.0), slots=[n - 1], n=n).x.shape == targets.x.shape


def test_a_search_goes_on_towards_and_away() -> None:
    # From 4, others at 0 and 14: half way 2 and 9, a tenth away 4.4 and 3.
    assert nearby_targets(4.0, [0.0, 14.0]) == pytest.approx([2, 9, 4.4, 3])


def test_an_unknown_sampler_is_an_error() -> None:
    with pytest.raises(InputError, match="sampler must be one of 'test', 'training', got 'x'"):
        target_sampler("x")
