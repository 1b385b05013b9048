"""Recording experience while a world runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from relforest.rl.experience import Experience
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision


@final
class Recorder:
    """Collects states, transitions and episodes while a world runs, and turns them into `Experience`.

    Parameters
    ----------
    width : int
        Columns of the world's schema.
    arity : int
        The largest arity among its action types.
    """

    def __init__(self, width: int, arity: int) -> None:
        self._decisions: list[Decision] = []
        self._transitions: list[tuple[int, int, int, float, float, bool, bool]] = []
        self._episodes: list[tuple[float, float]] = []
        self._width, self._arity = width, arity

    def state(self, decision: Decision) -> int:
        """Store a state with its candidates and return its number."""
        self._decisions.append(decision)
        return len(self._decisions) - 1

    def transition(
        self, state: int, position: int, reward: float, duration: float, ended: tuple[bool, bool]
    ) -> None:
        """Store the step from `state` to the state stored last; `ended` is (terminal, truncated)."""
        self._transitions.append((state, len(self._decisions) - 1, position, reward, duration, *ended))

    def episode(self, reward: float, duration: float) -> None:
        """Store the undiscounted total reward and the duration of an episode."""
        self._episodes.append((reward, duration))

    def finish(self) -> Experience:
        """Return everything stored so far."""
        decisions, steps = self._decisions, list(zip(*self._transitions, strict=True)) or [()] * 7
        candidates = _offsets([len(decision) for decision in decisions])
        states = np.array(steps[0], dtype=np.int64)
        totals = np.array(self._episodes, dtype=np.float64).reshape(-1, 2)
        return Experience(
            matrix=np.concatenate(
                [np.empty((0, self._width)), *(decision.objects for decision in decisions)]
            ),
            objects=_offsets([decision.n_objects for decision in decisions]),
            private=np.array([decision.n_private for decision in decisions], dtype=np.int64),
            candidates=candidates,
            types=np.concatenate([np.empty(0, np.int64), *(decision.types for decision in decisions)]),
            arguments=np.concatenate(
                [np.empty((0, self._arity), np.int64), *(decision.arguments for decision in decisions)]
            ),
            states=states,
            next_states=np.array(steps[1], dtype=np.int64),
            actions=candidates[states] + np.array(steps[2], dtype=np.int64),
            rewards=np.array(steps[3], dtype=np.float64),
            durations=np.array(steps[4], dtype=np.float64),
            terminal=np.array(steps[5], dtype=np.bool_),
            truncated=np.array(steps[6], dtype=np.bool_),
            episode_rewards=totals[:, 0],
            episode_durations=totals[:, 1],
        )


def _offsets(counts: Sequence[int]) -> IntArray:
    offsets = np.zeros(len(counts) + 1, dtype=np.int64)
    np.cumsum(counts, out=offsets[1:])
    return offsets
