"""mi-SVM: a support vector machine on all instances, which imputes the labels in positive bags."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, final

import numpy as np

from relforest.mil.baselines.alternation import AlternatingClassifier, Round
from relforest.mil.baselines.kernel_machine import KernelMachine
from relforest.scenes.bags import Bags

if TYPE_CHECKING:
    from numpy.typing import NDArray


@final
class InstanceMarginSVMClassifier(AlternatingClassifier):
    """mi-SVM: a machine with a radial kernel that maximises the margin between instances.

    At first, all instances of positive bags are positive. Each round trains a machine and relabels these
    instances by the sign of its scores, except that the best instance of every positive bag stays positive;
    instances of negative bags are always negative. Rounds are repeated until the labels do not change.

    Parameters
    ----------
    scale_C : bool, default True
        Whether C is divided by the number of instances.
    max_iter : int, default 50
        Largest number of rounds.
    C, gamma, gamma_factor, tol, max_solver_iter, verbose
        As in `SingleInstanceSVMClassifier`.

    Attributes
    ----------
    machine_, gamma_
        As in `SingleInstanceSVMClassifier`.
    n_iter_ : int
        Number of rounds.
    converged_ : bool
        Whether the last labels equal those before and LIBSVM reached its tolerance. False also if rounds
        ended because earlier labels recurred.

    References
    ----------
    Andrews, Tsochantaridis and Hofmann (2002), Support vector machines for multiple-instance learning,
    section 3.
    Palmer (2015), section 3.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.baselines import InstanceMarginSVMClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> model = InstanceMarginSVMClassifier().fit(bags, [1] * 20 + [0] * 20)
    >>> model.predict(bags[[0, 30]])
    array([1, 0])
    """

    def _rounds(self, bags: Bags, positive: NDArray[np.bool_]) -> tuple[Round, NDArray[Any]]:
        problem = self._problem(bags, bags.points, shares=len(bags.points))
        may_be_positive = positive.repeat(bags.counts)

        def train_and_choose(labels: NDArray[np.bool_]) -> tuple[KernelMachine, NDArray[np.bool_]]:
            machine = problem.solve(labels)
            scores = problem.scores(machine)
            best = np.maximum.reduceat(scores, bags.starts[:-1]).repeat(bags.counts)
            return machine, may_be_positive & ((scores >= 0.0) | (scores == best))

        return train_and_choose, may_be_positive
