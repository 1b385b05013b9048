"""How rounds of training end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.mil.baselines.alternation import alternate
from relforest.mil.baselines.kernel_machine import KernelMachine


def follow(successors: list[int], *, solved: bool = True) -> Callable[[NDArray[Any]], Any]:
    """Train nothing: the machine's intercept tells on which choice it was made."""

    def train_and_choose(choice: NDArray[Any]) -> tuple[KernelMachine, NDArray[Any]]:
        number = int(choice[0])
        machine = KernelMachine(
            np.zeros((1, 1)), np.ones(1), np.zeros(1, dtype=np.int64), float(number), 1.0, converged=solved
        )
        return machine, np.array([successors[number]])

    return train_and_choose


@pytest.mark.parametrize(
    ("successors", "max_rounds", "expected"),
    [
        ([0], 5, (0, 1, True)),
        ([1, 2, 2], 5, (2, 3, True)),
        ([1, 2, 2], 3, (2, 3, True)),
        ([1, 2, 2], 2, (1, 2, False)),
        ([1, 2, 1], 50, (2, 3, False)),
    ],
    ids=["at once", "repeats", "repeats at the last moment", "out of rounds", "in circles"],
)
def test_rounds_end_where_a_choice_repeats(
    successors: list[int], max_rounds: int, expected: tuple[float, int, bool]
) -> None:
    machine, n_rounds, converged = alternate(follow(successors), np.array([0]), max_rounds)

    assert (machine.intercept, n_rounds, converged) == expected


def test_a_solver_that_gave_up_did_not_converge() -> None:
    assert not alternate(follow([0], solved=False), np.array([0]), 5)[2]
