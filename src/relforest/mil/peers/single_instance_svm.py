"""The single-instance baseline: a support vector machine in which instances inherit their bag's label."""

from __future__ import annotations

from typing import TYPE_CHECKING, final

import numpy as np

from relforest.mil.bag_classifier import InstanceClassifier
from relforest.mil.peers.kernel_machine import KernelProblem, SolverSettings
from relforest.mil.peers.kernel_width import kernel_gamma
from relforest.scenes.bags import Bags
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray


@final
class SingleInstanceSVMClassifier(InstanceClassifier):
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
    classes_ : ndarray (2,)
        The two labels; ``classes_[1]`` is the positive class.
    n_features_in_ : int
        Dimension of the points.
    feature_names_in_ : ndarray (d,) of str
        Names of the columns, if bags were data frames with such names in `fit`.

    References
    ----------
    Ray and Craven (2005), Supervised versus multiple instance learning: an empirical comparison.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.peers import SingleInstanceSVMClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20] += 4
    >>> model = SingleInstanceSVMClassifier().fit(bags, [1] * 20 + [0] * 20)
    >>> model.predict(bags[[0, 30]])
    array([1, 0])
    """

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

    def _fit(self, bags: Bags, positive: NDArray[np.bool_]) -> None:
        shares = len(bags.points) if self.scale_C else 1
        settings = SolverSettings.checked(self.C, self.tol, self.max_solver_iter, shares=shares)
        gamma = kernel_gamma(bags.points, self.gamma, self.gamma_factor)
        problem = KernelProblem(bags.points, gamma, settings)
        report("training a machine")
        self.machine_, self.gamma_ = problem.solve(positive.repeat(bags.counts)), gamma
        self.converged_ = self.machine_.converged

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Value of the machine, with margins at -1 and 1."""
        return self.machine_.scores(points)
