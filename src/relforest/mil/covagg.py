"""Covariant aggregation as a scikit-learn classifier of bags."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self, final

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.validation import check_is_fitted

from relforest.scenes.bags import Bags, as_bags
from relforest.scenes.labels import binary_labels
from relforest.support.errors import InputError
from relforest.support.rng import RandomState, generator, seed_sequence
from relforest.volumes import CovAggSettings, Ellipsoid, aggregate

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from sklearn.utils import Tags


@final
class CovAggClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]  # scikit-learn is untyped
    """Multiple-instance classifier with one covariant, ellipsoidal decision volume.

    Parameters
    ----------
    window : int, default 8
        A: aggregation steps over which progress is judged.
    prior_weight : float, default 0.1
        w of eq. 3.5: weight of the spread of all positive bags' points.
    max_condition : float, default 1e5
        c of eq. 3.6: largest condition number of the covariance.
    restarts : int, default 4
        N: positive bags to start from.
    sampled : int, default 4
        M: bags tried at each step.
    random_state : int, SeedSequence, Generator or None, default None
        Seed of the sampling; an integer makes `fit` repeatable.

    Attributes
    ----------
    volume_ : Ellipsoid
        The decision volume: `mean`, `covariance` (V of eq. 3.6, which the radius refers to), `radius`.
    classes_ : ndarray (2,)
        The two labels; ``classes_[1]`` is the positive class.
    n_features_in_ : int
        Dimension of the points.

    Notes
    -----
    Bags may be a list of 2-D arrays, a tuple ``(X, bag_ids)`` whose labels follow the order in which
    bags first appear, a 3-D array (n_bags, size, d), or a 2-D array with one instance per bag.

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

    def __init__(
        self,
        *,
        window: int = 8,
        prior_weight: float = 0.1,
        max_condition: float = 1e5,
        restarts: int = 4,
        sampled: int = 4,
        random_state: RandomState = None,
    ) -> None:
        self.window = window
        self.prior_weight = prior_weight
        self.max_condition = max_condition
        self.restarts = restarts
        self.sampled = sampled
        self.random_state = random_state

    def fit(self, bags: object, y: ArrayLike) -> Self:
        """Learn the decision volume.

        Parameters
        ----------
        bags : bags in any of the accepted forms
        y : array-like (n_bags,)
            0/1, -1/+1, booleans or two strings.

        Raises
        ------
        InputError
            If bags or labels are malformed, or a parameter is out of range.
        """
        settings = CovAggSettings(
            self.window, self.prior_weight, self.max_condition, self.restarts, self.sampled
        )
        data = as_bags(bags)
        if y is None:
            msg = "requires y to be passed, but the target y is None"
            raise InputError(msg)
        labels = binary_labels(y, len(data.bag_ids), what="bags")
        rng = generator(seed_sequence(self.random_state))
        found = aggregate(data.points, data.starts, labels.positive, rng=rng, settings=settings)
        if found is None or not isinstance(found.volume, Ellipsoid):
            msg = "no volume was found although both classes are present; please report this"
            raise AssertionError(msg)
        self.classes_ = labels.classes
        self.n_features_in_ = data.points.shape[1]
        self.volume_ = found.volume
        return self

    def decision_function(self, bags: object) -> NDArray[np.float64]:
        """Radius minus the witness's distance, (n_bags,): >= 0 for bags predicted positive."""
        data, distances = self._distances(bags)
        nearest: NDArray[np.float64] = np.minimum.reduceat(distances, data.starts[:-1])
        return self.volume_.radius - nearest

    def predict(self, bags: object) -> NDArray[Any]:
        """Label of each bag, (n_bags,)."""
        inside = self.decision_function(bags) >= 0.0
        predicted: NDArray[Any] = self.classes_[inside.astype(np.int64)]
        return predicted

    def predict_instances(self, bags: object) -> list[NDArray[np.bool_]]:
        """Which instances of each bag lie in the volume (eq. 3.3): one bool array per bag."""
        data, distances = self._distances(bags)
        inside = np.empty(len(distances), dtype=np.bool_)
        # Instances come back in the caller's order within each bag.
        inside[data.starts[:-1].repeat(np.diff(data.starts)) + data.order] = distances <= self.volume_.radius
        return np.split(inside, data.starts[1:-1])

    def witness(self, bags: object) -> NDArray[np.int64]:
        """Row within each bag of its witness, the instance nearest to the volume (eq. 3.7); (n_bags,)."""
        data, distances = self._distances(bags)
        spans = zip(data.starts[:-1], data.starts[1:], strict=True)
        nearest = [begin + int(np.argmin(distances[begin:end])) for begin, end in spans]
        return np.asarray(data.order[nearest], dtype=np.int64)

    def _distances(self, bags: object) -> tuple[Bags, NDArray[np.float64]]:
        check_is_fitted(self)
        data = as_bags(bags)
        if data.points.shape[1] != self.n_features_in_:
            msg = (
                f"X has {data.points.shape[1]} features, but {type(self).__name__} is expecting "
                f"{self.n_features_in_} features as input"
            )
            raise InputError(msg)
        return data, self.volume_.distance(data.points)

    def __sklearn_tags__(self) -> Tags:
        """Binary only; the rest is scikit-learn's."""
        tags = super().__sklearn_tags__()
        tags.classifier_tags.multi_class = False
        return tags
