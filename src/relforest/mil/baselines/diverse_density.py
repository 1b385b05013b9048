"""Diverse density (Maron and Lozano-Perez 1997) as a scikit-learn classifier of bags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.mil.baselines.hypotheses import DensityClassifier, search_space
from relforest.mil.baselines.noisy_or import Sample, bag_log_odds
from relforest.mil.baselines.quasi_newton import descend
from relforest.support.options import at_least
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes.bags import Bags

_FIRST_STEPS: Final = 10
_FIRST_TOLERANCE: Final = 1e-3
_TOLERANCE: Final = 1e-5


@final
@dataclass(kw_only=True, eq=False, repr=False)
class DiverseDensityClassifier(DensityClassifier):
    """Multiple-instance classifier by the point of greatest diverse density.

    Gradient ascent from many starts looks for a point, with a scale per feature, near at least one instance
    of every positive bag and far from all instances of negative bags.

    Parameters
    ----------
    scale : bool, default True
        Whether to divide each feature by its standard deviation over all training instances first.
    refined : int or None, default 10
        Number of starts, the best after 10 steps, from which the ascent is completed; None for all.
    max_steps : int, default 500
        Largest number of steps in an ascent.
    probability : bool, default False
        Without effect: scores are log odds, so there are always probabilities.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing, at most one line a second.

    Attributes
    ----------
    centre_ : (d,) float64
        The point, in the units of the bags.
    scales_ : (d,) float64
        Scale of each feature, at least 0: an instance x is positive with a probability of
        ``exp(-((scales_ * (x - centre_)) ** 2).sum())``.
    negative_log_density_ : float
        Negative logarithm of the diverse density, the probability of all training labels.

    Notes
    -----
    Scores are log odds; `scipy.special.expit` converts them to probabilities. A bag is positive if the
    noisy-or of its instances is at least 1/2. Several less probable instances can reach this together, so a
    positive bag may have no positive instance.

    The starts are the distinct instances of the largest positive bag (or bags, in case of ties), as in Weka's
    MIDD, with which the source compares. Features that are constant in training are ignored. With
    `sample_weight`, a bag counts as often as it weighs.

    References
    ----------
    Maron and Lozano-Perez (1997), "A framework for multiple-instance learning", NIPS 10; Palmer (2015),
    section 3.3, for the scaling.
    """

    refined: int | None = 10

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        max_steps = at_least("max_steps", self.max_steps, 1)
        if self.refined is not None:
            at_least("refined", self.refined, 1)
        search = search_space(bags, positive, weights, scale=self.scale)
        starts = search.starts(positive & (bags.counts == bags.counts[positive].max()))
        kept = len(starts) if self.refined is None else min(self.refined, len(starts))
        found, value = densest(search.sample, starts, kept, max_steps)
        self._keep(search.in_own_units(found), value)

    def _bag_scores(self, bags: Bags) -> NDArray[np.float64]:
        """Log odds of the noisy-or."""
        return bag_log_odds(self._squared_distances(bags.points), bags.starts)


def densest(
    sample: Sample, starts: NDArray[np.float64], kept: int, max_steps: int
) -> tuple[NDArray[np.float64], float]:
    """Take a few steps from all starts, and complete the ascent from the best of them.

    Parameters
    ----------
    sample : Sample
    starts : (n_starts, 2, d) float64
    kept : int
        Number of ascents to complete, at most n_starts.
    max_steps : int
        Largest number of steps in an ascent.

    Returns
    -------
    ((2, d) float64, float)
        The best hypothesis and its negative log density.
    """
    values = np.full(kept, np.inf)
    hypotheses = starts[:kept].copy()
    first_steps = min(_FIRST_STEPS, max_steps)
    for number, start in enumerate(starts):
        report("first steps from instances", number, len(starts))
        hypothesis = start.copy()
        value = descend(sample, hypothesis, first_steps, _FIRST_TOLERANCE)
        worst = int(np.argmax(values))
        if value < values[worst]:
            values[worst] = value
            hypotheses[worst] = hypothesis
    for i in range(kept):
        report("climbing from the best starts", i, kept)
        values[i] = descend(sample, hypotheses[i], max_steps - first_steps, _TOLERANCE)
    best = int(np.argmin(values))
    return hypotheses[best], float(values[best])
