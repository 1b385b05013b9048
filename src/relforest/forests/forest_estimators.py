"""Forests as scikit-learn estimators of scenes: the mean of trees, each from its own sample."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from numbers import Integral
from typing import TYPE_CHECKING, Any, Final, Self, Unpack, final

import numpy as np

from relforest.forests.base import SceneClassifier, SceneEstimator, SceneRegressor, settings_or
from relforest.forests.ensemble import Ensemble
from relforest.forests.forest import Forest, ForestSettings, grow_forest, grow_forest_of_samples
from relforest.forests.labels import class_targets, real_targets, weights_of
from relforest.forests.members import Wanted
from relforest.forests.settings import GrowthSettings
from relforest.forests.shares import mean_shares
from relforest.scenes import sample_scenes
from relforest.support.errors import InputError
from relforest.support.progress import printed_to_stderr
from relforest.support.rng import RandomState, seed_sequence, stream
from relforest.trees import TreeSettings

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from relforest.scenes import Scenes
    from relforest.scenes.scene_stream import SceneColumns

_SAMPLES: Final = 2
FOREST_GROWTH: Final = GrowthSettings(max_leaves=30, share=0.25, min_scenes=2, penalty=0.5)


@dataclass(kw_only=True, eq=False, repr=False)
class _Forest(SceneEstimator, ABC):
    """The parameters of forests, and the fit."""

    n_trees: int = 100
    max_samples: float = 0.632
    growth: GrowthSettings | TreeSettings | None = None
    negated: float | None = None
    random_state: RandomState = None
    n_jobs: int = 1
    verbose: bool = False

    def _learn(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None) -> None:
        settings = self._settings()
        wanted = self._wanted(y, len(scenes), sample_weight)
        seed = seed_sequence(self.random_state)
        self._keep(grow_forest(scenes, wanted, settings, seed, n_jobs=self.n_jobs), wanted)

    def fit_source(self, source: str | PathLike[str], label: str, **columns: Unpack[SceneColumns]) -> Self:
        """Learn from Parquet files that need not fit into memory, each tree from its own sample.

        Parameters
        ----------
        source : path
            A Parquet file, a folder of them, or a pattern; see `relforest.iter_scene_batches`.
        label : str
            The column of what is to be predicted, with one value per scene.
        **columns
            ``scene``, ``object``, ``attributes`` and ``arguments`` as for `relforest.iter_scene_batches`.

        Raises
        ------
        InputError
            If `max_samples` is not a number of scenes, or the source has fewer; and as for `fit` and
            `relforest.iter_scene_batches`. Files and columns are checked at once, and that the rows of each
            scene are together before anything is learned.

        Notes
        -----
        The scenes are counted by their ids, then all samples are drawn in one pass. Memory is that of
        ``n_trees * max_samples`` scenes and a batch. There is no out-of-bag score.
        """
        settings = self._settings()
        if not isinstance(settings.max_samples, Integral):
            raise InputError(
                "max_samples must be the number of scenes of each tree, such as 500, to learn from a source: "
                f"got the share {settings.max_samples!r}"
            )
        seed = seed_sequence(self.random_state)
        size = int(settings.max_samples)
        with printed_to_stderr(self.verbose):
            drawn = sample_scenes(
                source, settings.n_trees, size, stream(seed, _SAMPLES), label=label, **columns
            )
            values = np.concatenate([np.asarray(labels) for _, labels in drawn])
            wanted = self._wanted(values, len(values), None)
            samples = [scenes for scenes, _ in drawn]
            forest = grow_forest_of_samples(samples, wanted, settings, seed, n_jobs=self.n_jobs)
        self._keep(forest, wanted.take(np.empty(0, dtype=np.int64)))
        return self

    def _keep(self, forest: Forest, wanted: Wanted) -> None:
        """Keep what was learned, given what was wanted of the scenes in ``forest.unseen``."""
        self.ensemble_: Ensemble = forest.ensemble
        self.n_sampled_: int = forest.n_sampled
        self.n_left_out_: int = forest.n_left_out
        self._judge(forest.unseen, wanted)

    def _settings(self) -> ForestSettings:
        growth = self.growth
        if not isinstance(growth, TreeSettings):
            growth = settings_or("growth", growth, FOREST_GROWTH)
        return ForestSettings(self.n_trees, self.max_samples, growth, self.negated)

    @abstractmethod
    def _wanted(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> Wanted:
        """Check the targets, and return what is to be predicted."""

    @abstractmethod
    def _judge(self, unseen: NDArray[np.float64], wanted: Wanted) -> None:
        """Keep the predictions (n_scenes, n_outputs) of trees for scenes that they did not see."""


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SMRFForestClassifier(SceneClassifier, _Forest):
    """Mean of trees, each grown from a random sample of the scenes: trees of conditions, or SMRF trees.

    Parameters
    ----------
    n_trees : int, default 100
        Number of trees.
    max_samples : float or int, default 0.632
        Share of the scenes that each tree sees, drawn without replacement; if it is an integer, their number.
    growth : GrowthSettings or TreeSettings, optional
        ``TreeSettings()`` grows the source's SMRF trees, with these settings. `GrowthSettings` grow trees of
        conditions: what a condition may be, and what is tried at every node. Default: trees of conditions of
        up to 30 leaves with at least 2 scenes, a quarter of the half-lines, and half the penalty of boosting.
    negated : float, optional
        Share of the SMRF trees that are learned for the negated labels: these trees say what exists in scenes
        of the other class. Default: half of them, as in the source; none if there are more than two classes.
        Of real targets, these trees say what exists in scenes of low values; by default, each tree says what
        explains more.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of threads, or of processes that grow SMRF trees; -1 for all cores. Does not affect the result.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing.
    class_weight : "balanced", dict or None, default None
        Weights of the classes, as in scikit-learn.

    Attributes
    ----------
    ensemble_ : Ensemble
        The learned trees.
    classes_ : (n_classes,) array
        The labels in sorted order.
    oob_score_ : float
        Accuracy on scenes, each predicted by the trees that did not see it; NaN after `fit_source`.
    oob_decision_function_ : (n_scenes, n_classes) float64
        Probabilities by those trees; NaN where all saw the scene.
    n_sampled_ : int
        Scenes of which only a sample of the choices was searched. For SMRF trees: expansions that were
        searched by a sample, in the tree that has most of them.
    n_left_out_ : int
        Expansions that were not searched, in the SMRF tree that has most of them.

    References
    ----------
    Palmer (2015), section 5.2.3, for forests of SMRF trees. There, a linear support vector machine weighs
    their probabilities, see `SceneFeatures`.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import Scenes, SMRFForestClassifier
    >>> from relforest.trees import TreeSettings
    >>> rng = np.random.default_rng(0)
    >>> places = rng.uniform(0, 10, size=(80, 3, 2))
    >>> records = [{"objects": [{"location": place} for place in scene]} for scene in places.tolist()]
    >>> scenes = Scenes.from_dicts(records)
    >>> close = [min(np.linalg.norm(scene[i] - scene[i - 1]) for i in range(3)) < 3 for scene in places]
    >>> model = SMRFForestClassifier(n_trees=4, growth=TreeSettings(), random_state=0).fit(scenes, close)
    >>> print(model.describe(most=1))
    Score of class True: the sum of 4 trees with 5 questions
    The 1 that gain most: share of the gain, what a yes / a no adds, question
    27.8 %  +0.250 / +0.000  there are A and B such that B is within 3.07 of A
    """

    def _wanted(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> Wanted:
        targets = class_targets(y, n, sample_weight, self.class_weight)
        self.classes_: NDArray[Any] = targets.classes
        n_outputs = 1 if len(targets.classes) == 2 else len(targets.classes)
        numbers = np.eye(len(targets.classes))[targets.numbers][:, -n_outputs:]
        return Wanted(numbers, targets.weights, of_classes=True)

    def _judge(self, unseen: NDArray[np.float64], wanted: Wanted) -> None:
        self.oob_decision_function_ = mean_shares(unseen)
        judged = ~np.isnan(self.oob_decision_function_[:, 0])
        right = self.oob_decision_function_[judged].argmax(axis=1) == mean_shares(
            wanted.numbers[judged]
        ).argmax(axis=1)
        self.oob_score_ = float(right.mean()) if judged.any() else float("nan")

    def _shares(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        return mean_shares(scores)


@final
class SMRFForestRegressor(SceneRegressor, _Forest):
    """Mean of trees for real targets, each grown from a random sample of the scenes.

    The parameters are those of `SMRFForestClassifier`, without ``class_weight``.

    Attributes
    ----------
    ensemble_ : Ensemble
        The learned trees.
    oob_score_ : float
        R2 on scenes, each predicted by the trees that did not see it.
    oob_prediction_ : (n_scenes,) float64
        Predictions by those trees; NaN where all saw the scene.
    n_sampled_, n_left_out_ : int
        As for `SMRFForestClassifier`.
    """

    def _wanted(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> Wanted:
        return Wanted(real_targets(y, n)[:, None], weights_of(sample_weight, n), of_classes=False)

    def _judge(self, unseen: NDArray[np.float64], wanted: Wanted) -> None:
        self.oob_prediction_: NDArray[np.float64] = unseen[:, 0]
        values, judged = wanted.numbers[:, 0], ~np.isnan(self.oob_prediction_)
        errors = ((self.oob_prediction_ - values)[judged] ** 2).sum()
        spread = ((values[judged] - values[judged].mean()) ** 2).sum() if judged.any() else 0.0
        self.oob_score_ = float(1.0 - errors / spread) if spread > 0.0 else float("nan")
