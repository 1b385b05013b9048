"""Rounds of training a machine and choosing by its scores what the next one is trained on."""

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
    """How rounds ended.

    Attributes
    ----------
    machine : KernelMachine
        Of the last round.
    n_rounds : int
        Machines trained.
    converged : bool
        Whether the last machine chose what it was trained on, and its solver reached its tolerance.
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
        From a choice, an array, to the machine trained on it and the choice that this machine makes.
    choice : array
        To start from.
    max_rounds : int
        Most machines to train, at least 1.

    Returns
    -------
    Alternation
        Converged only if the last two choices are equal; rounds also end, without convergence, where a choice
        was made before the last two, from where they would go round in circles.
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
