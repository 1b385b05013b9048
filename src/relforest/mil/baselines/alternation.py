"""Rounds of training a machine and choosing, by its scores, the training data of the next one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from relforest.mil.baselines.kernel_classifier import KernelClassifier
from relforest.mil.baselines.kernel_machine import KernelMachine
from relforest.scenes.bags import Bags
from relforest.support.options import at_least
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Takes a choice, an array; returns the machine trained on it and the choice made by this machine.
Round: TypeAlias = "Callable[[NDArray[Any]], tuple[KernelMachine, NDArray[Any]]]"


@dataclass(kw_only=True, eq=False, repr=False)
class AlternatingClassifier(KernelClassifier, ABC):
    """A classifier whose machine is trained in rounds, until it chooses its own training data."""

    max_iter: int = 50

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        max_rounds = at_least("max_iter", self.max_iter, 1)
        train_and_choose, choice = self._rounds(bags, positive, weights)
        self.machine_, self.n_iter_, self.converged_ = alternate(train_and_choose, choice, max_rounds)

    @abstractmethod
    def _rounds(
        self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]
    ) -> tuple[Round, NDArray[Any]]:
        """Return what to do in a round, and the first choice."""


def alternate(
    train_and_choose: Round, choice: NDArray[Any], max_rounds: int
) -> tuple[KernelMachine, int, bool]:
    """Train and choose until a choice repeats.

    Parameters
    ----------
    train_and_choose : callable
        A round.
    choice : array
        The first choice.
    max_rounds : int
        Largest number of machines to train, at least 1.

    Returns
    -------
    (KernelMachine, int, bool)
        The last machine, the number of machines trained, and whether the last one chose its own training data
        and its solver reached its tolerance. Rounds also end, without convergence, if an earlier choice
        recurs, since they would repeat from there.
    """
    seen = {choice.tobytes()}
    number = 1
    while True:
        report("training machines: rounds", number - 1, max_rounds)
        machine, chosen = train_and_choose(choice)
        if np.array_equal(chosen, choice):
            return machine, number, machine.converged
        if number == max_rounds or chosen.tobytes() in seen:
            return machine, number, False
        seen.add(chosen.tobytes())
        choice = chosen
        number += 1
