"""Covariant aggregation as a scikit-learn classifier of bags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.mil.bag_classifier import InstanceClassifier
from relforest.scenes.bags import Bags
from relforest.support.rng import RandomState, generator, seed_sequence
from relforest.volumes import Arc, CovAggSettings, Ellipsoid, Slab, aggregate
from relforest.volumes.settings import Shape, VolumeLearner

if TYPE_CHECKING:
    from numpy.typing import NDArray


@final
@dataclass(kw_only=True, eq=False, repr=False)
class CovAggClassifier(InstanceClassifier):
    """Multiple-instance classifier with a single ellipsoidal decision volume.

    Parameters
    ----------
    window : int, default 8
        A: number of aggregation steps over which progress is judged.
    prior_weight : float, default 0.1
        w of eq. 3.5: weight of the covariance of all points in positive bags, at most 1e6.
    max_condition : float, default 1e5
        c of eq. 3.6: upper bound of the covariance's condition number, at most 1e7.
    restarts : int, default 4
        N: number of positive bags to start from.
    sampled : int, default 4
        M: number of bags tried at each step.
    shape : {"full", "diagonal", "axis"}, default "full"
        What ellipsoids may be learned: any, those along the axes, or intervals of one feature only.
    learner : {"covagg", "diverse-density"}, default "covagg"
        Covariant aggregation, or the source's earlier learner (section 5.2.1), which does not use `window`.
    probability : bool, default False
        Whether `fit` also trains on parts of the bags, five times, to learn how scores become probabilities,
        which `predict_proba` returns.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed of the sampling; an integer makes `fit` reproducible.

    Attributes
    ----------
    volume_ : Ellipsoid or Slab
        The decision volume, with `mean`, `covariance` (V of eq. 3.6) and `radius` (measured by V). It is a
        `Slab`, the `interval` of one feature of several, only for the shape "axis".
    classes_ : (n_classes,) array
        The labels, sorted. Of two, ``classes_[1]`` is the positive class.
    estimators_ : tuple of CovAggClassifier
        Only if there are more than two classes: for each, one that tells it from the others. They have the
        attributes of what was learned, such as `volume_`, instead of this one.
    factor_ : float
        With `probability`: log odds are the scores times this factor.
    n_features_in_ : int
        Dimension of the points.
    feature_names_in_ : (d,) str
        Names of the columns, if bags were data frames with such names in `fit`.

    Notes
    -----
    Pass bags as a list of 2-D arrays, as a tuple ``(X, bag_ids)`` with labels in the order in which the bags
    first appear, as a 3-D array (n_bags, size, d), or as a 2-D array with one instance per bag. Data frames
    may replace 2-D arrays; `predict` then matches their columns by name.

    The covariance is a full (d, d) matrix, which prediction factorises: with 10 000 features, a fit takes 3
    seconds, a prediction 11, and each nearly 3 GB of memory.

    References
    ----------
    Palmer (2015), chapter 3; parameter defaults from section 3.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import CovAggClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
    >>> model = CovAggClassifier(random_state=0).fit(bags, [1] * 20 + [0] * 20)
    >>> model.predict(bags[[0, 30]])
    array([1, 0])
    """

    window: int = 8
    prior_weight: float = 0.1
    max_condition: float = 1e5
    restarts: int = 4
    sampled: int = 4
    shape: Shape = "full"
    learner: VolumeLearner = "covagg"
    random_state: RandomState = None

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        del weights
        settings = CovAggSettings(
            self.window,
            self.prior_weight,
            self.max_condition,
            self.restarts,
            self.sampled,
            self.shape,
            self.learner,
        )
        rng = generator(seed_sequence(self.random_state))
        self.volume_ = aggregated_volume(bags.points, bags.starts, positive, rng=rng, settings=settings)

    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Radius minus distance from the centre (eq. 3.3)."""
        return self.volume_.radius - self.volume_.distance(points)


def aggregated_volume(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    positive: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
    settings: CovAggSettings,
) -> Ellipsoid | Slab:
    """Return the best volume of `relforest.volumes.aggregate`, which exists if both classes do."""
    found = aggregate(points, starts, positive, rng=rng, settings=settings)
    if found is None or isinstance(found.volume, Arc):
        raise AssertionError("no volume was found although both classes are present; please report this")
    return found.volume
