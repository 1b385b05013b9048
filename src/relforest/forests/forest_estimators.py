"""Forests as scikit-learn estimators of scenes: the mean of trees, each from its own sample."""

from __future__ import annotations

from abc import ABC
from typing import TYPE_CHECKING, Any, Final, Self, final

import numpy as np
from sklearn.base import ClassifierMixin, RegressorMixin

from relforest.forests.base import SceneEstimator, growth_settings
from relforest.forests.ensemble import Ensemble
from relforest.forests.growth import GrownTree, grow_tree
from relforest.forests.kernels import Targets
from relforest.forests.labels import class_targets, real_targets, weights_of
from relforest.forests.settings import GrowthSettings
from relforest.scenes.batch import checked_scenes
from relforest.support.options import at_least, in_range
from relforest.support.parallel import run_tasks
from relforest.support.progress import printed_to_stderr
from relforest.support.rng import RandomState, generator, seed_sequence, stream

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.forests.tables import ConditionTable
    from relforest.scenes import Scenes
    from relforest.trees.weights import ClassWeight

_TABLES, _TREES = range(2)
FOREST_GROWTH: Final = GrowthSettings(max_leaves=30, share=0.25, min_scenes=2, penalty=0.5)


class _Forest(SceneEstimator, ABC):
    """The parameters of forests, and the fit."""

    def __init__(
        self,
        *,
        n_trees: int = 100,
        max_samples: float = 0.632,
        growth: GrowthSettings | None = None,
        random_state: RandomState = None,
        n_jobs: int = 1,
        verbose: bool = False,
    ) -> None:
        self.n_trees = n_trees
        self.max_samples = max_samples
        self.growth = growth
        self.random_state = random_state
        self.n_jobs = n_jobs
        self.verbose = verbose

    def _settings(self) -> GrowthSettings:
        at_least("n_trees", self.n_trees, 1)
        in_range("max_samples", self.max_samples, 0.0, 1.0, open_low=True)
        return growth_settings(self.growth, FOREST_GROWTH)

    def _grow(
        self, scenes: Scenes, wanted: NDArray[np.float64], weights: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Grow the trees towards the wanted outputs (n_scenes, n_outputs).

        Returns the mean over the trees that did not see a scene, NaN where all did.
        """
        settings = self._settings()
        seed = seed_sequence(self.random_state)
        start = np.average(wanted, axis=0, weights=weights)
        targets = Targets(
            weights[:, None] * (start - wanted), np.repeat(weights[:, None], wanted.shape[1], axis=1)
        )
        size = max(1, round(self.max_samples * len(scenes)))
        with printed_to_stderr(self.verbose):
            tables = self._tables(scenes, settings, generator(stream(seed, _TABLES)))
            tasks = [
                (tables, size, targets, settings, stream(seed, _TREES, number))
                for number in range(self.n_trees)
            ]
            grown = run_tasks(_tree, tasks, n_jobs=self.n_jobs, prefer="threads")
        trees = tuple(tree.tree for tree, _ in grown)
        self.ensemble_ = Ensemble(scenes.schema, start, trees, np.full(len(trees), 1.0 / len(trees)))
        everything = np.arange(len(scenes))
        total, n_unseen = np.zeros(wanted.shape), np.zeros((len(scenes), 1))
        for tree, sample in grown:
            unseen = np.setdiff1d(everything, sample)
            total[unseen] += start + tree.tree.values[tree.leaves(unseen)]
            n_unseen[unseen] += 1
        with np.errstate(invalid="ignore"):
            return np.asarray(total / n_unseen)


def _tree(
    tables: tuple[ConditionTable, ...],
    size: int,
    targets: Targets,
    settings: GrowthSettings,
    seed: np.random.SeedSequence,
) -> tuple[GrownTree, NDArray[np.int64]]:
    """Grow one tree; return it and its scenes."""
    rng = generator(seed)
    sample = np.sort(rng.choice(len(targets.gradients), size, replace=False))
    return grow_tree(tables, sample, targets, settings, rng), sample


@final
class SMRFForestClassifier(ClassifierMixin, _Forest):  # type: ignore[misc]  # scikit-learn is untyped
    """Mean of trees of conditions, each grown from a random sample of the scenes.

    Parameters
    ----------
    n_trees : int, default 100
        Number of trees.
    max_samples : float, default 0.632
        Share of the scenes that each tree sees, drawn without replacement.
    growth : GrowthSettings, optional
        What a condition may be, and what is tried at every node. Default: trees of up to 30 leaves with at
        least 2 scenes, a quarter of the half-lines, and half the penalty of boosting.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of threads; -1 for all cores. Does not affect the result.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing.
    class_weight : "balanced", dict or None, default None
        Weights of the classes, as in scikit-learn.

    Attributes
    ----------
    ensemble_ : Ensemble
        The learned trees.
    classes_ : ndarray (n_classes,)
        The labels in sorted order.
    oob_score_ : float
        Accuracy on scenes, each predicted by the trees that did not see it.
    oob_decision_function_ : ndarray (n_scenes, n_classes)
        Probabilities by those trees; NaN where all saw the scene.
    n_sampled_ : int
        Scenes of which only a sample of the choices was searched.
    """

    def __init__(
        self,
        *,
        n_trees: int = 100,
        max_samples: float = 0.632,
        growth: GrowthSettings | None = None,
        random_state: RandomState = None,
        n_jobs: int = 1,
        verbose: bool = False,
        class_weight: ClassWeight = None,
    ) -> None:
        super().__init__(
            n_trees=n_trees,
            max_samples=max_samples,
            growth=growth,
            random_state=random_state,
            n_jobs=n_jobs,
            verbose=verbose,
        )
        self.class_weight = class_weight

    def fit(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None = None) -> Self:
        """Learn the trees.

        Parameters
        ----------
        scenes : Scenes
        y : array-like (n_scenes,)
            Labels of two or more classes.
        sample_weight : array-like (n_scenes,), optional
            Not negative.

        Raises
        ------
        InputError
            If labels or weights do not match the scenes, or a parameter is out of range.
        """
        self._settings()
        targets = class_targets(y, len(checked_scenes(scenes)), sample_weight, self.class_weight)
        n_outputs = 1 if len(targets.classes) == 2 else len(targets.classes)
        wanted = np.eye(len(targets.classes))[targets.numbers][:, -n_outputs:]
        self.oob_decision_function_ = _probabilities(self._grow(scenes, wanted, targets.weights))
        self.classes_ = targets.classes
        judged = ~np.isnan(self.oob_decision_function_[:, 0])
        right = self.oob_decision_function_[judged].argmax(axis=1) == targets.numbers[judged]
        self.oob_score_ = float(right.mean()) if judged.any() else float("nan")
        return self

    def predict_proba(self, scenes: Scenes) -> NDArray[np.float64]:
        """Probability of each class, (n_scenes, n_classes)."""
        return _probabilities(self._scores(scenes))

    def predict(self, scenes: Scenes) -> NDArray[Any]:
        """Most probable class of each scene, (n_scenes,)."""
        predicted: NDArray[Any] = self.classes_[self.predict_proba(scenes).argmax(axis=1)]
        return predicted

    def _scored(self) -> str:
        return f"class {self.classes_[-1]}"


@final
class SMRFForestRegressor(RegressorMixin, _Forest):  # type: ignore[misc]  # scikit-learn is untyped
    """Mean of trees of conditions for real targets, each grown from a random sample of the scenes.

    The parameters are those of `SMRFForestClassifier`, without ``class_weight``.

    Attributes
    ----------
    ensemble_ : Ensemble
        The learned trees.
    oob_score_ : float
        R2 on scenes, each predicted by the trees that did not see it.
    oob_prediction_ : ndarray (n_scenes,)
        Predictions by those trees; NaN where all saw the scene.
    n_sampled_ : int
        Scenes of which only a sample of the choices was searched.
    """

    def fit(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None = None) -> Self:
        """Learn the trees.

        Parameters
        ----------
        scenes : Scenes
        y : array-like (n_scenes,)
            Finite numbers, not all equal.
        sample_weight : array-like (n_scenes,), optional
            Not negative.

        Raises
        ------
        InputError
            If targets or weights do not match the scenes, or a parameter is out of range.
        """
        self._settings()
        values = real_targets(y, len(checked_scenes(scenes)))
        weights = weights_of(sample_weight, len(values))
        self.oob_prediction_ = self._grow(scenes, values[:, None], weights)[:, 0]
        judged = ~np.isnan(self.oob_prediction_)
        errors = ((self.oob_prediction_ - values)[judged] ** 2).sum()
        spread = ((values[judged] - values[judged].mean()) ** 2).sum() if judged.any() else 0.0
        self.oob_score_ = float(1.0 - errors / spread) if spread > 0.0 else float("nan")
        return self

    def predict(self, scenes: Scenes) -> NDArray[np.float64]:
        """Predicted target of each scene, (n_scenes,)."""
        return self._scores(scenes)[:, 0]

    def _scored(self) -> str:
        return "the target"


def _probabilities(scores: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return probabilities of all classes, which add up to 1."""
    if scores.shape[1] == 1:
        positive = np.clip(scores[:, 0], 0.0, 1.0)
        return np.column_stack([1.0 - positive, positive])
    bounded = np.clip(scores, 0.0, None)
    return np.asarray(bounded / bounded.sum(axis=1, keepdims=True))
