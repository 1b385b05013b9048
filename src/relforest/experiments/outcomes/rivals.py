"""Learners of vectors that scenes are turned into: pooled features of pairs, or padded attributes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import HistGradientBoostingClassifier, RandomForestClassifier
from sklearn.model_selection import GridSearchCV
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC
from threadpoolctl import threadpool_limits

from relforest.experiments.outcomes.scenes import Labelled
from relforest.experiments.outcomes.settings import POOLED
from relforest.forests.bindings import bindings, column_values
from relforest.forests.columns import columns
from relforest.scenes import Scenes
from relforest.scenes.arrays import gather

Scores = Callable[[Scenes], NDArray[np.float64]]
"""What a learner returns: a function from scenes to scores (n,), which says yes above 0."""

Learner = Callable[[Labelled, int], Scores]
"""Learns from labelled scenes with an integer seed."""

_MOST_CHOICES: Final = 100_000
_SLOTS: Final = 12


def pooled(scenes: Scenes) -> NDArray[np.float64]:
    """Return vectors (n, k): whatever conditions may be about, pooled over the choices of free objects.

    There are all values of all mappings of the arguments; least, mean and largest of those that involve a
    free object (two in scenes without arguments); and the number of objects. NaN where nothing is defined.
    """
    n_parameters = scenes.schema.n_parameters
    vectors = [scenes.counts.astype(np.float64)]
    for n_free in range(2 if n_parameters else 3):
        free = set(range(n_parameters, n_parameters + n_free))
        wanted = tuple(each for each in columns(scenes.schema, n_free) if free <= set(each.variables))
        choices, _ = bindings(scenes, n_free, most=_MOST_CHOICES, rng=np.random.default_rng(0))
        for values in column_values(scenes, wanted, choices):
            vectors += [values] if n_free == 0 else _summaries(values, choices.starts)
    return np.column_stack(vectors)


def _summaries(values: NDArray[np.float64], starts: NDArray[np.int64]) -> Iterator[NDArray[np.float64]]:
    """Yield least, largest and mean of the defined values of each scene, (n,)."""
    some = np.flatnonzero(np.diff(starts))
    here = starts[some]
    is_known = ~np.isnan(values)
    n_known = np.add.reduceat(is_known.astype(np.float64), here)
    total = np.add.reduceat(np.where(is_known, values, 0.0), here)
    with np.errstate(invalid="ignore"):
        found = (np.fmin.reduceat(values, here), np.fmax.reduceat(values, here), total / n_known)
    for each in found:
        out = np.full(len(starts) - 1, np.nan)
        out[some] = each
        yield out


def padded(scenes: Scenes) -> NDArray[np.float64]:
    """Return vectors (n, k): the attributes of the arguments, then of the other objects in their order.

    There is room for `_SLOTS` objects; empty slots are 0.
    """
    width = scenes.schema.width
    out = np.zeros((len(scenes), _SLOTS, width))
    objects = gather(scenes.rows, scenes.starts, scenes.counts)
    ends = np.cumsum(scenes.counts)
    for number, (begin, end) in enumerate(zip(ends - scenes.counts, ends, strict=True)):
        arguments = scenes.arguments[number]
        others = objects[begin:end][~np.isin(objects[begin:end], arguments)]
        ordered = np.concatenate([arguments, others])
        out[number, : len(ordered)] = np.nan_to_num(scenes.matrix[ordered])
    return out.reshape(len(scenes), -1)


def _boosting(known: Labelled, seed: int) -> Scores:
    learner = HistGradientBoostingClassifier(
        learning_rate=0.05, max_iter=200, max_leaf_nodes=8, min_samples_leaf=10, random_state=seed
    )
    share = known.labels.mean()
    with threadpool_limits(1, "openmp"):
        learner.fit(pooled(known.scenes), known.labels)
    return lambda scenes: learner.predict_proba(pooled(scenes))[:, 1] - share


def _forest(known: Labelled, seed: int) -> Scores:
    learner = RandomForestClassifier(500, min_samples_leaf=2, random_state=seed)
    learner.fit(np.nan_to_num(pooled(known.scenes)), known.labels)
    share = known.labels.mean()
    return lambda scenes: learner.predict_proba(np.nan_to_num(pooled(scenes)))[:, 1] - share


def _machine(known: Labelled, seed: int) -> Scores:  # noqa: ARG001 - nothing random
    machine = make_pipeline(StandardScaler(), SVC(class_weight="balanced"))
    grid = {"svc__C": [0.1, 1.0, 10.0, 100.0]}
    # Balanced accuracy is (1 + PSS) / 2.
    chosen = GridSearchCV(machine, grid, scoring="balanced_accuracy").fit(padded(known.scenes), known.labels)
    return lambda scenes: chosen.decision_function(padded(scenes))


LEARNERS: Final[Mapping[str, Learner]] = dict(zip(POOLED, (_boosting, _forest, _machine), strict=True))
"""All say yes from the share of positive training scenes on, or count both classes alike."""
