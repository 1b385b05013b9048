"""The source's experiment: many draws of trees from one forest, judged on a second set of scenes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedKFold

from relforest.experiments.outcomes.scenes import TESTING, TRAINING, Labelled
from relforest.experiments.outcomes.settings import CURVE, SIZES, OutcomeSetting
from relforest.experiments.table import Row
from relforest.forests import SMRFForestClassifier
from relforest.forests.features import features
from relforest.forests.linear_machine import FOLDS, weighed
from relforest.metrics import peirce_skill_score
from relforest.support.progress import report
from relforest.support.rng import generator, stream
from relforest.trees import Question, Tree, TreeSettings

_FOREST, _DRAWS = range(2)
# Of the sizes other than the largest, so many draws are enough for a curve.
_FEWER: Final = 4


def repeated(
    setting: OutcomeSetting, sets: Mapping[tuple[str, int], Labelled], seed: np.random.SeedSequence
) -> Iterator[Row]:
    """Yield scores of small forests, shares of stubs and of mappings in questions.

    A forest of each size of scenes is learned from all training scenes. Draws of as many trees for the labels
    as for the negated ones are weighed and judged by cross-validation on a second set of scenes; for scenes
    of the other size, by the machine of all of the second set.
    """
    for number, trained in enumerate(SIZES):
        scenes, labels = sets[trained, TRAINING]
        forest = SMRFForestClassifier(
            n_trees=setting.smrf_trees,
            max_samples=1.0,
            growth=TreeSettings(),
            random_state=stream(seed, _FOREST, number),
        ).fit(scenes, labels)
        trees = [tree for tree in forest.ensemble_.trees if isinstance(tree, Tree)]
        for measure, value in shares(trees).items():
            yield row(trained, trained, "all trees", measure, value)
        said = {size: features(forest.ensemble_, sets[size, TESTING].scenes, "probability") for size in SIZES}
        negated = forest.ensemble_.weights < 0.0
        most = setting.smrf_trees // 4
        sizes = sorted({min(size, most) for size in CURVE})
        rng = generator(stream(seed, _DRAWS, number))
        for size in sizes:
            n_draws = setting.repeats if size == sizes[-1] else min(setting.repeats, _FEWER)
            for draw in range(n_draws):
                report(f"{trained} scenes, {size} + {size} trees, draws", draw, n_draws)
                chosen = np.concatenate(
                    [rng.choice(np.flatnonzero(kind), size, replace=False) for kind in (negated, ~negated)]
                )
                for tested in SIZES:
                    second = (said[trained][:, chosen], sets[trained, TESTING].labels)
                    other = (said[tested][:, chosen], sets[tested, TESTING].labels)
                    score = (
                        cross_validated(*second, rng)
                        if tested == trained
                        else transferred(second, other, rng)
                    )
                    yield row(trained, tested, f"{size} + {size}", "pss", score)


def shares(trees: list[Tree]) -> dict[str, float]:
    """Return the share of trees without questions, and of each mapping among all questions."""
    asked = Counter(
        node.mapping.operation if node.mapping.attribute.name == "location" else node.mapping.name
        for tree in trees
        for node in tree.nodes
        if isinstance(node, Question)
    )
    total = max(asked.total(), 1)
    stubs = float(np.mean([tree.is_stub for tree in trees]))
    return {"stubs": stubs} | {f"share of {name}": n / total for name, n in asked.most_common()}


def cross_validated(
    columns: NDArray[np.float64], labels: NDArray[np.bool_], rng: np.random.Generator
) -> float:
    """Return the Peirce skill score of all scenes, each judged by a machine that has not seen it."""
    said = np.empty(len(labels), dtype=np.bool_)
    folds = StratifiedKFold(FOLDS, shuffle=True, random_state=int(rng.integers(2**31)))
    for training, held in folds.split(columns, labels):
        said[held] = _judged((columns[training], labels[training]), columns[held], rng)
    return peirce_skill_score(labels, said)


def transferred(
    known: tuple[NDArray[np.float64], NDArray[np.bool_]],
    other: tuple[NDArray[np.float64], NDArray[np.bool_]],
    rng: np.random.Generator,
) -> float:
    """Return the Peirce skill score of a machine on other scenes."""
    return peirce_skill_score(other[1], _judged(known, other[0], rng))


def _judged(
    known: tuple[NDArray[np.float64], NDArray[np.bool_]],
    columns: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.bool_]:
    machine = weighed(*known, np.ones(len(known[1])), rng)
    return np.asarray(machine.start + columns @ machine.weights >= machine.boundary)


def row(trained: str, tested: str, method: str, measure: str, value: float) -> Row:
    """Return a row of the table."""
    return {"trained": trained, "tested": tested, "method": method, "measure": measure, "value": value}
