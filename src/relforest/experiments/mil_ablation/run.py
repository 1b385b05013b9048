"""A data set -> the test score of every variant on each of its draws."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import count, islice
from typing import Final

import numpy as np

from relforest.datasets import BagSet, color, covariant1, covariant2, disjunctive, fetch_musk1
from relforest.experiments.mil.data import N_FOLDS, Split, cross_validation
from relforest.experiments.mil_ablation.made_up import (
    digit_mixture,
    digits,
    elements,
    rare,
    three_parts,
    wide,
)
from relforest.experiments.mil_ablation.settings import MUSK, VARIANTS, AblationSetting
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.metrics import peirce_skill_score
from relforest.mil import CovAggClassifier, VolumeCommitteeClassifier
from relforest.mil.bag_classifier import BagClassifier
from relforest.support.progress import report
from relforest.support.rng import generator, stream

_DATA, _LEARNING, _FOLDS = 0, 1, 2
_IN_HALVES: Final = ("digits", "digit-mixture")

GENERATORS: Final[Mapping[str, Callable[..., BagSet]]] = {
    "color": color,
    "covariant1": covariant1,
    "covariant2": covariant2,
    "disjunctive": disjunctive,
    "three-parts": three_parts,
    "rare": rare,
    "wide": wide,
    "elements": elements,
    "digits": digits,
    "digit-mixture": digit_mixture,
}


def compute(setting: AblationSetting, context: Context) -> list[Row]:
    """Return a row per draw and variant: data_set, variant, draw, pss."""
    rows: list[Row] = []
    for draw, split in enumerate(splits(setting, context)):
        train, test = split.train, split.test
        for number, variant in enumerate(setting.variants):
            report(f"draw {draw + 1} of {setting.draws}, variants", number, len(setting.variants))
            untrained = learner(variant, stream(context.stream, draw, _LEARNING))
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


def splits(setting: AblationSetting, context: Context) -> Iterator[Split]:
    """Yield the training and the test bags of every draw."""
    if setting.data_set == MUSK:
        yield from islice(_musk_folds(context.stream), setting.draws)
    else:
        for draw in range(setting.draws):
            yield _drawn(setting, generator(stream(context.stream, draw, _DATA)))


def _drawn(setting: AblationSetting, rng: np.random.Generator) -> Split:
    size = {"n_bags": setting.n_bags} if setting.n_bags else {}
    # No image of training is seen in the test.
    train, test = ({"half": 0}, {"half": 1}) if setting.data_set in _IN_HALVES else ({}, {})
    draw = GENERATORS[setting.data_set]
    return Split(draw(rng, **size, **train), draw(rng, **size, **test))


def _musk_folds(seed: np.random.SeedSequence) -> Iterator[Split]:
    """Yield the folds of one cross-validation after the other."""
    data = fetch_musk1()
    for repeat in count():
        yield from map(cross_validation(data, generator(stream(seed, repeat, _FOLDS))), range(N_FOLDS))
