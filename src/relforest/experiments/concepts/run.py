"""A concept, a learner and a seed -> the test scores of the model, and the model in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from relforest.datasets import between_scenes, figure41_scenes, yellow_scenes
from relforest.experiments.concepts.ellipse import CentredEllipse
from relforest.experiments.concepts.settings import (
    CROWDED,
    LARGER,
    N_DISTRACTORS,
    N_OBJECTS,
    N_OBJECTS_LARGER,
    SAME,
    ConceptSetting,
)
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.forests import SMRFBoostingClassifier, SMRFForestClassifier, SMRFRuleSetClassifier
from relforest.metrics import peirce_skill_score
from relforest.scenes import Scenes
from relforest.support.progress import report
from relforest.support.rng import generator, seed_sequence, stream
from relforest.trees import SMRFTreeClassifier

Labelled: TypeAlias = tuple[Scenes, NDArray[np.bool_]]
Draw: TypeAlias = Callable[[np.random.Generator, int], Labelled]

_TRAINING, _TESTING, _LEARNING = 0, 1, 2
_ELLIPSE_SEED: Final = 20_000


def compute(setting: ConceptSetting, context: Context) -> list[Row]:
    """Return a row per set of test scenes: concept, method, replicate, test, pss, leaves, words, ellipse.

    The last one, for "between", is the score of the best single ellipse on the same test scenes.

    Training and test scenes depend on concept and replicate only: methods are compared on the same data.

    References
    ----------
    Palmer (2015), section 4.2 and Figure 4.1 (learning relational concepts), section 3.3.3 (the score).
    """
    draw_training, *draw_testing = SCENES[setting.concept]
    seed = stream(seed_sequence(context.seed), list(SCENES).index(setting.concept), setting.replicate)
    scenes, labels = draw_training[1](generator(stream(seed, _TRAINING)), setting.n_scenes)
    learned = _learned(setting, scenes, labels, stream(seed, _LEARNING))
    trees = [learned.tree_] if isinstance(learned, SMRFTreeClassifier) else learned.ensemble_.trees
    rows: list[Row] = []
    for number, (test, draw) in enumerate([draw_training, *draw_testing]):
        report(f"testing on {test}")
        new_scenes, truth = draw(generator(stream(seed, _TESTING, number)), setting.n_scenes)
        rows.append(
            {
                "concept": setting.concept,
                "method": setting.method,
                "replicate": setting.replicate,
                "test": test,
                "pss": peirce_skill_score(truth, learned.predict(new_scenes)),
                "leaves": sum(len(tree.leaves) for tree in trees),
                "words": str(trees[0]) if isinstance(learned, SMRFTreeClassifier) else learned.describe(),
                "ellipse": _ellipse_score(draw, setting.n_scenes, (new_scenes, truth)),
            }
        )
    return rows


def _learned(
    setting: ConceptSetting, scenes: Scenes, labels: NDArray[np.bool_], seed: np.random.SeedSequence
) -> SMRFTreeClassifier | SMRFBoostingClassifier | SMRFForestClassifier | SMRFRuleSetClassifier:
    match setting.learner:
        case "tree":
            tree = SMRFTreeClassifier(alpha=setting.alpha, max_points=setting.max_points, random_state=seed)
            return tree.fit(scenes, labels)
        case "boosting":
            return SMRFBoostingClassifier(random_state=seed).fit(scenes, labels)
        case "forest":
            return SMRFForestClassifier(random_state=seed).fit(scenes, labels)
        case "rules":
            return SMRFRuleSetClassifier(random_state=seed).fit(scenes, labels)


def _ellipse_score(draw: Draw, n_scenes: int, tested: Labelled) -> float | None:
    if draw not in (_between, _between_larger, _between_crowded):
        return None
    scenes, truth = tested
    return peirce_skill_score(truth, _best_ellipse(draw, n_scenes).predict(scenes))


@cache
def _best_ellipse(draw: Draw, n_scenes: int) -> CentredEllipse:
    """Fit the ellipse to enough scenes that its score is nearly the best possible."""
    return CentredEllipse.best(*draw(np.random.default_rng(_ELLIPSE_SEED), 20 * n_scenes))


_between: Final = partial(between_scenes, n_objects=N_OBJECTS)
_between_larger: Final = partial(between_scenes, n_objects=N_OBJECTS_LARGER)
_between_crowded: Final = partial(between_scenes, n_objects=N_OBJECTS, n_distractors=N_DISTRACTORS)

SCENES: Final[Mapping[str, tuple[tuple[str, Draw], ...]]] = {
    "between": ((SAME, _between), (LARGER, _between_larger), (CROWDED, _between_crowded)),
    "between-crowded": ((SAME, _between_crowded),),
    "figure41": (
        (SAME, partial(figure41_scenes, n_objects=N_OBJECTS)),
        (LARGER, partial(figure41_scenes, n_objects=N_OBJECTS_LARGER)),
    ),
    "yellow": (
        (SAME, partial(yellow_scenes, n_objects=N_OBJECTS)),
        (LARGER, partial(yellow_scenes, n_objects=N_OBJECTS_LARGER)),
    ),
}
"""For each concept the scenes that its trees are tested on; the first one is also learned from."""
