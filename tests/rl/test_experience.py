from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from relforest.rl.experience import COLUMNS, OPTIONAL_COLUMNS, Experience, concatenate
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import read_npz, write_npz
from rl.small_worlds import two_episodes


def changed(**columns: Any) -> Experience:
    return replace(two_episodes(), **columns)


def test_counts() -> None:
    experience = two_episodes()
    assert (len(experience), experience.n_states, experience.n_episodes) == (3, 5, 2)


def test_columns_survive_a_file(tmp_path: Path) -> None:
    experience = two_episodes()
    write_npz(tmp_path / "batch.npz", experience.arrays())
    read = read_npz(tmp_path / "batch.npz", COLUMNS, optional=OPTIONAL_COLUMNS)
    found = Experience.from_arrays(read, origin="batch.npz")
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(found, name), getattr(experience, name))


def test_files_say_how_many_actions_remain_where_there_is_a_limit(tmp_path: Path) -> None:
    assert "remaining" not in two_episodes().arrays()
    for limits in ([2, 1, 0, 4, 3], [-1, -1, -1, -1, -1]):
        write_npz(tmp_path / "batch.npz", changed(remaining=np.array(limits)).arrays())
        read = read_npz(tmp_path / "batch.npz", COLUMNS, optional=OPTIONAL_COLUMNS)
        assert Experience.from_arrays(read, origin="batch.npz").remaining.tolist() == limits


def test_columns_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        two_episodes().rewards[0] = 1.0


def test_batches_are_joined_with_new_numbers() -> None:
    one = changed(private=np.array([1, 0, 0, 0, 1]))
    both = concatenate([one, replace(one, remaining=np.array([2, 1, 0, 4, 3]))])
    assert (len(both), both.n_states, both.n_episodes) == (6, 10, 4)
    # The second batch follows 5 states, 10 candidates and 5 object rows.
    assert both.states.tolist() == [0, 1, 3, 5, 6, 8]
    assert both.next_states.tolist() == [1, 2, 4, 6, 7, 9]
    assert both.actions.tolist() == [1, 4, 6, 11, 14, 16]
    assert both.objects.tolist() == [0, 2, 3, 3, 4, 5, 7, 8, 8, 9, 10]
    assert both.private.tolist() == [1, 0, 0, 0, 1, 1, 0, 0, 0, 1]
    assert both.remaining.tolist() == [-1, -1, -1, -1, -1, 2, 1, 0, 4, 3]
    assert both.candidates.tolist() == [0, 3, 5, 6, 8, 10, 13, 15, 16, 18, 20]


def test_one_batch_joined_is_itself() -> None:
    one = two_episodes()
    assert concatenate([one]) is one


def test_joining_needs_batches_of_one_world() -> None:
    with pytest.raises(InputError, match="gather at least one batch"):
        concatenate([])
    with pytest.raises(InputError, match="different worlds"):
        concatenate([two_episodes(), changed(arguments=np.full((10, 2), -1))])


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"rewards": np.zeros(2)}, "states, next_states, .* must have the same length"),
        ({"rewards": np.array([0.0, np.nan, 0.0])}, "rewards must be finite"),
        ({"durations": np.array([1.0, np.inf, 0.0])}, "durations must be finite"),
        ({"states": np.array([0, 1, 5])}, "states must be numbers from 0 to 4"),
        ({"next_states": np.array([0, -1, 2])}, "next_states must be numbers"),
        ({"actions": np.array([1, 4, 10])}, "actions must be numbers from 0 to 9"),
        ({"actions": np.array([4, 4, 6])}, "candidates of the state of the transition"),
        ({"objects": np.array([0, 2, 1, 3, 4, 5])}, "objects must be offsets"),
        ({"objects": np.array([0, 2**62, 2**63 - 1, -2, 4, 5])}, "objects must be offsets"),
        ({"candidates": np.array([0, 3, 5, 6, 8, 9])}, "candidates must be offsets that rise from 0 to 10"),
        ({"private": np.zeros(4, dtype=np.int64)}, "private must have one entry for each of the 5 states"),
        ({"private": np.array([0, 0, 1, 0, 0])}, "private must be from 0 to the number of objects"),
        ({"private": np.array([0, -1, 0, 0, 0])}, "private must be from 0 to the number of objects"),
        ({"remaining": np.full(6, -1)}, "remaining must have one entry for each of the 5 states, got 6"),
        ({"remaining": np.array([1, 0, -2, 1, 0])}, "remaining must not be negative"),
        ({"types": np.array([0, 1, 1, 0, 1, 0, 0, 1, 0, -1])}, "types must not be negative"),
        ({"types": np.zeros(9, dtype=np.int64)}, "must be offsets"),
        ({"arguments": np.full((10, 1), 3)}, "positions of objects in their state"),
        ({"matrix": np.full((5, 1), np.inf)}, "infinite"),
        ({"matrix": np.full((5, 1), -1e101)}, r"exceeds 1e\+100"),
        ({"rewards": np.array([0.0, 1e101, 0.0])}, r"rewards must be finite, from -1e\+100 to 1e\+100"),
        ({"durations": np.array([1.0, -1.0, 0.0])}, r"durations must be finite, from 0 to 1e\+100"),
        ({"matrix": np.zeros(5)}, "matrix must be a 2-dimensional array of float64"),
        ({"states": np.array([0.0, 1.0, 3.0])}, "states must be a 1-dimensional array of int64"),
        ({"terminal": np.array([0, 1, 0])}, "terminal must be a 1-dimensional array of bool"),
    ],
)
def test_columns_that_do_not_fit_are_refused(columns: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        changed(**columns)


def test_a_damaged_file_is_no_experience() -> None:
    arrays = two_episodes().arrays()
    with pytest.raises(ModelFormatError, match=r"batch\.npz is not a valid batch .* rewards must be finite"):
        Experience.from_arrays(arrays | {"rewards": np.full(3, np.nan)}, origin="batch.npz")
    with pytest.raises(ModelFormatError, match="objects must be a 1-dimensional array"):
        Experience.from_arrays(arrays | {"objects": np.array(5)}, origin="batch.npz")
    del arrays["rewards"]
    with pytest.raises(ModelFormatError, match="rewards missing"):
        Experience.from_arrays(arrays, origin="batch.npz")
