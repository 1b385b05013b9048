"""MI-SVM: a machine that separates a witness of every positive bag from all negative instances."""

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
class BagMarginSVMClassifier(InstanceClassifier):
    """MI-SVM: a machine with a radial kernel that maximises the margin between bags.

    Every positive bag is represented by one point: at first the mean of its instances, then the instance that
    the previous machine scores highest. All instances of negative bags are negative examples. Rounds are
    repeated until the choice does not change.

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
        Whether C is divided by the number of bags.
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
        Whether the last choice equals the one before and LIBSVM reached its tolerance. False also if rounds
        ended because an earlier choice recurred.
    classes_ : ndarray (2,)
        The two labels; ``classes_[1]`` is the positive class.
    n_features_in_ : int
        Dimension of the points.
    feature_names_in_ : ndarray (d,) of str
        Names of the columns, if bags were data frames with such names in `fit`.

    Notes
    -----
    LIBSVM gives every instance of a negative bag its own slack, whereas in Andrews et al. the instances of a
    bag share one. Slack is therefore more expensive for negative bags than for positive ones.

    If the means of bags are uninformative, the first choice, and thereby the last, depends on details of the
    solution: on the set Disjunctive of Palmer (2015), the mean Peirce skill score is about 0.2 with the
    default `tol` and 0.4 with 1e-6, which takes ten times as long.

    References
    ----------
    Andrews, Tsochantaridis and Hofmann (2002), Support vector machines for multiple-instance learning,
    section 4.
    Palmer (2015), section 3.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.peers import BagMarginSVMClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> model = BagMarginSVMClassifier().fit(bags, [1] * 20 + [0] * 20)
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
        shares = len(bags) if self.scale_C else 1
        settings = SolverSettings.checked(self.C, self.tol, self.max_solver_iter, shares=shares)
        gamma = kernel_gamma(bags.points, self.gamma, self.gamma_factor)
        is_candidate = positive.repeat(bags.counts)
        candidates = bags.points[is_candidate]
        counts = bags.counts[positive]
        starts = np.cumsum(counts) - counts
        means = np.add.reduceat(candidates, starts) / counts[:, np.newaxis]
        negatives = bags.points[~is_candidate]
        problem = KernelProblem(np.concatenate([negatives, means]), gamma, settings)
        labels = np.arange(len(negatives) + len(means)) >= len(negatives)

        def train_and_choose(witnesses: NDArray[np.int64]) -> tuple[KernelMachine, NDArray[np.int64]]:
            if len(witnesses):
                problem.replace_last(candidates[witnesses])
            machine = problem.solve(labels)
            return machine, _first_of_best(machine.scores(candidates), starts, counts)

        ended = alternate(train_and_choose, np.empty(0, dtype=np.int64), max_iter)
        self.machine_, self.gamma_ = ended.machine, gamma
        self.n_iter_, self.converged_ = ended.n_rounds, ended.converged

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Value of the machine, with margins at -1 and 1."""
        return self.machine_.scores(points)


def _first_of_best(
    scores: NDArray[np.float64], starts: NDArray[np.int64], counts: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the row of each bag's highest score, the first one in case of ties."""
    best = np.maximum.reduceat(scores, starts).repeat(counts)
    rows = np.where(scores == best, np.arange(len(scores)), len(scores))
    first: NDArray[np.int64] = np.minimum.reduceat(rows, starts)
    return first
