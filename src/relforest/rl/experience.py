"""The experience of an agent: transitions of a semi-Markov decision process, in columns.

A state is stored once, even if the next state of one transition is the state of the following one. Every
action available in a state (a *candidate*) is stored with it, because policy iteration needs the values of
all of them. Scenes for learning are views, see `relforest.rl.action_scenes`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import NO_LIMIT, UNBOUND
from relforest.support.documents import LARGEST_NUMBER
from relforest.support.errors import InputError, ModelFormatError

BoolArray = NDArray[np.bool_]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Experience:
    """A batch of episodes.

    Letters: s states, r object rows, c candidate actions, n transitions, e episodes, w columns of the world's
    schema, k the largest arity among its action types.

    Raises
    ------
    InputError
        If a shape or type is wrong, an index is out of range, a duration is negative, or a value is
        infinite or exceeds 1e100.

    References
    ----------
    Palmer (2015), section 2.1 (options) and section 6.3 (the examples that SMRF-RPI learns from).
    """

    matrix: FloatArray  # (r, w) the objects of all states, one row each, NaN = undefined
    objects: IntArray  # (s + 1,) state ``i`` has the rows ``objects[i]`` to ``objects[i + 1]`` (exclusive)
    private: IntArray
    """(s,): number of private objects in each state, which are its last ones: they belong only to the scenes
    of the candidates that bind them."""
    remaining: IntArray
    """(s,): how many actions the episode can still take in each state, `NO_LIMIT` where their number is
    unlimited."""
    candidates: IntArray
    """(s + 1,): state ``i`` offers the candidates ``candidates[i]`` to ``candidates[i + 1]`` (exclusive)."""
    types: IntArray  # (c,) action type of each candidate
    arguments: IntArray  # (c, k) positions of the bound objects within their state, -1 = none
    states: IntArray
    next_states: IntArray
    """(n,) each: state numbers at both ends of each transition."""
    actions: IntArray  # (n,) the candidate taken; it belongs to the state of the transition
    rewards: FloatArray  # (n,) reward inside the action, discounted to its beginning
    durations: FloatArray  # (n,) duration of the action, in the world's unit of time
    terminal: BoolArray
    truncated: BoolArray
    """(n,) each: whether the transition ended its episode in a terminal state, or by a time limit."""
    episode_rewards: FloatArray
    episode_durations: FloatArray
    """(e,) each: undiscounted total reward and duration of each episode, with what passed before its first
    decision."""

    def __post_init__(self) -> None:
        for name, (dtype, ndim) in _LAYOUT.items():
            object.__setattr__(self, name, _column(name, getattr(self, name), dtype, ndim))
        _check_offsets("objects", self.objects, len(self.matrix))
        _check_offsets("candidates", self.candidates, len(self.types))
        _check_lengths(self)
        _check_numbers(self)

    def __len__(self) -> int:
        """Return the number of transitions."""
        return len(self.states)

    @property
    def n_states(self) -> int:
        """Number of states."""
        return len(self.objects) - 1

    @property
    def n_episodes(self) -> int:
        """Number of episodes."""
        return len(self.episode_rewards)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name, for `relforest.support.files.write_npz`.

        `remaining` is left out if no state has a limit.
        """
        limited = bool((self.remaining != NO_LIMIT).any())
        return {name: getattr(self, name) for name in _LAYOUT if limited or name != "remaining"}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]], *, origin: str) -> Experience:
        """Build the batch from the output of `arrays`.

        Parameters
        ----------
        arrays : mapping
            The `COLUMNS` by name; without those of `OPTIONAL_COLUMNS`, `remaining`, no state has a limit.
        origin : str
            Where the arrays come from, for error messages.

        Raises
        ------
        ModelFormatError
            If a column is missing or the columns do not match.
        """
        missing = [name for name in COLUMNS if name not in arrays and name not in OPTIONAL_COLUMNS]
        if missing:
            raise ModelFormatError(f"{origin} is not a batch of experience: {', '.join(missing)} missing")
        columns = {"remaining": np.full(max(arrays["objects"].size - 1, 0), NO_LIMIT)} | dict(arrays)
        try:
            return cls(**{name: columns[name] for name in COLUMNS})
        except InputError as error:
            raise ModelFormatError(f"{origin} is not a valid batch of experience: {error}") from error


def concatenate(batches: Sequence[Experience]) -> Experience:
    """Join batches of the same world in the given order, renumbering states and candidates.

    Raises
    ------
    InputError
        If no batch is given, or the batches have different numbers of columns.
    """
    if not batches:
        raise InputError("no experience to join: gather at least one batch first")
    widths = {(batch.matrix.shape[1], batch.arguments.shape[1]) for batch in batches}
    if len(widths) > 1:
        raise InputError(
            f"batches of different worlds cannot be joined: (columns, arity) are {sorted(widths)}"
        )
    if len(batches) == 1:
        return batches[0]
    states = _shifts([batch.n_states for batch in batches])
    candidates = _shifts([len(batch.types) for batch in batches])
    rows = _shifts([len(batch.matrix) for batch in batches])
    moved = {"states": states, "next_states": states, "actions": candidates}
    columns: dict[str, NDArray[Any]] = {}
    for name in COLUMNS:
        parts = [getattr(batch, name) for batch in batches]
        if name in moved:
            parts = [part + shift for part, shift in zip(parts, moved[name], strict=True)]
        if name in ("objects", "candidates"):
            shifts = rows if name == "objects" else candidates
            parts = [
                np.zeros(1, np.int64),
                *(part[1:] + shift for part, shift in zip(parts, shifts, strict=True)),
            ]
        columns[name] = np.concatenate(parts)
    return Experience(**columns)


