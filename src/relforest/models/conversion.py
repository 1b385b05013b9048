"""Fitted estimators as models."""

from __future__ import annotations

from typing import Final, cast

from sklearn.utils.validation import check_is_fitted

from relforest.forests import (
    OutcomeForestClassifier,
    SMRFBoostingClassifier,
    SMRFBoostingRegressor,
    SMRFForestClassifier,
    SMRFForestRegressor,
    SMRFRuleSetClassifier,
)
from relforest.models.model import Family, Label, Model
from relforest.models.training_data import TrainingData
from relforest.reports import QuestionPoints, question_points
from relforest.scenes.mean_object import without_mean
from relforest.support.errors import InputError
from relforest.trees import SMRFTreeClassifier, SMRFTreeRegressor

SceneLearner = (
    SMRFTreeClassifier
    | SMRFTreeRegressor
    | SMRFForestClassifier
    | SMRFForestRegressor
    | SMRFBoostingClassifier
    | SMRFBoostingRegressor
    | SMRFRuleSetClassifier
    | OutcomeForestClassifier
)

_TREES: Final = (SMRFTreeClassifier, SMRFTreeRegressor)
_FAMILIES: Final[dict[type[object], Family]] = {
    SMRFForestClassifier: "forest",
    SMRFForestRegressor: "forest",
    SMRFBoostingClassifier: "boosting",
    SMRFBoostingRegressor: "boosting",
    SMRFRuleSetClassifier: "rules",
    OutcomeForestClassifier: "outcome",
}


def as_model(estimator: SceneLearner, data: TrainingData | None = None) -> Model:
    """Return what an estimator has learned, and how to apply it.

    Parameters
    ----------
    estimator : estimator of scenes
        A fitted tree, forest, boosted model or rule set.
    data : TrainingData, optional
        What it was fitted to (``estimator.fit(data.scenes, data.y)``): then the model names the label, its
        classes and the columns of the scenes, and trees for two classes get training points for drawings.

    Raises
    ------
    NotFittedError
        If nothing was learned.
    InputError
        If the estimator is of another class, or was fitted to other data.
    """
    if not isinstance(estimator, (*_TREES, *_FAMILIES)):
        raise InputError(
            f"models are made of fitted trees, forests, boosted models and rule sets, got {estimator!r:.100}"
        )
    check_is_fitted(estimator)
    learned = estimator.tree_ if isinstance(estimator, _TREES) else estimator.ensemble_
    family = "tree" if isinstance(estimator, _TREES) else _FAMILIES[type(estimator)]
    found = None if not hasattr(estimator, "classes_") else tuple(map(_label, estimator.classes_.tolist()))
    threshold = getattr(estimator, "threshold_", 0.5)
    if data is None:
        return Model(learned, family, "", found, None, threshold=threshold)
    if data.scenes.schema != without_mean(learned.schema) or (data.classes is None) != (found is None):
        raise InputError("the estimator was fitted to other data: fit it to data.scenes and data.y")
    points: dict[int, QuestionPoints] = {}
    if isinstance(estimator, _TREES) and data.classes is not None and len(data.classes) == 2:
        points = question_points(estimator.tree_, data.scenes, data.y == 1)
    return Model(learned, family, data.label, data.classes, data.columns, points, threshold)


def _label(value: object) -> Label:
    # Classes are whole numbers even if they are stored as floats.
    return int(value) if isinstance(value, float) else cast("Label", value)
