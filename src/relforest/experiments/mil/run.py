"""A fold of a data set and a method -> one row."""

from __future__ import annotations

import gc
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.mil.data import DATA_SETS, Split, Synthetic, splitter, tuning_splits
from relforest.experiments.mil.methods import METHODS, Method, Parameters
from relforest.experiments.mil.settings import DONE, STOPPED, MilSetting
from relforest.experiments.study import Context
from relforest.experiments.table import Cell, Row
from relforest.metrics import peirce_skill_score
from relforest.mil.baselines import svm_grid
from relforest.support.errors import InputError
from relforest.support.limited import LimitedProcess, cpu_limit, cpu_seconds
from relforest.support.progress import report
from relforest.support.rng import generator, seed_sequence, stream

# The streams of a seed; those of the data are 0 to 2.
_LEARNING, _TRIALS = 3, 4
_SMALL_BAGS: Final = (10, 3)
_COUNTS: Final = ("n_bags", "n_positive", "n_instances", "n_features")

_PROCESS: Final = LimitedProcess()
"""Where learners run: memory and time are theirs alone, and one that never ends does not end the study."""
_HOPELESS: Final[set[tuple[str, str]]] = set()
"""Data set and method of which a fold took too long in this process: the others are not tried."""


def compute(setting: MilSetting, context: Context) -> list[Row]:
    """Return one row.

    Its columns are data_set, method, fold, state (`DONE`, or `STOPPED` for a fold that took too long, or of
    which another one did), pss, cpu_seconds, peak_bytes, C and gamma_factor (where they were chosen), n_bags,
    n_positive, n_instances and n_features of training and test set together. Times and memory differ from run
    to run.

    References
    ----------
    Palmer (2015), section 3.3.
    """
    cell, name = (setting.data_set, setting.method), f"{setting.data_set}, {setting.method}"
    found: Mapping[str, Cell] | None = None
    peak: int | None = None
    parameters = tuned(replace(setting, fold=0), context.seed) if setting.tuning_draws else {}
    if cell not in _HOPELESS and parameters is not None:
        found, peak = _PROCESS.call(name, measured, setting, context.seed, parameters)
    if found is None:
        _HOPELESS.add(cell)
    numbers, chosen = found or {}, parameters or {}
    return [
        {
            "data_set": setting.data_set,
            "method": setting.method,
            "fold": setting.fold,
            "state": STOPPED if found is None else DONE,
            "pss": numbers.get("pss"),
            "cpu_seconds": numbers.get("cpu_seconds"),
            "peak_bytes": peak,
            "C": chosen.get("C"),
            "gamma_factor": chosen.get("gamma_factor"),
            **{name: numbers.get(name) for name in _COUNTS},
        }
    ]


def measured(setting: MilSetting, seed: int, parameters: Parameters) -> dict[str, Cell] | None:
    """Learn from a fold and predict it, after a first small problem: its score, time and size.

    Return None if it took longer than allowed; then this process may as well have ended.
    """
    data_set, method = DATA_SETS[setting.data_set], METHODS[setting.method]
    split = splitter(data_set, seed=seed, n_bags=setting.n_bags)(setting.fold)
    own = stream(seed_sequence(seed), _LEARNING, data_set.key, method.key, setting.fold)
    done = _timed(setting.cpu_limit, method, [split], [own], parameters)
    if done is None:
        return None
    (predicted,), seconds = done
    parts = (split.train, split.test)
    return {
        "pss": peirce_skill_score(split.test.labels, predicted),
        "cpu_seconds": seconds,
        "n_bags": sum(len(part.bags) for part in parts),
        "n_positive": sum(int(part.labels.sum()) for part in parts),
        "n_instances": sum(len(bag) for part in parts for bag in part.bags),
        "n_features": split.train.bags[0].shape[1],
    }


@cache
def tuned(setting: MilSetting, seed: int) -> Mapping[str, float] | None:
    """Return the parameters with the best mean score on draws that serve nothing else, the first of equals.

    They are found anew by every process that computes folds of a tuned method.

    Returns
    -------
    mapping or None
        None if all took too long.
    """
    points, scored = grid_points(setting.grid_step), []
    for number, point in enumerate(points):
        report("points of the grid", number, len(points))
        score, _ = _PROCESS.call(f"{setting.data_set}, {setting.method}, tuning", tried, setting, seed, point)
        if score is not None:
            scored.append((score, -number))
    return points[-max(scored)[1]] if scored else None


def tried(setting: MilSetting, seed: int, parameters: Parameters) -> float | None:
    """Return the mean score with these parameters over the draws for tuning; None if it took too long."""
    data_set, method = DATA_SETS[setting.data_set], METHODS[setting.method]
    if not isinstance(data_set, Synthetic):
        raise InputError(f"parameters are tuned on fresh draws, and of {data_set.title} there are none")
    splits = tuning_splits(data_set, seed=seed, n_bags=setting.n_bags, count=setting.tuning_draws)
    base = stream(seed_sequence(seed), _TRIALS, data_set.key, method.key)
    done = _timed(
        setting.trial_limit, method, splits, [stream(base, draw) for draw in range(len(splits))], parameters
    )
    if done is None:
        return None
    scores = [
        peirce_skill_score(split.test.labels, predicted)
        for split, predicted in zip(splits, done[0], strict=True)
    ]
    return float(np.mean(scores))


def grid_points(step: int) -> tuple[dict[str, float], ...]:
    """Return points of the source's grid, those with values nearest to the constant parameters first.

    A `step` of 1 gives the whole grid of `svm_grid`, k every k-th power, counted from the constant
    parameters.
    """
    axes = svm_grid("full")
    costs = _every(axes["C"], 10, step)
    factors = _every(axes["gamma_factor"], 2, step)
    return tuple({"C": cost, "gamma_factor": factor} for cost, factor in product(costs, factors))


def _every(values: Sequence[float], base: float, step: int) -> list[float]:
    """Return the values with exponents that differ from that of the constant one by multiples of the step."""
    return [value for value in values if round(math.log(value / values[0], base)) % step == 0]


def _timed(
    limit: float,
    method: Method,
    splits: Sequence[Split],
    seeds: Sequence[np.random.SeedSequence],
    parameters: Parameters,
) -> tuple[list[NDArray[Any]], float] | None:
    """Return the labels predicted for the test bags of every split, and the CPU seconds of it all."""
    _warm_up(method, splits[0].train.bags[0].shape[1])
    with cpu_limit(limit):
        begin = cpu_seconds()
        predicted = [
            method.learner(seed, parameters)
            .fit(split.train.bags, split.train.labels)
            .predict(split.test.bags)
            for split, seed in zip(splits, seeds, strict=True)
        ]
        seconds = cpu_seconds() - begin
    # The operating system counts whole seconds.
    return None if seconds > limit else (predicted, seconds)


@cache
def _warm_up(method: Method, width: int) -> None:
    """Learn a small problem of the same width, so that nothing is compiled or loaded while time is taken."""
    rng = generator(seed_sequence(0))
    labels = np.arange(_SMALL_BAGS[0]) % 2 == 0
    bags = list(rng.standard_normal((*_SMALL_BAGS, width)) + labels[:, None, None])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        method.learner(seed_sequence(0), {}).fit(bags, labels).predict(bags)
    # Looking through all that was imported for garbage takes longer than some folds.
    gc.freeze()
