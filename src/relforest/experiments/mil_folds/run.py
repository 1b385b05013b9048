"""A repetition of cross-validation -> a row per fold: what is said of its test bags, in several measures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import roc_auc_score

from relforest.experiments.mil.data import DATA_SETS, Standard, cross_validation
from relforest.experiments.mil.methods import METHODS
from relforest.experiments.mil_folds.settings import FoldsSetting
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.metrics import peirce_skill_score
from relforest.support.errors import InputError
from relforest.support.progress import report
from relforest.support.rng import generator, seed_sequence, stream

_FOLDS, _LEARNING = 0, 1


def compute(setting: FoldsSetting, context: Context) -> list[Row]:
    """Return a row per fold: the setting, the fold, and the measures of `scored`."""
    data_set, method = DATA_SETS[setting.data_set], METHODS[setting.method]
    if not isinstance(data_set, Standard):
        raise InputError(f"{data_set.title} is drawn, and not divided into folds")
    root, place = seed_sequence(context.seed), (data_set.key, setting.repetition)
    split_of = cross_validation(data_set.fetch(), generator(stream(root, _FOLDS, *place)))
    rows: list[Row] = []
    for fold in range(setting.n_folds):
        report("folds", fold, setting.n_folds)
        split = split_of(fold)
        learner = method.learner(stream(root, _LEARNING, *place, method.key, fold), {})
        learner.fit(split.train.bags, split.train.labels)
        measures = scored(split.test.labels, learner.decision_function(split.test.bags))
        rows.append(
            {
                "data_set": setting.data_set,
                "method": setting.method,
                "repetition": setting.repetition,
                "fold": fold,
                **measures,
            }
        )
    return rows


def scored(labels: NDArray[np.bool_], scores: NDArray[np.float64]) -> dict[str, float]:
    """Return what bags (n,) with these scores, at least 0 for positive ones, are worth in several measures.

    ``picked`` is the accuracy with the threshold that is best for these very bags: no accuracy of a method,
    but what some call so.
    """
    predicted = scores >= 0.0
    picked = max(np.mean((scores >= threshold) == labels) for threshold in [*scores, np.inf])
    return {
        "accuracy": float(np.mean(predicted == labels)),
        "balanced": 0.5 * (peirce_skill_score(labels, predicted) + 1.0),
        "auc": float(roc_auc_score(labels, scores)),
        "picked": float(picked),
    }
