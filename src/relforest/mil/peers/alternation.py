"""Rounds of training a machine and choosing, by its scores, the training data of the next one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mil.peers.kernel_machine import KernelMachine


@final
@dataclass(frozen=True, slots=True)
class Alternation:
    """The result of the last round.

    Attributes
    ----------
    machine : KernelMachine
        Machine of the last round.
    n_rounds : int
        Number of machines trained.
    converged : bool
        Whether the last machine chose its own training data, and its solver reached its tolerance.
    """

    machine: KernelMachine
    n_rounds: int
    converged: bool


def alternate(
    train_and_choose: Callable[[NDArray[Any]], tuple[KernelMachine, NDArray[Any]]],
    choice: NDArray[Any],
    max_rounds: int,
) -> Alternation:
    """Train and choose until a choice repeats.

    Parameters
    ----------
    train_and_choose : callable
        Takes a choice, an array; returns the machine trained on it and the choice made by this machine.
    choice : array
        The first choice.
    max_rounds : int
        Largest number of machines to train, at least 1.

    Returns
    -------
    Alternation
        Converged only if the last two choices are equal. Rounds also end, without convergence, if an earlier
        choice recurs, since they would repeat from there.
    """
    seen = {choice.tobytes()}
    number = 1
    while True:
        report("training machines: rounds", number - 1, max_rounds)
        machine, chosen = train_and_choose(choice)
        if np.array_equal(chosen, choice):
            return Alternation(machine, number, machine.converged)
        if number == max_rounds or chosen.tobytes() in seen:
            return Alternation(machine, number, converged=False)
        seen.add(chosen.tobytes())
        choice = chosen
        number += 1
