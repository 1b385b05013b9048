"""What all classifiers of bags share: input checks, classes, weights, scores, and probabilities."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self

import numpy as np
from scipy.special import expit, log_expit, softmax
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import check_is_fitted

from relforest.mil.bag_weights import bag_weights
from relforest.mil.feature_names import columns_as_in_fit, remember_columns
from relforest.mil.left_out import log_odds_factor, split_bags
from relforest.scenes.bags import Bags, as_bags, own_labels
from relforest.scenes.labels import class_labels
from relforest.support.blas import one_blas_thread
from relforest.support.errors import InputError
from relforest.support.progress import printed_to_stderr, report
from relforest.support.rng import generator, seed_sequence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_N_SPLITS: Final = 5


def _knows_odds(self: BagClassifier) -> bool:
    """Whether there are probabilities: always for more than two classes."""
    return self.probability or self._scores_are_log_odds or hasattr(self, "estimators_")


def _forget(estimator: BaseEstimator, attribute: str) -> None:
    """Delete what an earlier `fit` may have learned."""
    if hasattr(estimator, attribute):
        delattr(estimator, attribute)


@dataclass(kw_only=True, eq=False, repr=False)
class BagClassifier(ClassifierMixin, BaseEstimator, ABC):  # type: ignore[misc]  # scikit-learn is untyped
    """A classifier of bags of points with scikit-learn's interface.

    Subclasses implement learning to tell positive bags from negative ones (`_fit`) and the scores of bags
    (`_bag_scores`). `CovAggClassifier` tells which forms of bags are accepted, and which attributes `fit`
    sets. With more than two classes, a machine of the same type and options is trained for each, to tell it
    from all others.
    """

    probability: bool = False

    classes_: NDArray[Any] = field(init=False)
    n_features_in_: int = field(init=False)
    estimators_: tuple[Self, ...] = field(init=False)
    factor_: float = field(init=False)
    n_iter_: int = field(init=False)
    _scores_are_log_odds: ClassVar[bool] = False

    def fit(self, bags: object, y: ArrayLike | None = None, **others: object) -> Self:
        """Learn from labelled bags.

        Parameters
        ----------
        bags : bags in any of the accepted forms
        y : (n_bags,) array-like
            Numbers, booleans or strings. Of two classes, the larger label is the positive class. May be
            omitted for a `relforest.datasets.BagSet`, which contains labels.
        **others
            Nothing: the search of this classifier counts bags, so it cannot use `sample_weight`.

        Raises
        ------
        InputError
            If bags or labels are malformed, a parameter is out of range, or there are `others`.
        """
        for name in others:
            raise InputError(
                f"{type(self).__name__} counts bags and cannot use {name}: repeat bags as often as they "
                "weigh, or take a classifier with weights, such as EMDDClassifier"
            )
        return self._learn(bags, y, None)

    def _learn(self, bags: object, y: ArrayLike | None, sample_weight: ArrayLike | None) -> Self:
        data = as_bags(bags)
        if y is None:
            y = own_labels(bags)
        if y is None:
            raise InputError("requires y to be passed, but the target y is None: give each bag a label")
        classes, codes = class_labels(y, len(data), what="bags")
        weights, kept = bag_weights(sample_weight, codes, classes)
        if len(kept) < len(data):
            data, codes, weights = data.taken(kept), codes[kept], weights[kept]
        _forget(self, "estimators_")
        # Several threads would add in another order, and round differently on other machines.
        with one_blas_thread(), printed_to_stderr(getattr(self, "verbose", False)):
            if len(classes) == 2:
                self._fit_two(data, codes == 1, weights)
            else:
                self.estimators_ = tuple(
                    self._against_the_rest(data, codes == code, weights) for code in range(len(classes))
                )
                # Scikit-learn asks for the number of iterations, whatever the number of classes.
                if hasattr(self.estimators_[0], "n_iter_"):
                    self.n_iter_ = max(machine.n_iter_ for machine in self.estimators_)
        self.classes_ = classes
        remember_columns(self, data)
        return self

    def _fit_two(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        """Learn to tell two classes apart, and how to turn scores into log odds if that is asked for."""
        _forget(self, "factor_")
        if self.probability and not self._scores_are_log_odds:
            scores = np.empty(len(bags))
            splits = split_bags(positive, _N_SPLITS, generator(seed_sequence(0)))
            for number, (train, test) in enumerate(splits):
                report("scoring left-out bags: splits", number, len(splits))
                twin = type(self)(**self.get_params(deep=False))
                twin._fit(bags.taken(train), positive[train], weights[train])  # noqa: SLF001  # its own class
                scores[test] = twin._bag_scores(bags.taken(test))  # noqa: SLF001
            self.factor_ = log_odds_factor(scores, positive, weights)
        self._fit(bags, positive, weights)

    def _against_the_rest(
        self, bags: Bags, is_member: NDArray[np.bool_], weights: NDArray[np.float64]
    ) -> Self:
        # Scores of different machines can only be compared as log odds.
        machine = type(self)(**{**self.get_params(deep=False), "probability": True})
        machine._fit_two(bags, is_member, weights)  # noqa: SLF001  # its own class
        machine.classes_ = np.array([False, True])
        remember_columns(machine, bags)
        return machine

    def decision_function(self, bags: object) -> NDArray[np.float64]:
        """Score of each bag, (n_bags,); at least 0 for bags predicted positive.

        With more than two classes, (n_bags, n_classes): the log odds of each class against all others.

        Raises
        ------
        NotFittedError
            Before `fit`.
        InputError
            If bags are malformed, or their columns or number of features differ from those in `fit`.
        """
        data = bags_like_those_of_fit(self, bags)
        with one_blas_thread():
            if hasattr(self, "estimators_"):
                odds = [machine._log_odds(data) for machine in self.estimators_]  # noqa: SLF001  # its own class
                return np.column_stack(odds)
            return self._bag_scores(data)

    def predict(self, bags: object) -> NDArray[Any]:
        """Predicted label of each bag, (n_bags,): of more than two classes, the one with the best score."""
        scores = self.decision_function(bags)
        codes = scores.argmax(axis=1) if scores.ndim == 2 else (scores >= 0.0).astype(np.int64)
        predicted: NDArray[Any] = self.classes_[codes]
        return predicted

    @available_if(_knows_odds)  # type: ignore[untyped-decorator]  # scikit-learn is untyped
    def predict_proba(self, bags: object) -> NDArray[np.float64]:
        """Probability of each class for each bag, (n_bags, n_classes).

        Of two classes, the predicted one has a probability of at least one half. The log odds are the scores
        times a factor, fitted by logistic regression to bags that were left out in 5-fold cross-validation
        (Platt scaling without an intercept); `VolumeCommitteeClassifier`, `DiverseDensityClassifier` and
        `EMDDClassifier` have scores that are log odds. Probabilities of more than two classes are those of
        each against all others, divided by their sum. Raises the errors of `decision_function`.
        """
        scores = self.decision_function(bags)
        if scores.ndim == 2:
            shares: NDArray[np.float64] = softmax(log_expit(scores), axis=1)
            return shares
        odds = scores * getattr(self, "factor_", 1.0)
        return np.column_stack([expit(-odds), expit(odds)])

    def _log_odds(self, bags: Bags) -> NDArray[np.float64]:
        return self._bag_scores(bags) * getattr(self, "factor_", 1.0)

    @abstractmethod
    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        """Learn from checked bags; both values occur in `positive` (n_bags,).

        The weights (n_bags,) are above 0, with a mean of 1; a `WeightedBagClassifier` uses them, for others
        all are 1.
        """

    @abstractmethod
    def _bag_scores(self, bags: Bags) -> NDArray[np.float64]:
        """Score of each bag, (n_bags,); at least 0 where positive."""


class WeightedBagClassifier(BagClassifier, ABC):
    """A classifier whose training can give bags different weights."""

    # Of the "others" of the base class, it takes one.
    def fit(  # type: ignore[override]
        self, bags: object, y: ArrayLike | None = None, sample_weight: ArrayLike | None = None
    ) -> Self:
        """Learn from labelled bags.

        Parameters
        ----------
        bags, y
            As for `CovAggClassifier`.
        sample_weight : (n_bags,) array-like, optional
            Weights of the bags, at least 0. Only their ratios matter. Bags of weight 0 are left out, but each
            class needs one that is not. By default, all are equal.

        Raises
        ------
        InputError
            If bags, labels or weights are malformed, or a parameter is out of range.
        """
        return self._learn(bags, y, sample_weight)


def two_classes_only(estimator: BagClassifier) -> None:
    """Check that a classifier, if it is fitted, was fitted to two classes.

    Raises
    ------
    InputError
        If there are more, as instances then count for a class and against the others.
    """
    if hasattr(estimator, "estimators_"):
        raise InputError(
            f"this {type(estimator).__name__} has {len(estimator.classes_)} classes: ask one of estimators_, "
            "which tell one of classes_ from the others"
        )


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

        It raises the errors of `decision_function`, and an `InputError` if there are more than two classes.
        """
        two_classes_only(self)
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
