"""A data set -> the test score of covariant aggregation on each of its pairs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from relforest.datasets import BagSet, covariant1, covariant2, disjunctive
from relforest.experiments.covagg.settings import CovAggSetting
from relforest.experiments.study import Place
from relforest.experiments.table import Row
from relforest.metrics import peirce_skill_score
from relforest.mil import CovAggClassifier
from relforest.support.progress import report
from relforest.support.rng import generator, stream

_DATA, _LEARNING = 0, 1

GENERATORS: Final[Mapping[str, Callable[[np.random.Generator, int], BagSet]]] = MappingProxyType(
    {
        "covariant1-sqrt2": lambda rng, n: covariant1(rng, reading="sqrt2", n_bags=n),
        "covariant1-printed": lambda rng, n: covariant1(rng, reading="printed", n_bags=n),
        "covariant2": lambda rng, n: covariant2(rng, n_bags=n),
        "disjunctive": lambda rng, n: disjunctive(rng, n_bags=n),
    }
)


def compute(setting: CovAggSetting, place: Place) -> list[Row]:
    """Return a row per pair of a training and a test set: data_set, pair, pss.

    References
    ----------
    Palmer (2015), section 3.3.1 (the data), section 3.3.3 (the score).
    """
    draw = GENERATORS[setting.data_set]
    rows: list[Row] = []
    for pair in range(setting.pairs):
        report("pairs of bags", pair, setting.pairs)
        rng = generator(stream(place.stream, pair, _DATA))
        train, test = draw(rng, setting.n_bags), draw(rng, setting.n_bags)
        learner = CovAggClassifier(random_state=stream(place.stream, pair, _LEARNING))
        predicted = learner.fit(train.bags, train.labels).predict(test.bags)
        rows.append(
            {"data_set": setting.data_set, "pair": pair, "pss": peirce_skill_score(test.labels, predicted)}
        )
    return rows
