"""The optimal ball (Auer and Ortner 2004) as a scikit-learn classifier of bags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np
from scipy.spatial.distance import cdist

from relforest.mil.bag_classifier import InstanceClassifier, WeightedBagClassifier
from relforest.mil.scaling import feature_units

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes.bags import Bags

# Distances kept at a time, 64 MiB.
_LARGEST_TABLE: Final = 2**23
_BEYOND_LAST: Final = 1.0 + 1e-9
_DECIMALS: Final = 9


@final
@dataclass(kw_only=True, eq=False, repr=False)
class OptimalBallClassifier(WeightedBagClassifier, InstanceClassifier):
    """Multiple-instance classifier by the ball that labels most training bags correctly.

    A bag is positive if one of its instances is in the ball. The centre is an instance of a positive bag; all
    centres and radii are tried.

    Parameters
    ----------
    normalize : bool, default True
        Whether to map the range of each feature over all training instances to [0, 1] first.
    probability : bool, default False
        As in `CovAggClassifier`.

    Attributes
    ----------
    centre_ : (d,) float64
        The centre, in the units of the bags.
    scales_ : (d,) float64
        Scales of distances: the distance of x is ``np.linalg.norm(scales_ * (x - centre_))``. All 1 without
        normalisation; with it, 1 / range, and 0 for features that are constant in training.
    radius_ : float
        Largest distance of a point inside.

    Notes
    -----
    For each centre, only the nearest instance of each bag matters. A radius is midway between two successive
    distances of bags, or slightly larger than the last. Of equally good balls, the one with the largest
    radius is chosen, then the first centre in lexicographic order. This is the algorithm without boosting;
    Weka's MIOptimalBall, with which the source compares, also normalises and chooses the largest radius.

    References
    ----------
    Auer and Ortner (2004), "A boosting approach to multiple instance learning", ECML; Palmer (2015),
    section 3.3.
    """

    normalize: bool = True

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        units = feature_units(bags.points, "minmax")
        scales = units.factors if self.normalize else np.ones(bags.dim)
        candidates = np.unique(bags.points[np.repeat(positive, bags.counts)], axis=0)
        points = (bags.points - units.shift) * scales
        centres = (candidates - units.shift) * scales
        most, radius, best = -1.0, 0.0, 0
        at_a_time = max(1, _LARGEST_TABLE // len(points))
        for first in range(0, len(centres), at_a_time):
            distances = cdist(centres[first : first + at_a_time], points)
            nearest = np.minimum.reduceat(distances, bags.starts[:-1], axis=1)
            right, width, place = widest_best_ball(nearest, positive, weights)
            if (right, width) > (most, radius):
                most, radius, best = right, width, first + place
        self.centre_, self.scales_, self.radius_ = candidates[best], scales, radius

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Radius minus distance from the centre."""
        distances: NDArray[np.float64] = np.linalg.norm(self.scales_ * (points - self.centre_), axis=1)
        return self.radius_ - distances


def widest_best_ball(
    nearest: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64]
) -> tuple[float, float, int]:
    """Find the ball that labels most bags correctly; in case of ties, the largest and then the first.

    Parameters
    ----------
    nearest : (n_centres, n_bags) float64
        Distances of the bags.
    positive : (n_bags,) bool
    weights : (n_bags,) float64
        How much each bag counts.

    Returns
    -------
    (float, float, int)
        The number of bags labelled correctly, the radius, and the row of the centre.
    """
    order = np.argsort(nearest, axis=1)
    edges = np.take_along_axis(nearest, order, axis=1)
    beyond = np.column_stack([edges[:, 1:], edges[:, -1] * _BEYOND_LAST])
    # With all bags outside, the negative ones are labelled correctly.
    right = weights[~positive].sum() + np.cumsum(np.where(positive, weights, -weights)[order], axis=1)
    # Sums of the same weights in another order are equal.
    right = np.round(right, _DECIMALS)
    # Bags at equal distances cannot be parted.
    right[:, :-1][edges[:, :-1] == edges[:, 1:]] = -1.0
    most = float(right.max())
    radii = np.where(right == most, 0.5 * (edges + beyond), -1.0)
    best = int(radii.max(axis=1).argmax())
    return most, float(radii[best].max()), best
