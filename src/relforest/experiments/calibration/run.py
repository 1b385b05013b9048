"""A test and a size of scenes -> whether a tree grew on each of a number of label-shuffled scene sets."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.calibration.settings import CalibrationSetting
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.progress import report
from relforest.support.rng import generator, stream
from relforest.trees import SMRFTreeClassifier

_DATA, _LEARNING = 0, 1
_SCHEMA: Final = Schema((Attribute("location", 2),))


def compute(setting: CalibrationSetting, context: Context) -> list[Row]:
    """Return a row per scene set: test, objects, scenes, block, set, accepted.

    A set counts as accepted if its tree is not a stub, that is, if the test accepted a question at the root.

    References
    ----------
    Palmer (2015), section 4.2 (the likelihood ratio test); the permutation test is our addition.
    """
    rows: list[Row] = []
    for number in range(setting.n_sets):
        report("sets of scenes", number, setting.n_sets)
        scenes, labels = noise(generator(stream(context.stream, number, _DATA)), setting)
        learner = SMRFTreeClassifier(
            test=setting.test,
            alpha=setting.alpha,
            permutations=setting.permutations,
            random_state=stream(context.stream, number, _LEARNING),
        )
        rows.append(
            {
                "test": setting.label,
                "objects": setting.objects,
                "scenes": setting.n_scenes,
                "block": setting.block,
                "set": number,
                "accepted": not learner.fit(scenes, labels).tree_.is_stub,
            }
        )
    return rows


def noise(rng: np.random.Generator, setting: CalibrationSetting) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw scenes with normal locations, and labels that have nothing to do with them.

    Returns
    -------
    scenes : Scenes
        Attribute ``location`` (2-D), no arguments.
    labels : (n_scenes,) bool
        Half of them True, in random order.
    """
    counts = rng.integers(setting.fewest, setting.most + 1, size=setting.n_scenes)
    matrix = rng.standard_normal((int(counts.sum()), 2))
    labels = np.arange(setting.n_scenes) < setting.n_scenes // 2
    rng.shuffle(labels)
    starts = np.cumsum(counts) - counts
    arguments = np.empty((setting.n_scenes, 0), dtype=np.int64)
    return Scenes(_SCHEMA, matrix, np.arange(len(matrix)), starts, counts, arguments), labels
