"""What the support vector machines with a radial kernel share: their options and scores."""

from __future__ import annotations

import math
from abc import ABC
from typing import TYPE_CHECKING

from relforest.mil.bag_classifier import InstanceClassifier
from relforest.mil.baselines.kernel_machine import KernelMachine, KernelProblem
from relforest.mil.baselines.kernel_width import kernel_gamma
from relforest.scenes.bags import Bags
from relforest.support.options import at_least, in_range

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class KernelClassifier(InstanceClassifier, ABC):
    """A classifier of instances by a `KernelMachine`; `SingleInstanceSVMClassifier` describes the options."""

    machine_: KernelMachine

    def __init__(
        self,
        *,
        C: float = 1e4,
        gamma: str | float = "heuristic",
        gamma_factor: float = 1.0,
        scale_C: bool = True,
        tol: float = 1e-3,
        max_solver_iter: int = 10_000_000,
        verbose: bool = False,
    ) -> None:
        self.C = C
        self.gamma = gamma
        self.gamma_factor = gamma_factor
        self.scale_C = scale_C
        self.tol = tol
        self.max_solver_iter = max_solver_iter
        self.verbose = verbose

    @property
    def gamma_(self) -> float:
        """The coefficient used, including the factor."""
        return self.machine_.gamma

    def _problem(self, bags: Bags, points: NDArray[np.float64], *, shares: int) -> KernelProblem:
        """Check the options, and return the problem of training on points, with C divided by `shares`."""
        price = in_range("C", self.C, 0.0, math.inf, open_low=True, open_high=True)
        return KernelProblem(
            points,
            kernel_gamma(bags.points, self.gamma, self.gamma_factor),
            C=price / shares if self.scale_C else price,
            tol=in_range("tol", self.tol, 0.0, math.inf, open_low=True, open_high=True),
            max_iter=at_least("max_solver_iter", self.max_solver_iter, 1),
        )

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Value of the machine, with margins at -1 and 1."""
        return self.machine_.scores(points)
