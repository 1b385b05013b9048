"""What all classifiers of bags share: input checks, binary labels, scores with a threshold of 0."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.validation import check_is_fitted

from relforest.mil.feature_names import columns_as_in_fit, remember_columns
from relforest.scenes.bags import Bags, as_bags, own_labels
from relforest.scenes.labels import binary_labels
from relforest.support.blas import one_blas_thread
from relforest.support.errors import InputError
from relforest.support.progress import printed_to_stderr

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from sklearn.utils import Tags


class BagClassifier(ClassifierMixin, BaseEstimator, ABC):  # type: ignore[misc]  # scikit-learn is untyped
    """A binary classifier of bags of points with scikit-learn's interface.

    Subclasses implement learning (`_fit`) and the scores of bags (`_bag_scores`). `CovAggClassifier` tells
    which forms of bags are accepted, and which attributes `fit` sets.
    """

    classes_: NDArray[Any]
    n_features_in_: int

    def fit(self, bags: object, y: ArrayLike | None = None) -> Self:
        """Learn from labelled bags.

        Parameters
        ----------
        bags : bags in any of the accepted forms
        y : (n_bags,) array-like
            0/1, -1/+1, booleans or two strings; the larger label is the positive class. May be omitted for a
            `relforest.datasets.BagSet`, which contains labels.

        Raises
        ------
        InputError
            If bags or labels are malformed, or a parameter is out of range.
        """
        data = as_bags(bags)
        if y is None:
            y = own_labels(bags)
        if y is None:
            raise InputError("requires y to be passed, but the target y is None: give each bag a label")
        classes, positive = binary_labels(y, len(data), what="bags")
        # Several threads would add in another order, and round differently on other machines.
        with one_blas_thread(), printed_to_stderr(getattr(self, "verbose", False)):
            self._fit(data, positive)
        self.classes_ = classes
        remember_columns(self, data)
        return self

    def decision_function(self, bags: object) -> NDArray[np.float64]:
        """Score of each bag, (n_bags,); at least 0 for bags predicted positive.

        Raises
        ------
        NotFittedError
            Before `fit`.
        InputError
            If bags are malformed, or their columns or number of features differ from those in `fit`.
        """
        data = bags_like_those_of_fit(self, bags)
        with one_blas_thread():
            return self._bag_scores(data)

    def predict(self, bags: object) -> NDArray[Any]:
        """Predicted label of each bag, (n_bags,)."""
        positive = self.decision_function(bags) >= 0.0
        predicted: NDArray[Any] = self.classes_[positive.astype(np.int64)]
        return predicted

    @abstractmethod
    def _fit(self, bags: Bags, positive: NDArray[np.bool_]) -> None:
        """Learn from checked bags; both values occur in `positive` (n_bags,)."""

    @abstractmethod
    def _bag_scores(self, bags: Bags) -> NDArray[np.float64]:
        """Score of each bag, (n_bags,); at least 0 where positive."""

    def __sklearn_tags__(self) -> Tags:
        """Scikit-learn's tags, for binary classification only."""
        tags = super().__sklearn_tags__()
        tags.classifier_tags.multi_class = False
        return tags


def bags_like_those_of_fit(estimator: BaseEstimator, bags: object) -> Bags:
    """Check bags passed to a fitted estimator, and put their columns in the order of `fit`.

    Raises
    ------
    NotFittedError
        If it is not fitted.
    InputError
        If bags are malformed, or their columns or number of features differ from those in `fit`.
    """
    check_is_fitted(estimator)
    return columns_as_in_fit(estimator, as_bags(bags))


class InstanceClassifier(BagClassifier, ABC):
    """A classifier of instances; a bag is positive if any of its instances is (eq. 3.1).

    Subclasses score instances (`_instance_scores`). The score of a bag is that of its best instance, its
    witness, unless the subclass overrides this rule.

    References
    ----------
    Palmer (2015), section 3.1.
    """

    def decision_instances(self, bags: object) -> list[NDArray[np.float64]]:
        """Score of each instance, at least 0 where positive; one array per bag, in the bag's order.

        It raises the errors of `decision_function`.
        """
        data = bags_like_those_of_fit(self, bags)
        with one_blas_thread():
            return np.split(self._instance_scores(data.points), data.starts[1:-1])

    def predict_instances(self, bags: object) -> list[NDArray[np.bool_]]:
        """Whether each instance is positive; one bool array per bag, in the bag's order."""
        return [scores >= 0.0 for scores in self.decision_instances(bags)]

    def witness(self, bags: object) -> NDArray[np.int64]:
        """Row of the witness, the instance with the largest score, within each bag, (n_bags,)."""
        return np.array([np.argmax(scores) for scores in self.decision_instances(bags)], dtype=np.int64)

    @abstractmethod
    def _instance_scores(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the score (n,) of each of the points (n, d); at least 0 where positive."""

    def _bag_scores(self, bags: Bags) -> NDArray[np.float64]:
        best: NDArray[np.float64] = np.maximum.reduceat(self._instance_scores(bags.points), bags.starts[:-1])
        return best
