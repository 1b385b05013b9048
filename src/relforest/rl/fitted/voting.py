"""Randomised trees of the distances that a sum of curves is of.

Curves add up, so that what a question says cannot depend on the answer to another one. Trees ask one after
the other, but need many leaves for what a curve says at once. The mean of both is better than either.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.forest_arrays import (
    LEAST_EXAMPLES,
    ForestArrays,
    forest_mean,
    joined,
    randomised,
    together,
)
from relforest.rl.fitted.questions import Measures, measured
from relforest.rl.fitted.settings import ForestSettings, QSettings
from relforest.rl.fitted.sum import Sum, distances
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.progress import report


def with_trees(
    total: Sum,
    targets: FloatArray,
    evidence: Evidence,
    settings: QSettings,
    rng: np.random.Generator,
    *,
    start: Sum | None = None,
) -> Sum:
    """Return a sum with trees that explain the same as its curves, and with the spread of its questions.

    Parameters
    ----------
    total : Sum
    targets : (n,) float64
        What each transition turned out to be worth.
    evidence : Evidence
    settings : QSettings
    rng : Generator
    start : Sum or None
        What was known before there was any of this experience. Its trees count like trees that were learned
        from `CurveSettings.prior` transitions. Its questions come first in `total`.

    References
    ----------
    Geurts, Ernst and Wehenkel, Extremely randomized trees (2006).
    """
    report("trees")
    seen = [
        measured(packed, scenes.take(_rows(total, evidence, number)), evidence.n_jobs)
        for number, (packed, scenes) in enumerate(zip(total.packed, evidence.scenes, strict=True))
    ]
    forests, before, kept = settings.forests, None if start is None else start.trees, 0
    if before is not None:
        kept = round(forests.trees * settings.curves.prior / (settings.curves.prior + len(targets)))
        before = before._replace(roots=before.roots[:, :, :kept])
    trees = None
    if kept < forests.trees:
        features, new = [distances(each) for each in seen], replace(forests, trees=forests.trees - kept)
        trees = _grown(total, targets, evidence, features, new, rng)
    both = together(before, trees) if before is not None and trees is not None else before or trees
    return _with_spreads(replace(total, trees=both), seen)


def _rows(total: Sum, evidence: Evidence, number: int) -> IntArray:
    return evidence.examples(number, is_base=number == total.base)[1]


def _grown(
    total: Sum,
    targets: FloatArray,
    evidence: Evidence,
    features: list[NDArray[np.float32]],
    settings: ForestSettings,
    rng: np.random.Generator,
) -> ForestArrays | None:
    """Return trees of the features of each action type's examples; None if the base was hardly tried."""
    trees: list[list[Any]] = [[] for _ in total.schemas]
    types, of_base = evidence.types[evidence.taken], np.zeros(len(targets))
    for number in sorted(range(len(trees)), key=lambda number: number != total.base):
        is_base, own = number == total.base, np.flatnonzero(types == number)
        if len(own) > LEAST_EXAMPLES:
            model = randomised(settings, settings.share, rng, evidence.n_jobs)
            model.fit(features[number][own] if is_base else features[number], (targets - of_base)[own])
            trees[number] = [tree.tree_ for tree in model.estimators_]
        if is_base:
            if not trees[number]:
                return None
            forest = joined([[trees[number]]])
            of_base = forest_mean(forest, forest.roots[0, 0], features[number])
    return joined([trees])


def _with_spreads(total: Sum, seen: list[Measures]) -> Sum:
    """Return a sum that knows how much each question varies over what was seen of each action type."""
    found = []
    for number, (own, measures) in enumerate(zip(total.questions, seen, strict=True)):
        adds = total.adds(number, measures)[:, 1:]
        spreads = adds.std(axis=0) if len(adds) else np.zeros(len(own))
        pairs = zip(own, spreads.tolist(), strict=True)
        found.append(tuple(replace(question, spread=spread) for question, spread in pairs))
    return replace(total, questions=tuple(found))
