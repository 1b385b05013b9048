from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.worlds.keepaway.server.randomness import below, stream_states, uniform

M1, M2 = 4294967087, 4294944443


def next_number(state: list[int]) -> float:
    """MRG32k3a as L'Ecuyer (1999), figure I, states it, in Python's unbounded integers."""
    first = (1403580 * state[1] - 810728 * state[0]) % M1
    second = (527612 * state[5] - 1370589 * state[3]) % M2
    state[:] = [state[1], state[2], first, state[4], state[5], second]
    return ((first - second) % M1 or M1) / (M1 + 1)


def test_the_first_numbers_are_the_published_ones() -> None:
    # From the state (12345, ..., 12345), as in the examples of L'Ecuyer's own package RngStreams:
    # (1403580 - 810728) * 12345 mod m1 = 3023790853, (527612 - 1370589) * 12345 mod m2 = 2478282264,
    # (3023790853 - 2478282264) / (m1 + 1) = 545508589 / 4294967088
    streams = np.full((1, 6), 12345)

    assert uniform(streams, 0, 0.0, 1.0) == pytest.approx(545508589 / 4294967088, rel=1e-15)
    assert uniform(streams, 0, 0.0, 1.0) == pytest.approx(0.3185275653967945, rel=1e-15)


states = st.tuples(*[st.integers(1, M1 - 1)] * 3, *[st.integers(1, M2 - 1)] * 3)


@given(states)
def test_the_kernel_agrees_with_unbounded_integers(state: tuple[int, ...]) -> None:
    streams, twin = np.array([state]), list(state)

    for _ in range(5):
        assert uniform(streams, 0, 0.0, 1.0) == pytest.approx(next_number(twin), rel=1e-14)
        assert streams[0].tolist() == twin


def test_the_largest_states_do_not_overflow() -> None:
    streams = np.array([[1, M1 - 1, 1, M2 - 1, 1, 1], [M1 - 1, 1, 1, 1, 1, M2 - 1]])
    twins = streams.tolist()

    for game in range(2):
        assert uniform(streams, game, 0.0, 1.0) == pytest.approx(next_number(twins[game]), rel=1e-14)


def test_streams_are_their_own() -> None:
    seeds = [np.random.SeedSequence(5, spawn_key=(i,)) for i in range(4)]
    together, alone = stream_states(seeds), stream_states(seeds[2:3])
    for _ in range(3):
        uniform(together, 1, 0.0, 1.0)

    assert len(set(map(tuple, together.tolist()))) == 4
    np.testing.assert_array_equal(together[2], alone[0])


def test_no_seed_gives_a_state_that_stays_zero() -> None:
    states = stream_states([np.random.SeedSequence(i) for i in range(50)])

    assert states.dtype == np.int64
    assert states.min() >= 1
    assert (states < [M1, M1, M1, M2, M2, M2]).all()


def test_numbers_fill_their_range_evenly() -> None:
    streams = stream_states([np.random.SeedSequence(0)])
    numbers = np.array([uniform(streams, 0, -2.0, 6.0) for _ in range(4000)])

    assert numbers.min() >= -2.0
    assert numbers.max() <= 6.0
    # Standard error of the mean of 4000: 8 / sqrt(12 * 4000) = 0.0365; of each of 8 cells: about 21.
    assert abs(numbers.mean() - 2.0) < 4 * 0.0365
    assert abs(np.histogram(numbers, bins=8, range=(-2, 6))[0] - 500).max() < 4 * 21


def test_integers_are_below_their_count() -> None:
    streams = stream_states([np.random.SeedSequence(1)])
    drawn = [below(streams, 0, 3) for _ in range(600)]

    # Standard error of each count: sqrt(600 * 2/9) = 11.5.
    assert set(drawn) == {0, 1, 2}
    assert max(abs(drawn.count(i) - 200) for i in range(3)) < 4 * 11.5
