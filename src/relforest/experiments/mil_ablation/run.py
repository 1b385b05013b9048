"""A data set -> the test score of every variant on each of its draws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedKFold

from relforest.datasets import BagSet, color, covariant1, covariant2, disjunctive, fetch_musk1
from relforest.experiments.mil_ablation.made_up import (
    digit_mixture,
    digits,
    elements,
    rare,
    three_parts,
    wide,
)
from relforest.experiments.mil_ablation.settings import VARIANTS, AblationSetting
from relforest.experiments.study import Place
from relforest.experiments.table import Row
from relforest.metrics import peirce_skill_score
from relforest.mil import CovAggClassifier, VolumeCommitteeClassifier
from relforest.mil.bag_classifier import BagClassifier
from relforest.support.rng import generator, stream

_DATA, _LEARNING, _FOLDS = 0, 1, 2
_N_FOLDS: Final = 10
_USUAL: Final = MappingProxyType({"rare": 150, "elements": 150})

# The last argument is 0 for training and 1 for test bags.
GENERATORS: Final[Mapping[str, Callable[[np.random.Generator, int, int], BagSet]]] = MappingProxyType(
    {
        "color": lambda rng, n, _: color(rng, n_bags=n),
        "covariant1": lambda rng, n, _: covariant1(rng, n_bags=n),
        "covariant2": lambda rng, n, _: covariant2(rng, n_bags=n),
        "disjunctive": lambda rng, n, _: disjunctive(rng, n_bags=n),
        "three-parts": lambda rng, n, _: three_parts(rng, n),
        "rare": lambda rng, n, _: rare(rng, n),
        "wide": lambda rng, n, _: wide(rng, n),
        "elements": lambda rng, n, _: elements(rng, n),
        "digits": lambda rng, n, half: digits(rng, n, half=half),
        "digit-mixture": lambda rng, n, half: digit_mixture(rng, n, half=half),
    }
)


def compute(setting: AblationSetting, place: Place) -> list[Row]:
    """Return a row per draw and variant: data_set, variant, draw, pss."""
    rows: list[Row] = []
    for draw in range(setting.draws):
        train, test = pair(setting, place, draw)
        for variant in setting.variants:
            untrained = learner(variant, stream(place.stream, draw, _LEARNING))
            predicted = untrained.fit(train.bags, train.labels).predict(test.bags)
            score = peirce_skill_score(test.labels, predicted)
            rows.append({"data_set": setting.data_set, "variant": variant, "draw": draw, "pss": score})
    return rows


def learner(variant: str, seed: np.random.SeedSequence) -> BagClassifier:
    """Return an untrained classifier of a variant."""
    options = VARIANTS[variant]
    if options is None:
        return CovAggClassifier(random_state=seed)
    return VolumeCommitteeClassifier(random_state=seed, **options)


def pair(setting: AblationSetting, place: Place, draw: int) -> tuple[BagSet, BagSet]:
    """Return the training and the test bags of a draw."""
    if setting.data_set in GENERATORS:
        rng = generator(stream(place.stream, draw, _DATA))
        n_bags = setting.n_bags or _USUAL.get(setting.data_set, 100)
        generate = GENERATORS[setting.data_set]
        return generate(rng, n_bags, 0), generate(rng, n_bags, 1)
    data = fetch_musk1()
    repeat, fold = divmod(draw, _N_FOLDS)
    shuffle = int(generator(stream(place.stream, repeat, _FOLDS)).integers(2**31))
    folds = StratifiedKFold(_N_FOLDS, shuffle=True, random_state=shuffle)
    train, test = list(folds.split(data.labels, data.labels))[fold]
    return _taken(data, train), _taken(data, test)


def _taken(data: BagSet, chosen: NDArray[np.int64]) -> BagSet:
    return BagSet([data.bags[number] for number in chosen], data.labels[chosen])
