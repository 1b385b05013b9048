"""Support vector machines with a radial kernel: what they share, and the one that ignores bags."""

from __future__ import annotations

import math
from abc import ABC
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.mil.bag_classifier import InstanceClassifier, WeightedBagClassifier
from relforest.mil.baselines.kernel_machine import KernelMachine, KernelProblem
from relforest.mil.baselines.kernel_width import kernel_gamma
from relforest.scenes.bags import Bags
from relforest.support.options import at_least, in_range
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(kw_only=True, eq=False, repr=False)
class KernelClassifier(WeightedBagClassifier, InstanceClassifier, ABC):
    """A classifier of instances by a `KernelMachine`; `SingleInstanceSVMClassifier` describes the options."""

    C: float = 1e4
    gamma: str | float = "heuristic"
    gamma_factor: float = 1.0
    scale_C: bool = True  # noqa: N815 - as published
    tol: float = 1e-3
    max_solver_iter: int = 10_000_000
    verbose: bool = False
    machine_: KernelMachine = field(init=False)

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


@final
class SingleInstanceSVMClassifier(KernelClassifier):
    """A machine with a radial kernel, trained on all instances with the labels of their bags.

    It shows the effect of ignoring bags, and is the first round of `InstanceMarginSVMClassifier`.

    Parameters
    ----------
    C : float, default 1e4
        Price of slack.
    gamma : "heuristic" or float, default "heuristic"
        Coefficient of squared distances in the kernel: a number, or 1 / (2 s^2) with s the mean of the 10th
        and 90th percentile of the distances between training instances (of a subset if there are more than
        3000).
    gamma_factor : float, default 1.0
        Factor of gamma.
    scale_C : bool, default True
        Whether C is divided by the number of instances.
    tol : float, default 1e-3
        Tolerance of LIBSVM.
    max_solver_iter : int, default 10_000_000
        Largest number of LIBSVM's steps.
    probability : bool, default False
        As in `CovAggClassifier`.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing, at most one line a second.

    Attributes
    ----------
    machine_ : KernelMachine
        Support vectors, coefficients and intercept.
    gamma_ : float
        The coefficient used, including the factor.
    converged_ : bool
        Whether LIBSVM reached its tolerance.

    References
    ----------
    Ray and Craven (2005), Supervised versus multiple instance learning: an empirical comparison.
    """

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        problem = self._problem(bags, bags.points, shares=len(bags.points))
        report("training a machine")
        self.machine_ = problem.solve(positive.repeat(bags.counts), weights.repeat(bags.counts))
        self.converged_ = self.machine_.converged
