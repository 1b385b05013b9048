"""The single-instance baseline: a support vector machine in which instances inherit their bag's label."""

from __future__ import annotations

from typing import TYPE_CHECKING, final

import numpy as np

from relforest.mil.baselines.kernel_classifier import KernelClassifier
from relforest.scenes.bags import Bags
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray


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

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.baselines import SingleInstanceSVMClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20] += 4
    >>> model = SingleInstanceSVMClassifier().fit(bags, [1] * 20 + [0] * 20)
    >>> model.predict(bags[[0, 30]])
    array([1, 0])
    """

    def _fit(self, bags: Bags, positive: NDArray[np.bool_]) -> None:
        problem = self._problem(bags, bags.points, shares=len(bags.points))
        report("training a machine")
        self.machine_ = problem.solve(positive.repeat(bags.counts))
        self.converged_ = self.machine_.converged
