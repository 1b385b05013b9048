"""MI-SVM and mi-SVM: support vector machines that choose witnesses, or the labels of instances, in rounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

import numpy as np

from relforest.mil.baselines.alternation import AlternatingClassifier, Round
from relforest.mil.baselines.kernel_machine import KernelMachine
from relforest.scenes.bags import Bags

if TYPE_CHECKING:
    from numpy.typing import NDArray


@final
class BagMarginSVMClassifier(AlternatingClassifier):
    """MI-SVM: a machine with a radial kernel that maximises the margin between bags.

    Every positive bag is represented by one point: at first the mean of its instances, then the instance that
    the previous machine scores highest. All instances of negative bags are negative examples. Rounds are
    repeated until the choice does not change.

    Parameters
    ----------
    scale_C : bool, default True
        Whether C is divided by the number of bags.
    max_iter : int, default 50
        Largest number of rounds.
    C, gamma, gamma_factor, tol, max_solver_iter, probability, verbose
        As in `SingleInstanceSVMClassifier`.

    Attributes
    ----------
    machine_, gamma_
        As in `SingleInstanceSVMClassifier`.
    n_iter_ : int
        Number of rounds.
    converged_ : bool
        Whether the last choice equals the one before and LIBSVM reached its tolerance. False also if rounds
        ended because an earlier choice recurred.

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
    """

    def _rounds(
        self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]
    ) -> tuple[Round, NDArray[Any]]:
        is_candidate = positive.repeat(bags.counts)
        candidates = bags.points[is_candidate]
        counts = bags.counts[positive]
        starts = np.cumsum(counts) - counts
        means = np.add.reduceat(candidates, starts) / counts[:, np.newaxis]
        negatives = bags.points[~is_candidate]
        problem = self._problem(bags, np.concatenate([negatives, means]), shares=len(bags))
        labels = np.arange(len(negatives) + len(means)) >= len(negatives)
        shares = np.concatenate([weights.repeat(bags.counts)[~is_candidate], weights[positive]])

        def train_and_choose(witnesses: NDArray[np.int64]) -> tuple[KernelMachine, NDArray[np.int64]]:
            if len(witnesses):
                problem.replace_last(candidates[witnesses])
            machine = problem.solve(labels, shares)
            return machine, _first_of_best(machine.scores(candidates), starts, counts)

        return train_and_choose, np.empty(0, dtype=np.int64)


@final
class InstanceMarginSVMClassifier(AlternatingClassifier):
    """mi-SVM: a machine with a radial kernel that maximises the margin between instances.

    At first, all instances of positive bags are positive. Each round trains a machine and relabels these
    instances by the sign of its scores, except that the best instance of every positive bag stays positive;
    instances of negative bags are always negative. Rounds are repeated until the labels do not change.

    Parameters and attributes are those of `BagMarginSVMClassifier`, but C is divided by the number of
    instances.

    References
    ----------
    Andrews, Tsochantaridis and Hofmann (2002), Support vector machines for multiple-instance learning,
    section 3.
    Palmer (2015), section 3.3.
    """

    def _rounds(
        self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]
    ) -> tuple[Round, NDArray[Any]]:
        problem = self._problem(bags, bags.points, shares=len(bags.points))
        may_be_positive = positive.repeat(bags.counts)
        shares = weights.repeat(bags.counts)

        def train_and_choose(labels: NDArray[np.bool_]) -> tuple[KernelMachine, NDArray[np.bool_]]:
            machine = problem.solve(labels, shares)
            scores = problem.scores(machine)
            best = np.maximum.reduceat(scores, bags.starts[:-1]).repeat(bags.counts)
            return machine, may_be_positive & ((scores >= 0.0) | (scores == best))

        return train_and_choose, may_be_positive


def _first_of_best(
    scores: NDArray[np.float64], starts: NDArray[np.int64], counts: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the row of each bag's highest score, the first one in case of ties."""
    best = np.maximum.reduceat(scores, starts).repeat(counts)
    rows = np.where(scores == best, np.arange(len(scores)), len(scores))
    first: NDArray[np.int64] = np.minimum.reduceat(rows, starts)
    return first
