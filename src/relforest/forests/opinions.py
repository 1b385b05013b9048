"""What several groups of trees say about the scenes they were learned from, as columns to be weighed.

Letters: n scenes, t trees, k columns.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from sklearn.model_selection import StratifiedKFold

from relforest.forests.boosting_estimators import SMRFBoostingClassifier
from relforest.forests.features import features
from relforest.forests.forest_estimators import FOREST_GROWTH, SMRFForestClassifier
from relforest.support.rng import stream

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.ensemble import Ensemble
    from relforest.forests.scene_tree import SceneTree
    from relforest.forests.settings import GrowthSettings
    from relforest.scenes import Scenes
    from relforest.trees import Tree

FOLDS: Final = 5
"""Boosted models, each learned without another part of the scenes."""

_LEARNING_RATE: Final = 0.05


class Labelled(NamedTuple):
    """Scenes of two classes."""

    scenes: Scenes
    positive: NDArray[np.bool_]  # (n,)
    weights: NDArray[np.float64]  # (n,) positive


class Opinions(NamedTuple):
    """Trees, and what the groups that they belong to say."""

    trees: tuple[SceneTree | Tree, ...]
    shares: NDArray[np.float64]  # (t, k) the factor of each tree in each column
    starts: NDArray[np.float64]  # (k,) what the sums of trees are added to
    columns: NDArray[np.float64]  # (n, k) about the scenes they were learned from
    n_sampled: int  # scenes or, for SMRF trees, expansions that were searched by a sample
    n_left_out: int  # expansions that were not searched


def opinions_of_conditions(
    known: Labelled,
    n_trees: int,
    max_samples: float,
    growth: GrowthSettings,
    seed: np.random.SeedSequence,
    n_jobs: int,
) -> Opinions:
    """Learn boosted models and a forest of trees of conditions.

    There are two columns: the mean log-odds of `FOLDS` boosted models, each learned without one part of the
    scenes, and the mean probability of a forest. What they say about a scene is what those models and trees
    say that have not seen it, so that they can be weighed without new scenes.

    Each boosted model and the forest have `n_trees`. The growth is that of boosting; the forest takes over
    what a condition may be, and has trees of the size of its own, which see `max_samples`.
    """
    scenes, positive, weights = known
    boosted: list[SMRFBoostingClassifier] = []
    columns = np.empty((len(positive), 2))
    splitter = StratifiedKFold(FOLDS, shuffle=True, random_state=int(stream(seed, 0).generate_state(1)[0]))
    for number, (training, held) in enumerate(splitter.split(columns, positive)):
        model = SMRFBoostingClassifier(
            n_trees=n_trees, learning_rate=_LEARNING_RATE, growth=growth, random_state=stream(seed, 1, number)
        )
        model.fit(scenes.take(training).compact(), positive[training], weights[training])
        columns[held, 0] = model.ensemble_.scores(scenes.take(held))[:, 0]
        boosted.append(model)
    size = {name: getattr(FOREST_GROWTH, name) for name in ("max_leaves", "share", "min_scenes", "penalty")}
    forest = SMRFForestClassifier(
        n_trees=n_trees,
        max_samples=max_samples,
        growth=replace(growth, **size),
        random_state=stream(seed, 2),
        n_jobs=n_jobs,
    ).fit(scenes, positive, weights)
    unseen = forest.oob_decision_function_[:, 1]
    columns[:, 1] = np.where(np.isnan(unseen), np.average(positive, weights=weights), unseen)
    groups: list[list[Ensemble]] = [[model.ensemble_ for model in boosted], [forest.ensemble_]]
    trees: list[SceneTree | Tree] = []
    shares: list[NDArray[np.float64]] = []
    for column, group in enumerate(groups):
        for ensemble in group:
            trees += ensemble.trees
            shares.append(np.outer(ensemble.weights / len(group), np.arange(2) == column))
    for column, group in enumerate(groups):
        if all(len(tree.leaves) == 1 for ensemble in group for tree in ensemble.trees):
            # Without questions, trees know only of which scenes they were deprived.
            columns[:, column] = columns[:, column].mean()
    starts = np.array([np.mean([ensemble.start[0] for ensemble in group]) for group in groups])
    n_sampled = max(model.n_sampled_ for model in [*boosted, forest])
    return Opinions(tuple(trees), np.concatenate(shares), starts, columns, n_sampled, 0)


def opinions_of_smrf_trees(known: Labelled, forest: SMRFForestClassifier) -> Opinions:
    """Learn a forest of SMRF trees, half of them for negated labels; the probability of each is a column.

    The forest is fitted.

    Notes
    -----
    The trees have seen the scenes that they are weighed by, unlike in the source, which has a second set of
    them: for that, see `SceneFeatures`.
    """
    ensemble = forest.fit(known.scenes, known.positive, known.weights).ensemble_
    columns = features(ensemble, known.scenes, "probability")
    n = len(ensemble.trees)
    return Opinions(ensemble.trees, np.eye(n), np.zeros(n), columns, forest.n_sampled_, forest.n_left_out_)
