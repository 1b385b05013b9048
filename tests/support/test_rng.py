from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.support.errors import InputError
from relforest.support.rng import generator, seed_sequence, stream

keys = st.lists(st.integers(0, 2**32 - 1), max_size=4).map(tuple)


def draws(seed: np.random.SeedSequence) -> list[int]:
    values: list[int] = generator(seed).integers(0, 2**63, size=4).tolist()
    return values


def test_an_integer_names_the_same_run_whatever_its_type() -> None:
    # The first draws of PCG64 seeded with 0 are published in NumPy's own documentation of default_rng(0).
    assert generator(seed_sequence(0)).random() == pytest.approx(0.6369616873214543, abs=0.0)
    assert draws(seed_sequence(7)) == draws(seed_sequence(int(np.int32(7))))
    assert draws(seed_sequence(7)) != draws(seed_sequence(8))


def test_no_seed_gives_fresh_entropy() -> None:
    assert draws(seed_sequence(None)) != draws(seed_sequence(None))


def test_a_sequence_is_used_as_it_is() -> None:
    sequence = np.random.SeedSequence(5, spawn_key=(1, 2))

    assert seed_sequence(sequence) is sequence


@pytest.mark.parametrize("make", [np.random.default_rng, np.random.RandomState])
def test_a_generator_gives_a_new_seed_at_every_call_and_repeats_with_itself(
    make: Callable[[int], Any],
) -> None:
    first, second = make(3), make(3)
    one, two = seed_sequence(first), seed_sequence(first)

    assert draws(one) != draws(two)
    assert draws(one) == draws(seed_sequence(second))


@pytest.mark.parametrize("value", [-1, True, np.True_, 1.0, "1", (1, 2), np.random.RandomState])
def test_other_seeds_are_refused(value: object) -> None:
    with pytest.raises(InputError, match=r"random_state must be an integer of at least 0, .* got "):
        seed_sequence(value)  # type: ignore[arg-type]  # hostile on purpose


@given(key=keys, tail=keys)
def test_a_stream_of_a_stream_is_the_stream_of_the_joined_key(
    key: tuple[int, ...], tail: tuple[int, ...]
) -> None:
    seed = np.random.SeedSequence(11)

    assert draws(stream(stream(seed, *key), *tail)) == draws(stream(seed, *key, *tail))


@given(one=keys, other=keys)
def test_streams_are_equal_only_if_their_keys_are(one: tuple[int, ...], other: tuple[int, ...]) -> None:
    seed = np.random.SeedSequence(11)

    assert (draws(stream(seed, *one)) == draws(stream(seed, *other))) == (one == other)


def test_naming_a_stream_changes_nothing() -> None:
    seed = np.random.SeedSequence(4)
    before = draws(stream(seed, 2))
    stream(seed, 1)
    seed.spawn(3)

    assert draws(stream(seed, 2)) == before


def test_streams_are_uncorrelated_with_each_other_and_their_parent() -> None:
    seed = np.random.SeedSequence(0)
    samples = np.array(
        [generator(s).standard_normal(4000) for s in (seed, *(stream(seed, i) for i in range(9)))]
    )
    correlations = np.corrcoef(samples)[np.triu_indices(10, 1)]

    # 45 correlations with standard error 1 / sqrt(4000) = 0.0158: five of those bound them all.
    assert np.abs(correlations).max() < 0.08


@pytest.mark.parametrize("key", [(-1,), (2**32,), (0, -5)])
def test_keys_outside_one_word_are_refused(key: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match=r"a part of a stream's key must be from 0 to 2\*\*32 - 1, got "):
        stream(np.random.SeedSequence(0), *key)
