"""EM-DD (Zhang and Goldman 2001) as a scikit-learn classifier of bags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.mil.baselines.hypotheses import DensityClassifier, search_space
from relforest.mil.baselines.noisy_or import CERTAINTY, Sample, fill_squared_distances
from relforest.mil.baselines.quasi_newton import descend
from relforest.support.jit import kernel
from relforest.support.options import at_least
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes.bags import Bags

_MOST_ROUNDS: Final = 10
_TOLERANCE: Final = 1e-5


@final
@dataclass(kw_only=True, eq=False, repr=False)
class EMDDClassifier(DensityClassifier):
    """Multiple-instance classifier by expectation maximisation of the diverse density.

    Like diverse density, but each bag is represented by one instance, its witness: the most probable one
    under the current hypothesis. Choosing witnesses and improving the hypothesis alternate.

    Parameters
    ----------
    scale : bool, default True
        Whether to divide each feature by its standard deviation over all training instances first.
    start_bags : int or None, default 3
        Number of randomly drawn positive bags from whose instances the search starts; None for all.
    max_steps : int, default 500
        Largest number of steps in an ascent.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed for drawing bags; an integer makes `fit` reproducible.
    probability : bool, default False
        Without effect: scores are log odds, so there are always probabilities.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing, at most one line a second.

    Attributes
    ----------
    centre_, scales_
        As in `DiverseDensityClassifier`.
    negative_log_density_ : float
        Negative logarithm of the diverse density of the witnesses.

    Notes
    -----
    Scores are log odds; `scipy.special.expit` converts them to probabilities. The probability of a bag is
    that of its best instance; a bag is positive if it is at least 1/2.

    A round consists of a choice of witnesses and an ascent. Rounds end when one brings no improvement, or
    after ten. The hypothesis with the fewest errors on the training bags is chosen, and of equally good ones
    that of the greatest density. Features that are constant in training are ignored. With `sample_weight`,
    densities and errors count a bag as often as it weighs; the search may start from any positive bag.

    Weka's MIEMDD, with which the source compares, also starts from three bags and counts errors. In 15 of 40
    draws of the set Disjunctive, it returned a start that was never improved (all scales exactly 1, mean PSS
    -0.01); in the other 25, it scored like this class. This may explain the low score of EM-DD on Disjunctive
    in the source: 0.19, compared with 0.35 for this class.

    References
    ----------
    Zhang and Goldman (2001), "EM-DD: an improved multiple-instance learning technique", NIPS 14; Palmer
    (2015), section 3.3, for the scaling.
    """

    start_bags: int | None = 3
    random_state: RandomState = None

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        max_steps = at_least("max_steps", self.max_steps, 1)
        rng = generator(seed_sequence(self.random_state))
        chosen = np.flatnonzero(positive)
        if self.start_bags is not None:
            n_chosen = min(at_least("start_bags", self.start_bags, 1), len(chosen))
            chosen = rng.choice(chosen, n_chosen, replace=False)
        search = search_space(bags, positive, weights, scale=self.scale)
        starts = search.starts(np.isin(np.arange(len(bags)), chosen))
        found, value = most_convincing(search.sample, starts, max_steps)
        self._keep(search.in_own_units(found), value)


def most_convincing(
    sample: Sample, starts: NDArray[np.float64], max_steps: int
) -> tuple[NDArray[np.float64], float]:
    """Run EM-DD from all starts.

    Parameters
    ----------
    sample : Sample
    starts : (n_starts, 2, d) float64
    max_steps : int
        Largest number of steps in an ascent.

    Returns
    -------
    ((2, d) float64, float)
        The hypothesis with the fewest errors, and its negative log density.
    """
    best, best_value, fewest = starts[0].copy(), np.inf, np.inf
    squared = np.empty(len(sample.points))
    for number, start in enumerate(starts):
        report("searching from instances", number, len(starts))
        hypothesis = start.copy()
        value = improve_by_rounds(sample, hypothesis, max_steps, squared)
        mistakes = count_mistakes(sample, hypothesis, squared)
        if mistakes < fewest or (mistakes == fewest and value < best_value):
            best, best_value, fewest = hypothesis, value, mistakes
    return best, best_value


@kernel
def improve_by_rounds(
    sample: Sample, hypothesis: NDArray[np.float64], max_steps: int, squared: NDArray[np.float64]
) -> float:
    """Improve a hypothesis (2, d) in place by rounds of EM; return its negative log density.

    `squared` (n,) is work space.
    """
    n_bags = len(sample.positive)
    places = np.arange(n_bags + 1)
    previous = np.full(n_bags, -1)
    best = np.inf
    for _ in range(_MOST_ROUNDS):
        chosen = witnesses(sample, hypothesis, squared)
        if np.array_equal(chosen, previous):
            break
        points = sample.points[chosen]
        improved = hypothesis.copy()
        columns = np.ascontiguousarray(points.T)
        own = Sample(points, columns, places, sample.positive, sample.weights)
        value = descend(own, improved, max_steps, _TOLERANCE)
        if not value < best:
            break
        best, previous = value, chosen
        hypothesis[:] = improved
    return best


@kernel
def witnesses(
    sample: Sample, hypothesis: NDArray[np.float64], squared: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Most probable point of each bag, the first one in case of ties; `squared` (n,) is work space."""
    fill_squared_distances(sample.columns, hypothesis, squared)
    chosen = np.empty(len(sample.positive), dtype=np.int64)
    for bag in range(len(chosen)):
        first = sample.starts[bag]
        chosen[bag] = first + np.argmin(squared[first : sample.starts[bag + 1]])
    return chosen


@kernel
def count_mistakes(sample: Sample, hypothesis: NDArray[np.float64], squared: NDArray[np.float64]) -> float:
    """Sum the weights of bags that a hypothesis (2, d) labels wrongly; `squared` (n,) is work space."""
    chosen = witnesses(sample, hypothesis, squared)
    within = squared[chosen] <= np.log(2.0 * CERTAINTY)
    return float(np.sum(sample.weights[within != sample.positive]))
