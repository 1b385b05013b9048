"""The optimal ball (Auer and Ortner 2004) as a scikit-learn classifier of bags."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.mil.bag_classifier import InstanceClassifier
from relforest.mil.scaling import feature_units
from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes.bags import Bags

# Points in a block: with their features, they fit into the processor's cache.
_BLOCK: Final = 256
# Distances kept at a time, 64 MiB.
_LARGEST_TABLE: Final = 2**23
_BEYOND_LAST: Final = 1.0 + 1e-9


@final
class OptimalBallClassifier(InstanceClassifier):
    """Multiple-instance classifier by the ball that labels most training bags correctly.

    A bag is positive if one of its instances is in the ball. The centre is an instance of a positive bag; all
    centres and radii are tried.

    Parameters
    ----------
    normalize : bool, default True
        Whether to map the range of each feature over all training instances to [0, 1] first.

    Attributes
    ----------
    center_ : ndarray (d,)
        The centre, in the units of the bags.
    scales_ : ndarray (d,)
        Scales of distances: the distance of x is ``np.linalg.norm(scales_ * (x - center_))``. All 1 without
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

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil.peers import OptimalBallClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> model = OptimalBallClassifier().fit(bags, [1] * 20 + [0] * 20)
    >>> model.predict(bags[[0, 30]])
    array([1, 0])
    """

    center_: NDArray[np.float64]
    scales_: NDArray[np.float64]
    radius_: float

    def __init__(self, *, normalize: bool = True) -> None:
        self.normalize = normalize

    def _fit(self, bags: Bags, positive: NDArray[np.bool_]) -> None:
        units = feature_units(bags.points, "minmax")
        scales = units.factors if self.normalize else np.ones(bags.dim)
        candidates = np.unique(bags.points[np.repeat(positive, bags.counts)], axis=0)
        points = (bags.points - units.shift) * scales
        centres = (candidates - units.shift) * scales
        columns = np.ascontiguousarray(points.T)
        most, radius, best = -1, 0.0, 0
        at_a_time = max(1, _LARGEST_TABLE // len(bags))
        for first in range(0, len(centres), at_a_time):
            nearest = bag_distances(columns, bags.starts, centres[first : first + at_a_time])
            right, width, place = widest_best_ball(nearest, positive)
            if (right, width) > (most, radius):
                most, radius, best = right, width, first + place
        self.center_, self.scales_, self.radius_ = candidates[best], scales, radius

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Radius minus distance from the centre."""
        distances: NDArray[np.float64] = np.linalg.norm(self.scales_ * (points - self.center_), axis=1)
        return self.radius_ - distances


@kernel
def bag_distances(
    columns: NDArray[np.float64], starts: NDArray[np.int64], centres: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distance from every centre to the nearest point of every bag.

    Parameters
    ----------
    columns : ndarray (d, n)
        The points of all bags, transposed.
    starts : ndarray (n_bags + 1,)
        First point of each bag.
    centres : ndarray (n_centres, d)

    Returns
    -------
    ndarray (n_centres, n_bags)
    """
    n_features, n_points = columns.shape
    nearest = np.full((len(centres), len(starts) - 1), np.inf)
    squared = np.empty(_BLOCK)
    first_bag = 0
    for begin in range(0, n_points, _BLOCK):
        end = min(begin + _BLOCK, n_points)
        block = columns[:, begin:end].copy()
        while starts[first_bag + 1] <= begin:
            first_bag += 1
        for i in range(len(centres)):
            squared[:] = 0.0
            for k in range(n_features):
                column, centre = block[k], centres[i, k]
                for j in range(end - begin):
                    squared[j] += (column[j] - centre) * (column[j] - centre)
            bag = first_bag
            for j in range(end - begin):
                if starts[bag + 1] == begin + j:
                    bag += 1
                nearest[i, bag] = min(nearest[i, bag], squared[j])
    distances: NDArray[np.float64] = np.sqrt(nearest)
    return distances


@kernel
def widest_best_ball(nearest: NDArray[np.float64], positive: NDArray[np.bool_]) -> tuple[int, float, int]:
    """Find the ball that labels most bags correctly; in case of ties, the largest and then the first.

    Parameters
    ----------
    nearest : ndarray (n_centres, n_bags)
        Distances of the bags.
    positive : bool ndarray (n_bags,)

    Returns
    -------
    (int, float, int)
        The number of bags labelled correctly, the radius, and the row of the centre.
    """
    n_bags = len(positive)
    best, radius, most = 0, -1.0, -1
    for i in range(len(nearest)):
        distances = nearest[i]
        order = np.argsort(distances)
        # A cut with all bags outside labels the negative ones correctly.
        right = n_bags - int(np.sum(positive))
        for j in range(n_bags):
            right += 1 if positive[order[j]] else -1
            edge = distances[order[j]]
            beyond = distances[order[j + 1]] if j + 1 < n_bags else edge * _BEYOND_LAST
            if j + 1 < n_bags and beyond == edge:
                continue
            cut = 0.5 * (edge + beyond)
            if right > most or (right == most and cut > radius):
                best, radius, most = i, cut, right
    return most, radius, best
