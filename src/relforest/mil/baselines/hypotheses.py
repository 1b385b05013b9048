"""Hypotheses of diverse density: classifying by one, and the scaled data in which they are sought."""

from __future__ import annotations

from abc import ABC
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

import numpy as np

from relforest.mil.bag_classifier import InstanceClassifier, WeightedBagClassifier
from relforest.mil.baselines.noisy_or import Sample, as_sample, fill_squared_distances, instance_log_odds
from relforest.mil.scaling import feature_units

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes.bags import Bags


@dataclass(kw_only=True, eq=False, repr=False)
class DensityClassifier(WeightedBagClassifier, InstanceClassifier, ABC):
    """A classifier by the hypothesis with the greatest density; `DiverseDensityClassifier` describes it."""

    _scores_are_log_odds: ClassVar[bool] = True

    scale: bool = True
    max_steps: int = 500
    verbose: bool = False

    def _keep(self, hypothesis: NDArray[np.float64], negative_log_density: float) -> None:
        """Set what was learned: a hypothesis (2, d) in the units of the bags."""
        self.centre_: NDArray[np.float64] = hypothesis[0]
        self.scales_: NDArray[np.float64] = hypothesis[1]
        self.negative_log_density_ = negative_log_density

    def _squared_distances(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Squared distances D^2, (n,), of points (n, d)."""
        squared = np.empty(len(points))
        hypothesis = np.stack([self.centre_, self.scales_])
        fill_squared_distances(np.ascontiguousarray(points.T), hypothesis, squared)
        return squared

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Log odds, log(p / (1 - p))."""
        return instance_log_odds(self._squared_distances(points))


@final
@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """Training bags, with features scaled for the search.

    Attributes
    ----------
    sample : Sample
    shift : (d,) float64
        Values subtracted from the features, so that large offsets do not cost digits.
    factors : (d,) float64
        Factors of the shifted features; 0 for constant features.
    """

    sample: Sample
    shift: NDArray[np.float64]
    factors: NDArray[np.float64]

    def starts(self, in_bags: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Hypotheses (n_starts, 2, d) at the distinct instances of some of the bags, with scales of 1."""
        rows = np.repeat(in_bags, np.diff(self.sample.starts))
        centres = np.unique(self.sample.points[rows], axis=0)
        # Constant features are uninformative, and must not affect predictions either.
        scales = np.broadcast_to(np.where(self.factors > 0.0, 1.0, 0.0), centres.shape)
        return np.stack([centres, scales], axis=1)

    def in_own_units(self, found: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert a hypothesis (2, d) of this search to the units of the bags."""
        widths = np.divide(1.0, self.factors, out=np.zeros_like(self.factors), where=self.factors > 0.0)
        return np.stack([self.shift + found[0] * widths, np.abs(found[1]) * self.factors])


def search_space(
    bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64], *, scale: bool
) -> Search:
    """Prepare labelled bags, dividing features by their standard deviations if `scale` is true."""
    units = feature_units(bags.points, "standard")
    varies = units.width > 0.0
    shift = np.where(varies, units.shift, bags.points[0])
    factors = units.factors if scale else np.where(varies, 1.0, 0.0)
    sample = as_sample((bags.points - shift) * factors, bags.starts, positive, weights)
    return Search(sample, shift, factors)
