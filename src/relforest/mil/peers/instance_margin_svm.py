"""mi-SVM: a support vector machine on all instances, which imputes the labels in positive bags."""

from __future__ import annotations

from typing import TYPE_CHECKING, final

import numpy as np

from relforest.mil.bag_classifier import InstanceClassifier
from relforest.mil.peers.alternation import alternate
from relforest.mil.peers.kernel_machine import KernelMachine, KernelProblem, SolverSettings
from relforest.mil.peers.kernel_width import kernel_gamma
from relforest.scenes.bags import Bags
from relforest.support.options import at_least

if TYPE_CHECKING:
    from numpy.typing import NDArray


@final
class InstanceMarginSVMClassifier(InstanceClassifier):
    """mi-SVM: a machine with a radial kernel that maximises the margin between instances.

    At first, all instances of positive bags are positive. Each round trains a machine and relabels these
    instances by the sign of its scores, except that the best instance of every positive bag stays positive;
    instances of negative bags are always negative. Rounds are repeated until the labels do not change.

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
    max_iter : int, default 50
        Largest number of rounds.
    tol : float, default 1e-3
        Tolerance of LIBSVM.
    max_solver_iter : int, default 10_000_000
        Largest number of LIBSVM's steps in a round.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing, at most one line a second.

    Attributes
    ----------
    machine_ : KernelMachine
        Support vectors, coefficients and intercept.
    gamma_ : float
        The coefficient used, including the factor.
    n_iter_ : int
        Number of rounds.
    converged_ : bool
        Whether the last labels equal those before and LIBSVM reached its tolerance. False also if rounds
        ended because earlier labels recurred.
    classes_ : ndarray (2,)
        The two labels; ``classes_[1]`` is the positive class.
    n_features_in_ : int
        Dimension of the points.
    feature_names_in_ : ndarray (d,) of str
        Names of the columns, if bags were data frames with such names in `fit`.

    References
    ----------
    Andrews, Tsochantaridis and Hofmann (2002), Support vector machines for multiple-instance learning,
    section 3.
    Palmer (2015), section 3.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.peers import InstanceMarginSVMClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> model = InstanceMarginSVMClassifier().fit(bags, [1] * 20 + [0] * 20)
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
        max_iter: int = 50,
        tol: float = 1e-3,
        max_solver_iter: int = 10_000_000,
        verbose: bool = False,
    ) -> None:
        self.C = C
        self.gamma = gamma
        self.gamma_factor = gamma_factor
        self.scale_C = scale_C
        self.max_iter = max_iter
        self.tol = tol
        self.max_solver_iter = max_solver_iter
        self.verbose = verbose

    def _fit(self, bags: Bags, positive: NDArray[np.bool_]) -> None:
        max_iter = at_least("max_iter", self.max_iter, 1)
        shares = len(bags.points) if self.scale_C else 1
        settings = SolverSettings.checked(self.C, self.tol, self.max_solver_iter, shares=shares)
        gamma = kernel_gamma(bags.points, self.gamma, self.gamma_factor)
        problem = KernelProblem(bags.points, gamma, settings)
        may_be_positive = positive.repeat(bags.counts)

        def train_and_choose(labels: NDArray[np.bool_]) -> tuple[KernelMachine, NDArray[np.bool_]]:
            machine = problem.solve(labels)
            scores = problem.scores(machine)
            best = np.maximum.reduceat(scores, bags.starts[:-1]).repeat(bags.counts)
            return machine, may_be_positive & ((scores >= 0.0) | (scores == best))

        ended = alternate(train_and_choose, may_be_positive, max_iter)
        self.machine_, self.gamma_ = ended.machine, gamma
        self.n_iter_, self.converged_ = ended.n_rounds, ended.converged

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Value of the machine, with margins at -1 and 1."""
        return self.machine_.scores(points)
