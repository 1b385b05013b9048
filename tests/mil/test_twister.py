"""The Mersenne twister agrees with NumPy's, which is another implementation of it."""

from __future__ import annotations

import numpy as np
import pytest

from relforest.mil.twister import next_below, next_word, seeded


@pytest.mark.parametrize("seed", [0, 1, 5489, 2**31 - 1, 2**32 - 1])
def test_words_are_those_of_the_published_generator(seed: int) -> None:
    state = seeded(seed)
    expected = np.random.RandomState(seed).randint(0, 2**32, 1300, dtype=np.uint32)

    assert [next_word(state) for _ in range(1300)] == expected.tolist()


def test_the_published_first_word() -> None:
    # The tenthousandth word for the default seed, by which the C++ standard defines mt19937.
    state = seeded(5489)
    words = [next_word(state) for _ in range(10_000)]

    assert words[-1] == 4123659995


@pytest.mark.parametrize("n", [1, 2, 6, 1000])
def test_integers_below_a_number_are_equally_frequent(n: int) -> None:
    state = seeded(3)
    drawn = np.array([next_below(state, n) for _ in range(3000)])

    assert drawn.min() >= 0
    assert drawn.max() < n
    # Five standard deviations of the mean of a uniform distribution.
    assert abs(drawn.mean() - (n - 1) / 2) <= 5 * n / np.sqrt(12 * 3000)


def test_a_remainder_that_would_favour_small_integers_is_drawn_again() -> None:
    # Of 2**32 words, those whose product with n ends below 2**32 mod n are one too many.
    n = 2**31 - 1
    state, plain = seeded(7), seeded(7)
    drawn = [next_below(state, n) for _ in range(50)]
    words = [next_word(plain) for _ in range(200)]
    kept = [word for word in words if (word * n) % 2**32 >= 2**32 % n]

    assert drawn == [word * n >> 32 for word in kept[:50]]