def latest(batches: Sequence[Experience], most: int) -> Sequence[Experience]:
    """Return the latest batches with at most so many transitions together, at least one of them."""
    n, total = 0, 0
    for batch in reversed(batches):
        total += len(batch)
        if n and total > most:
            break
        n += 1
    return batches[len(batches) - n :]


COLUMNS = tuple(field.name for field in fields(Experience))
"""Names of the columns of `Experience`, in order."""

OPTIONAL_COLUMNS = ("remaining",)
"""Columns that may be missing from a file, see `Experience.from_arrays`."""

_LAYOUT: dict[str, tuple[type[Any], int]] = {
    name: (
        np.bool_
        if name in ("terminal", "truncated")
        else np.float64
        if name in ("matrix", "rewards", "durations", "episode_rewards", "episode_durations")
        else np.int64,
        2 if name in ("matrix", "arguments") else 1,
    )
    for name in COLUMNS
}


def _shifts(sizes: Sequence[int]) -> list[int]:
    return [sum(sizes[:i]) for i in range(len(sizes))]


def _column(name: str, values: NDArray[Any], dtype: type[Any], ndim: int) -> NDArray[Any]:
    array = np.asarray(values)
    if array.dtype != dtype or array.ndim != ndim:
        raise InputError(
            f"{name} must be a {ndim}-dimensional array of {np.dtype(dtype)}, "
            f"got {array.ndim} dimensions of {array.dtype}"
        )
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def _check_offsets(name: str, offsets: IntArray, end: int) -> None:
    rises = len(offsets) and offsets[0] == 0 and offsets[-1] == end and (offsets[:-1] <= offsets[1:]).all()
    if not rises:
        raise InputError(f"{name} must be offsets that rise from 0 to {end}")


def _check_lengths(experience: Experience) -> None:
    groups = (
        ("objects", "candidates"),
        ("types", "arguments"),
        ("states", "next_states", "actions", "rewards", "durations", "terminal", "truncated"),
        ("episode_rewards", "episode_durations"),
    )
    for names in groups:
        lengths = [len(getattr(experience, name)) for name in names]
        if len(set(lengths)) > 1:
            raise InputError(f"{', '.join(names)} must have the same length, got {lengths}")
    for name in ("private", "remaining"):
        length = len(getattr(experience, name))
        if length != experience.n_states:
            raise InputError(
                f"{name} must have one entry for each of the {experience.n_states} states, got {length}"
            )


def _check_numbers(experience: Experience) -> None:
    n_states, n_candidates = experience.n_states, len(experience.types)
    for name, numbers, end in (
        ("states", experience.states, n_states),
        ("next_states", experience.next_states, n_states),
        ("actions", experience.actions, n_candidates),
    ):
        if len(numbers) and (numbers.min() < 0 or numbers.max() >= end):
            raise InputError(f"{name} must be numbers from 0 to {end - 1}")
    low, high = experience.candidates[experience.states], experience.candidates[experience.states + 1]
    if ((experience.actions < low) | (experience.actions >= high)).any():
        raise InputError("actions must be candidates of the state of the transition")
    if len(experience.types) and experience.types.min() < 0:
        raise InputError("types must not be negative")
    n_objects = np.diff(experience.objects)
    if ((experience.private < 0) | (experience.private > n_objects)).any():
        raise InputError("private must be from 0 to the number of objects of the state")
    if (experience.remaining < NO_LIMIT).any():
        raise InputError(f"remaining must not be negative, or {NO_LIMIT} where there is no limit")
    n_objects = np.repeat(n_objects, np.diff(experience.candidates))
    if ((experience.arguments < UNBOUND) | (experience.arguments >= n_objects[:, None])).any():
        raise InputError("arguments must be positions of objects in their state, or -1 for none")
    if (np.abs(experience.matrix) > LARGEST_NUMBER).any():
        raise InputError(
            f"matrix contains a value that is infinite or exceeds {LARGEST_NUMBER:g}; use NaN if undefined"
        )
    for name in ("rewards", "durations", "episode_rewards", "episode_durations"):
        least = 0.0 if name.endswith("durations") else -LARGEST_NUMBER
        values: FloatArray = getattr(experience, name)
        # The negated test also catches NaN.
        if not ((values >= least) & (values <= LARGEST_NUMBER)).all():
            raise InputError(
                f"{name} must be finite, from {least:g} to {LARGEST_NUMBER:g}; "
                "check the rewards and durations of the world"
            )
