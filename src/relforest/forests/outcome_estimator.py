"""Prediction of whether an action succeeds: forests, weighed by a linear support vector machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple, final

import numpy as np
from sklearn.utils.validation import check_is_fitted

from relforest.forests.base import SceneClassifier, settings_or
from relforest.forests.ensemble import Ensemble
from relforest.forests.forest import ForestSettings
from relforest.forests.forest_estimators import SMRFForestClassifier
from relforest.forests.labels import class_targets
from relforest.forests.linear_machine import FOLDS, Weighing, weighed
from relforest.forests.opinions import Labelled, Opinions, opinions_of_conditions, opinions_of_smrf_trees
from relforest.forests.settings import GrowthSettings
from relforest.support.errors import InputError
from relforest.support.rng import RandomState, generator, seed_sequence, stream
from relforest.trees import TreeSettings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.scenes import Scenes

OUTCOME_GROWTH: Final = GrowthSettings(share=0.2)
_TREES, _MACHINE = range(2)

# Standard errors by which a mean object must lower the loss of scenes left out.
_CLEARLY: Final = 2.0


class _Judged(NamedTuple):
    """Scenes, what trees say about them, and how much each counts."""

    known: Labelled
    opinions: Opinions
    machine: Weighing


@final
@dataclass(kw_only=True, eq=False, repr=False)
class OutcomeForestClassifier(SceneClassifier):
    """Whether an action succeeds: forests, weighed by a linear support vector machine.

    Probabilities are calibrated on scenes that were left out, and the second class is predicted from its
    share on: `predict` aims at the Peirce skill score, for which both count alike however rare one is.

    Parameters
    ----------
    n_trees : int, default 100
        Number of trees: of each boosted model and of the forest; or of all SMRF trees.
    max_samples : float or int, default 0.632
        Share of the scenes that each tree of a forest sees, drawn without replacement; if it is an integer,
        their number.
    growth : GrowthSettings or TreeSettings, optional
        ``TreeSettings()`` is the source's method: SMRF trees, half of them for the negated labels, whose
        probabilities are weighed one by one. With `GrowthSettings`, and by default, two opinions are weighed:
        that of five boosted models and that of a forest of trees of conditions, both about scenes that those
        who give them have not seen. The settings are those of the boosted models; the forest has the same
        conditions.
    mean_object : bool, optional
        Whether scenes get a mean object, see `Scenes.with_mean_object`: it tells where sums over objects
        decide, and distracts elsewhere. Default: if it lowers the loss of scenes that were left out by two
        standard errors; not with SMRF trees.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of threads, or of processes that grow SMRF trees; -1 for all cores. Does not affect the result.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing.
    class_weight : "balanced", dict or None, default None
        Weights of the classes, as in scikit-learn. They move the probabilities, hardly the predicted classes.

    Attributes
    ----------
    ensemble_ : Ensemble
        Log-odds: all trees with their weights.
    classes_ : (2,) array
        The labels in sorted order.
    threshold_ : float
        The probability of the second class from which on it is predicted: its share by weight.
    cost_ : float
        The parameter C of the support vector machine.
    skill_ : float
        Its Peirce skill score in cross-validation, by weight. SMRF trees have seen the scenes before.
    n_sampled_, n_left_out_ : int
        As for `SMRFForestClassifier`.

    References
    ----------
    Palmer (2015), section 5.2.3.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import OutcomeForestClassifier, Scenes
    >>> rng = np.random.default_rng(0)
    >>> places = rng.uniform(0, 10, size=(80, 3, 2))
    >>> records = [{"objects": [{"location": place} for place in scene]} for scene in places.tolist()]
    >>> scenes = Scenes.from_dicts(records)
    >>> close = [min(np.linalg.norm(scene[i] - scene[i - 1]) for i in range(3)) < 3 for scene in places]
    >>> model = OutcomeForestClassifier(n_trees=10, random_state=0).fit(scenes, close)
    >>> model.importances()[0].question
    'distance(location) of C, D'
    """

    n_trees: int = 100
    max_samples: float = 0.632
    growth: GrowthSettings | TreeSettings | None = None
    mean_object: bool | None = None
    random_state: RandomState = None
    n_jobs: int = 1
    verbose: bool = False

    def _learn(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None) -> None:
        seed = seed_sequence(self.random_state)
        ForestSettings(self.n_trees, self.max_samples, self._growth)
        targets = class_targets(y, len(scenes), sample_weight, self.class_weight)
        if len(targets.classes) != 2:
            raise InputError(
                f"outcomes are two classes, got {len(targets.classes)}: use SMRFBoostingClassifier for more"
            )
        counted = np.flatnonzero(targets.weights > 0.0)
        positive = targets.numbers[counted] == 1
        for number, n in enumerate((np.count_nonzero(~positive), np.count_nonzero(positive))):
            if n < FOLDS:
                raise InputError(
                    f"only {n} scenes are of class {targets.classes.tolist()[number]!r}: at least {FOLDS} of "
                    "each class are needed, to weigh trees by cross-validation"
                )
        known = Labelled(scenes.take(counted), positive, targets.weights[counted])
        judged = self._judged(known, seed)
        found, machine = judged.opinions, judged.machine
        start = machine.start + float(found.starts @ machine.weights)
        self.ensemble_ = Ensemble(
            judged.known.scenes.schema, np.array([start]), found.trees, found.shares @ machine.weights
        )
        self.classes_: NDArray[Any] = targets.classes
        self.threshold_ = float(np.average(positive, weights=known.weights))
        self.cost_, self.skill_ = machine.cost, machine.skill
        self.n_sampled_, self.n_left_out_ = found.n_sampled, found.n_left_out

    def predict(self, scenes: Scenes) -> NDArray[Any]:
        """Return the class of each scene, (n_scenes,): the second one from `threshold_` on."""
        check_is_fitted(self)
        predicted: NDArray[Any] = self.classes_[
            (self.predict_proba(scenes)[:, 1] >= self.threshold_).astype(np.int64)
        ]
        return predicted

    @property
    def _growth(self) -> GrowthSettings:
        """What trees of conditions grow by.

        Raises
        ------
        InputError
            If something else was given.
        """
        given = None if isinstance(self.growth, TreeSettings) else self.growth
        return settings_or("growth", given, OUTCOME_GROWTH)

    def _judged(self, known: Labelled, seed: np.random.SeedSequence) -> _Judged:
        """Learn with or without a mean object, or both, and return the better one."""
        is_smrf = isinstance(self.growth, TreeSettings)
        wanted = False if self.mean_object is None and is_smrf else self.mean_object
        tried = [
            self._weighed(known._replace(scenes=known.scenes.with_mean_object()) if with_it else known, seed)
            for with_it in (False, True)
            if wanted is None or wanted == with_it
        ]
        without, with_it = tried[0], tried[-1]
        saved = without.machine.losses - with_it.machine.losses
        mean = float(np.average(saved, weights=known.weights))
        return with_it if mean > _CLEARLY * saved.std() / len(saved) ** 0.5 else without

    def _weighed(self, known: Labelled, seed: np.random.SeedSequence) -> _Judged:
        if isinstance(self.growth, TreeSettings):
            forest = SMRFForestClassifier(
                n_trees=self.n_trees,
                max_samples=self.max_samples,
                growth=self.growth,
                random_state=stream(seed, _TREES),
                n_jobs=self.n_jobs,
            )
            found = opinions_of_smrf_trees(known, forest)
        else:
            found = opinions_of_conditions(
                known, self.n_trees, self.max_samples, self._growth, stream(seed, _TREES), self.n_jobs
            )
        rng = generator(stream(seed, _MACHINE))
        return _Judged(known, found, weighed(found.columns, known.positive, known.weights, rng))
