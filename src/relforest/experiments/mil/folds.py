"""What a step is: to learn from a fold and predict it, or to try parameters on draws of their own."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.mil.data import (
    DATA_SETS,
    DataSet,
    Split,
    Synthetic,
    splitter,
    tuning_splits,
)
from relforest.experiments.mil.grid import grid_points
from relforest.experiments.mil.methods import METHODS, Method, Parameters
from relforest.experiments.mil.settings import MilSetting
from relforest.experiments.mil.steps import Task
from relforest.experiments.table import Cell
from relforest.metrics import peirce_skill_score
from relforest.support.errors import InputError
from relforest.support.rng import generator, seed_sequence, stream

# The streams of a seed; those of the data are 0 to 2.
_LEARNING, _TRIALS = 3, 4
_SMALL_BAGS: Final = (10, 3)

Predictions = list[NDArray[Any]]


def prepare_folds(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Return the tasks of a setting: learn from a fold, predict it, and count hits and false alarms.

    Parameters
    ----------
    asked : mapping
        ``setting`` (the fields of a `MilSetting`), ``seed``, ``parameters`` (those that were chosen).
    """
    setting = MilSetting(**asked["setting"])
    return fold_tasks(
        setting, DATA_SETS[setting.data_set], METHODS[setting.method], asked["seed"], asked["parameters"]
    )


def fold_tasks(
    setting: MilSetting, data_set: DataSet, method: Method, seed: int, parameters: Parameters
) -> Callable[[int], Task]:
    """Return the task of each fold; the method is warmed up when this returns."""
    split_of = splitter(data_set, seed=seed, n_bags=setting.n_bags)
    warm_up(method, width=split_of(0).train.bags[0].shape[1], parameters=parameters)

    def task(fold: int) -> Task:
        split = split_of(fold)
        own = stream(seed_sequence(seed), _LEARNING, data_set.key, method.key, fold)
        return Task(
            lambda: predictions(method, [split], [own], parameters),
            lambda predicted: {"pss": skill(split, predicted[0]), **counts(split)},
        )

    return task


def prepare_trials(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Return the tasks of tuning: the mean score with the parameters of one point of the grid.

    Parameters
    ----------
    asked : mapping
        ``setting`` (the fields of a `MilSetting`) and ``seed``.
    """
    setting = MilSetting(**asked["setting"])
    data_set = DATA_SETS[setting.data_set]
    if not isinstance(data_set, Synthetic):
        raise InputError(f"parameters are tuned on fresh draws, and of {data_set.title} there are none")
    return trial_tasks(setting, data_set, METHODS[setting.method], asked["seed"])


def trial_tasks(setting: MilSetting, data_set: Synthetic, method: Method, seed: int) -> Callable[[int], Task]:
    """Return the task of each point of the grid; the method is warmed up when this returns."""
    splits = tuning_splits(data_set, seed=seed, n_bags=setting.n_bags, count=setting.tuning_draws)
    points = grid_points(setting.grid_step)
    warm_up(method, width=splits[0].train.bags[0].shape[1], parameters=points[0])

    def task(number: int) -> Task:
        base = stream(seed_sequence(seed), _TRIALS, data_set.key, method.key)
        own = [stream(base, draw) for draw in range(len(splits))]
        return Task(
            lambda: predictions(method, splits, own, points[number]),
            lambda predicted: {"pss": float(np.mean(list(map(skill, splits, predicted))))},
        )

    return task


def predictions(
    method: Method, splits: list[Split], seeds: list[np.random.SeedSequence], parameters: Parameters
) -> Predictions:
    """Learn from the training bags of every split, and return the predicted labels of its test bags."""
    return [
        method.learner(seed, parameters).fit(split.train.bags, split.train.labels).predict(split.test.bags)
        for split, seed in zip(splits, seeds, strict=True)
    ]


def skill(split: Split, predicted: NDArray[Any]) -> float:
    """Return the Peirce skill score on the test bags; it is an error if they lack one of the labels."""
    return peirce_skill_score(split.test.labels, predicted)


def counts(split: Split) -> dict[str, Cell]:
    """Return how large training and test set together are."""
    parts = (split.train, split.test)
    return {
        "n_bags": sum(len(part.bags) for part in parts),
        "n_positive": sum(int(part.labels.sum()) for part in parts),
        "n_instances": sum(len(bag) for part in parts for bag in part.bags),
        "n_features": split.train.bags[0].shape[1],
    }


def warm_up(method: Method, *, width: int, parameters: Parameters) -> None:
    """Learn a small problem of the same width, so that nothing is compiled or loaded while time is taken."""
    rng = generator(seed_sequence(0))
    labels = np.arange(_SMALL_BAGS[0]) % 2 == 0
    bags = list(rng.standard_normal((*_SMALL_BAGS, width)) + labels[:, None, None])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        method.learner(seed_sequence(0), parameters).fit(bags, labels).predict(bags)
