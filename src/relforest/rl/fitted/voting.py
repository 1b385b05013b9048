"""Randomised trees of the distances that a sum of curves is of.

Curves add up, so that what a question says cannot depend on the answer to another one. Trees ask one after
the other, but need many leaves for what a curve says at once. The mean of both is better than either.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from relforest.rl.fitted.additive import Explained
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.forest_arrays import (
    LEAST_EXAMPLES,
    ForestArrays,
    forest_mean,
    joined,
    randomised,
    together,
)
from relforest.rl.fitted.settings import ForestSettings, QSettings
from relforest.rl.fitted.sum import Sum, distances
from relforest.scenes.arrays import FloatArray
from relforest.support.progress import report


def with_trees(
    explained: Explained,
    evidence: Evidence,
    settings: QSettings,
    rng: np.random.Generator,
    *,
    start: Sum | None = None,
) -> Sum:
    """Return the sum with trees that explain the same as its curves, and with the spread of its questions.

    Parameters
    ----------
    explained : Explained
    evidence : Evidence
    settings : QSettings
    rng : Generator
    start : Sum or None
        What was known before there was any of this experience. Its trees count like trees that were learned
        from `CurveSettings.prior` transitions. Its questions are the first of the sum.

    References
    ----------
    Geurts, Ernst and Wehenkel, Extremely randomized trees (2006).
    """
    report("trees")
    total, _, targets = explained
    margins = [
        own[evidence.examples(number, is_base=number == total.base)[1]]
        for number, own in enumerate(explained.margins)
    ]
    forests, trees, kept = settings.forests, None, 0
    if start is not None and start.trees is not None:
        kept = round(forests.trees * settings.curves.prior / (settings.curves.prior + len(targets)))
        trees = start.trees._replace(roots=start.trees.roots[:, :, :kept])
    if kept < forests.trees:
        grown = _grown(total, targets, evidence, margins, replace(forests, trees=forests.trees - kept), rng)
        trees = grown if trees is None else together(trees, grown)
    return _with_spreads(replace(total, trees=trees), margins)


def _grown(
    total: Sum,
    targets: FloatArray,
    evidence: Evidence,
    margins: list[FloatArray],
    settings: ForestSettings,
    rng: np.random.Generator,
) -> ForestArrays:
    """Return trees of the distances of each action type's examples, none where there is too little."""
    trees: list[list[Any]] = [[] for _ in total.schemas]
    types, of_base = evidence.types[evidence.taken], np.zeros(len(targets))
    for number in sorted(range(len(trees)), key=lambda number: number != total.base):
        is_base, own = number == total.base, np.flatnonzero(types == number)
        features = distances(margins[number])
        if len(own) > LEAST_EXAMPLES and features.shape[1]:
            model = randomised(settings, settings.share, rng, evidence.n_jobs)
            model.fit(features[own] if is_base else features, (targets - of_base)[own])
            trees[number] = [tree.tree_ for tree in model.estimators_]
        if is_base:
            forest = joined([[trees[number]]])
            of_trees = forest_mean(forest, forest.roots[0, 0], features)
            of_base = of_trees if trees[number] else total.valued(number, margins[number])
    return joined([trees])


def _with_spreads(total: Sum, margins: list[FloatArray]) -> Sum:
    """Return a sum that knows how much each question varies over the examples of its action type."""
    found = []
    for number, (own, seen) in enumerate(zip(total.questions, margins, strict=True)):
        spreads = total.adds(number, seen)[:, 1:].std(axis=0) if len(seen) else np.zeros(len(own))
        pairs = zip(own, spreads.tolist(), strict=True)
        found.append(tuple(replace(question, spread=spread) for question, spread in pairs))
    return replace(total, questions=tuple(found))
