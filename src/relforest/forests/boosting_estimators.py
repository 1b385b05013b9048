"""Boosting as scikit-learn estimators of scenes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, final

import numpy as np

from relforest.forests.base import SceneClassifier, SceneEstimator, SceneRegressor, settings_or
from relforest.forests.boosting import BoostingSettings, boost
from relforest.forests.ensemble import Ensemble
from relforest.forests.labels import class_targets, real_targets, weights_of
from relforest.forests.losses import Logistic, Loss, Softmax, SquaredError
from relforest.forests.settings import GrowthSettings
from relforest.support.rng import RandomState, generator, seed_sequence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.scenes import Scenes


class _Goal(NamedTuple):
    """A loss, and how its scores become those of the ensemble; the classes if it is about classes."""

    loss: Loss
    scale: float = 1.0
    shift: float = 0.0
    classes: NDArray[Any] | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class _Boosting(SceneEstimator, ABC):
    """The parameters of boosting, and the fit."""

    n_trees: int = 100
    learning_rate: float = 0.1
    max_scenes: int = 256
    validation: float = 0.0
    growth: GrowthSettings | None = None
    random_state: RandomState = None
    n_jobs: int = 1
    verbose: bool = False

    def _learn(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None) -> None:
        how = BoostingSettings(self.n_trees, self.learning_rate, self.max_scenes, self.validation)
        growth = settings_or("growth", self.growth, GrowthSettings())
        goal = self._goal(y, len(scenes), sample_weight)
        rng = generator(seed_sequence(self.random_state))
        tables = self._tables(scenes, growth, rng)
        boosted = boost(tables, len(scenes), goal.loss, (how, growth), rng)
        trees = tuple(grown.tree for grown in boosted.trees)
        weights = np.full(len(trees), self.learning_rate * goal.scale)
        self.ensemble_ = Ensemble(scenes.schema, boosted.start * goal.scale + goal.shift, trees, weights)
        self.losses_: NDArray[np.float64] = boosted.losses
        if goal.classes is not None:
            self.classes_: NDArray[Any] = goal.classes

    @abstractmethod
    def _goal(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> _Goal:
        """Check the targets, and return what is to be minimised."""


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SMRFBoostingClassifier(SceneClassifier, _Boosting):
    """Sum of small trees of conditions, fitted to the gradient of the log likelihood.

    A condition says that some object exists (or two, or at least k) of which up to three statements are true:
    half-lines, intervals, ellipses or categories of any mapping of the object and the action's arguments.

    Parameters
    ----------
    n_trees : int, default 100
        Number of trees.
    learning_rate : float, default 0.1
        Factor on every tree.
    max_scenes : int, default 256
        Each tree is fitted to a random sample of so many scenes, without replacement.
    validation : float, default 0.0
        Share of the scenes held out to decide how many trees to keep: boosting stops after 30 trees without
        improvement there. 0 uses all scenes and all trees.
    growth : GrowthSettings, optional
        What a condition may be, and what is tried at every node.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of threads for prediction; -1 for all cores. Does not affect the result.
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
    losses_ : (n_trees + 1,) float64
        Mean loss before the first and after every tree, on the held-out scenes if there are any.
    n_sampled_ : int
        Scenes of which only a sample of the choices was searched.

    References
    ----------
    Friedman (2002), Stochastic gradient boosting, Computational Statistics & Data Analysis 38(4); Chen and
    Guestrin (2016), XGBoost, for the Newton step.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import Scenes, SMRFBoostingClassifier
    >>> rng = np.random.default_rng(0)
    >>> places = rng.uniform(0, 10, size=(80, 3, 2))
    >>> records = [{"objects": [{"location": place} for place in scene]} for scene in places.tolist()]
    >>> scenes = Scenes.from_dicts(records)
    >>> close = [min(np.linalg.norm(scene[i] - scene[i - 1]) for i in range(3)) < 3 for scene in places]
    >>> model = SMRFBoostingClassifier(n_trees=20, random_state=0).fit(scenes, close)
    >>> model.importances()[0].question
    'distance(location) of C, D'
    """

    def _goal(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> _Goal:
        targets = class_targets(y, n, sample_weight, self.class_weight)
        if len(targets.classes) == 2:
            return _Goal(Logistic(targets.numbers == 1, targets.weights), classes=targets.classes)
        loss = Softmax(targets.numbers, len(targets.classes), targets.weights)
        return _Goal(loss, classes=targets.classes)

    def decision_function(self, scenes: Scenes) -> NDArray[np.float64]:
        """Log-odds of the second class (n_scenes,), or unnormalised log probabilities of all classes."""
        scores = self._scores(scenes)
        return scores[:, 0] if scores.shape[1] == 1 else scores


@final
class SMRFBoostingRegressor(SceneRegressor, _Boosting):
    """Sum of small trees of conditions, fitted to the residuals of real targets.

    The parameters are those of `SMRFBoostingClassifier`, without ``class_weight``.

    Attributes
    ----------
    ensemble_ : Ensemble
        The learned trees.
    losses_ : (n_trees + 1,) float64
        Mean of half of the squared error in units of the targets' variance, before the first and after every
        tree, on the held-out scenes if there are any.
    n_sampled_ : int
        Scenes of which only a sample of the choices was searched.
    """

    def _goal(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> _Goal:
        values, weights = real_targets(y, n), weights_of(sample_weight, n)
        shift, scale = float(values.mean()), float(values.std())
        return _Goal(SquaredError((values - shift) / scale, weights), scale, shift)
