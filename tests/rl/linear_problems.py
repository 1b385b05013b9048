"""Reinforcement learning problems as bare feature tables: no world, no trees."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from relforest.rl.samples import Transitions
from relforest.scenes.arrays import FloatArray


class Problem(NamedTuple):
    """The features of every pair by action type, and transitions among the pairs."""

    features: tuple[FloatArray, ...]
    transitions: Transitions


def transitions_of(
    steps: list[tuple[tuple[int, int], float, float, list[tuple[int, int]]]],
) -> Transitions:
    """Transitions from (pair, reward, discount, pairs offered next); a pair is (action type, row)."""
    following = [pair for *_, offered in steps for pair in offered]
    return Transitions(
        types=np.array([pair[0] for pair, *_ in steps]),
        rows=np.array([pair[1] for pair, *_ in steps]),
        rewards=np.array([reward for _, reward, *_ in steps]),
        discounts=np.array([discount for *_, discount, _ in steps]),
        next_starts=np.cumsum([0, *(len(offered) for *_, offered in steps)]),
        next_types=np.array([action_type for action_type, _ in following], dtype=np.int64),
        next_rows=np.array([row for _, row in following], dtype=np.int64),
    )


def four_states(discount: float = 0.9) -> Problem:
    """A corridor of four states; a step that ends in one of the two middle ones pays 1.

    Action types 0 = left, 1 = right, both offered everywhere; one indicator feature per state. The row of a
    pair is its state.
    """
    left, right = {0: 0, 1: 0, 2: 1, 3: 2}, {0: 1, 1: 2, 2: 3, 3: 3}
    steps = []
    for action_type, successor in enumerate((left, right)):
        for state, after in successor.items():
            steps.append(((action_type, state), float(after in {1, 2}), discount, [(0, after), (1, after)]))
    return Problem((np.eye(4), np.eye(4)), transitions_of(steps))


def random_problem(rng: np.random.Generator, n: int = 30) -> Problem:
    """Two action types with 3 and 2 features; a few features have no data, a few transitions no future."""
    tables = [rng.standard_normal((8, 3)), rng.standard_normal((6, 2))]
    tables[0][:4, 2] = 0.0
    steps = []
    for _ in range(n):
        action_type = int(rng.integers(2))
        # Rows from 4 on are only ever offered, so that the third feature of type 0 has no data.
        row = int(rng.integers(4))
        offered = [
            (which, int(rng.integers(len(tables[which])))) for which in rng.integers(2, size=rng.integers(4))
        ]
        discount = float(rng.uniform(0.3, 0.9)) if offered else 0.0
        steps.append(((action_type, row), float(rng.standard_normal()), discount, offered))
    return Problem(tuple(tables), transitions_of(steps))
