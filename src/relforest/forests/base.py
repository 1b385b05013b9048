"""What the estimators of this package share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin
from sklearn.utils.validation import check_is_fitted

from relforest.forests.descriptions import MOST_QUESTIONS, ensemble_in_words
from relforest.forests.ensemble import Ensemble
from relforest.forests.explanations import Importance, ScoreExplanation, explain_scores, importances
from relforest.forests.settings import GrowthSettings
from relforest.forests.shares import logistic_shares
from relforest.forests.tables import ConditionTable, searched_tables
from relforest.scenes.batch import checked_scenes
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import printed_to_stderr

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.scenes import Scenes
    from relforest.trees.weights import ClassWeight


_Settings = TypeVar("_Settings")


def settings_or(name: str, given: object, default: _Settings) -> _Settings:
    """Return the settings of an estimator: those given, or the default.

    Raises
    ------
    InputError
        If something else was given.
    """
    if given is None:
        return default
    if not isinstance(given, type(default)):
        raise InputError(f"{name} must be {type(default).__name__} or None, got {given!r:.100}")
    return given


class SceneEstimator(BaseEstimator, ABC):  # type: ignore[misc]  # scikit-learn is untyped
    """An estimator with a fitted `Ensemble`."""

    ensemble_: Ensemble

    def fit(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None = None) -> Self:
        """Learn from scenes.

        Parameters
        ----------
        scenes : Scenes
        y : (n_scenes,) array-like
            Labels of two or more classes, of two for rule sets and outcomes, which need ten scenes of each;
            for a regressor, finite numbers that are not all equal.
        sample_weight : (n_scenes,) array-like, optional
            Not negative.

        Raises
        ------
        InputError
            If targets or weights do not match the scenes or the model, or a parameter is out of range.
        """
        with printed_to_stderr(self.verbose):
            self._learn(checked_scenes(scenes), y, sample_weight)
        return self

    @abstractmethod
    def _learn(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None) -> None:
        """Learn, and keep what was learned."""

    def apply(self, scenes: Scenes) -> NDArray[np.int32]:
        """Return the number of the leaf that each scene reaches in every tree, (n_scenes, n_trees)."""
        check_is_fitted(self)
        return self.ensemble_.leaves(checked_scenes(scenes), n_jobs=self.n_jobs)

    def explain(self, scenes: Scenes, *, most: int = 5) -> list[ScoreExplanation]:
        """Return the `most` strongest reasons for each prediction, with their witnesses."""
        check_is_fitted(self)
        at_least("most", most, 1)
        return explain_scores(self.ensemble_, checked_scenes(scenes), self._outputs(scenes), most)

    def importances(self) -> list[Importance]:
        """Return what questions compare and their shares of the gain, the most useful first."""
        check_is_fitted(self)
        return importances(self.ensemble_)

    def describe(self, *, most: int = MOST_QUESTIONS) -> str:
        """Return the model in words: the `most` useful questions, the most useful first."""
        check_is_fitted(self)
        return ensemble_in_words(self.ensemble_, self._scored(), most=at_least("most", most, 1))

    def _scores(self, scenes: Scenes) -> NDArray[np.float64]:
        check_is_fitted(self)
        return self.ensemble_.scores(checked_scenes(scenes), n_jobs=self.n_jobs)

    def _outputs(self, scenes: Scenes) -> NDArray[np.int64]:
        """Return the output to explain for each scene: that of the predicted class."""
        scores = self._scores(scenes)
        return scores.argmax(axis=1) if scores.shape[1] > 1 else np.zeros(len(scores), dtype=np.int64)

    @abstractmethod
    def _scored(self) -> str:
        """Return what the last output scores, in words."""

    def _tables(
        self, scenes: Scenes, settings: GrowthSettings, rng: np.random.Generator
    ) -> tuple[ConditionTable, ...]:
        """Return the tables of the training scenes, and remember how many scenes were sampled."""
        tables = searched_tables(scenes, settings, rng)
        self.n_sampled_: int = max((table.n_sampled for table in tables), default=0)
        return tables

    def __sklearn_tags__(self) -> Any:  # noqa: ANN401
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        return tags


@dataclass(kw_only=True, eq=False, repr=False)
class SceneClassifier(ClassifierMixin, SceneEstimator, ABC):  # type: ignore[misc]  # scikit-learn is untyped
    """An estimator of classes; its scores are log-odds unless it says otherwise."""

    class_weight: ClassWeight = None

    def predict_proba(self, scenes: Scenes) -> NDArray[np.float64]:
        """Probability of each class, (n_scenes, n_classes)."""
        return self._shares(self._scores(scenes))

    def predict(self, scenes: Scenes) -> NDArray[Any]:
        """Most probable class of each scene, (n_scenes,)."""
        probabilities = self.predict_proba(scenes)
        predicted: NDArray[Any] = self.classes_[probabilities.argmax(axis=1)]
        return predicted

    def _shares(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        return logistic_shares(scores)

    def _scored(self) -> str:
        return f"class {self.classes_[-1]}"


class SceneRegressor(RegressorMixin, SceneEstimator, ABC):  # type: ignore[misc]  # scikit-learn is untyped
    """An estimator of real targets."""

    def predict(self, scenes: Scenes) -> NDArray[np.float64]:
        """Predicted target of each scene, (n_scenes,)."""
        return self._scores(scenes)[:, 0]

    def _scored(self) -> str:
        return "the target"
