"""Jobs and methods that misbehave in known ways; other processes import them by name."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

from relforest.datasets import BagSet
from relforest.experiments.mil.data import Standard, Synthetic
from relforest.experiments.mil.folds import fold_tasks, trial_tasks
from relforest.experiments.mil.limited import run_job
from relforest.experiments.mil.methods import Method
from relforest.experiments.mil.settings import MilSetting
from relforest.experiments.mil.steps import Job, Task

MEGABYTE = 10**6


def echo(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps whose values tell what was asked for, and in which process."""
    return lambda number: Task(
        lambda: asked["start"] + number, lambda result: {"number": result, "process": os.getpid()}
    )


def second_burns(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps of which the second never comes back from compiled code."""
    del asked
    return lambda number: Task(lambda: sum(range(10**14)) if number == 1 else 0, lambda _: {})


def second_crashes(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps of which the second fails."""
    del asked

    def crash() -> None:
        raise ValueError("no luck today")

    return lambda number: Task(crash if number == 1 else int, lambda _: {})


def second_is_killed(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps of which the second ends its process as a lack of memory does."""
    del asked
    return lambda number: Task(lambda: os.kill(os.getpid(), 9) if number == 1 else 0, lambda _: {})


def second_is_large(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps of which the second needs memory."""

    def allocate(number: int) -> int:
        return len(bytearray(asked["megabytes"] * MEGABYTE)) if number == 1 else 0

    return lambda number: Task(lambda: allocate(number), lambda size: {"size": size})


def never_begins(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps before which the process gets the signal of one that took too much CPU time."""
    del asked
    os.kill(os.getpid(), signal.SIGXCPU)
    return lambda _: Task(int, lambda _: {})


def second_waits(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    """Steps of which the second waits for a minute; the first tells its process."""
    del asked
    return lambda number: Task(
        lambda: time.sleep(60) if number == 1 else None, lambda _: {"process": os.getpid()}
    )


@final
class Threshold:
    """Calls a bag positive whose largest first component is above a threshold."""

    def __init__(self, *, C: float = 1.0, gamma_factor: float = 1.0) -> None:
        self.threshold = C * gamma_factor

    def get_params(self) -> dict[str, float]:
        return {}

    def fit(self, bags: list[NDArray[np.float64]], y: NDArray[np.bool_]) -> Self:
        assert len(bags) == len(y)
        return self

    def predict(self, bags: list[NDArray[np.float64]]) -> NDArray[np.bool_]:
        return np.array([bag[:, 0].max() > self.threshold for bag in bags])


@final
class Stubborn:
    """Burns CPU time without end once it sees more than a small problem."""

    def get_params(self) -> dict[str, float]:
        return {}

    def fit(self, bags: list[NDArray[np.float64]], y: NDArray[np.bool_]) -> Self:
        if len(bags) == len(y) > 10:
            sum(range(10**14))
        return self

    def predict(self, bags: list[NDArray[np.float64]]) -> NDArray[np.bool_]:
        return np.array([True for _ in bags])


def draw_steps(rng: np.random.Generator, n_bags: int) -> BagSet:
    """Bags of two points below 1; positive ones also have a point between 1.5 and 2.5."""
    labels = np.arange(n_bags) % 2 == 0
    points = rng.random((n_bags, 3, 2))
    points[labels, 0, 0] = rng.uniform(1.5, 2.5, labels.sum())
    return BagSet(list(points), labels)


def fetch_steps() -> BagSet:
    """Return 23 such bags that are there once."""
    return draw_steps(np.random.default_rng(0), 23)


DRAWN = Synthetic("Steps", 0, draw_steps)
FIXED = Standard("Fixed steps", 1, fetch_steps)
FAKES = {
    "covagg": Method("Threshold", 0, Threshold),
    "dd": Method("Stubborn", 1, Stubborn),
    "miles-tuned": Method("Threshold*", 2, Threshold, is_tuned=True),
}


def fake_folds(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    setting = MilSetting(**asked["setting"])
    data_set = FIXED if setting.data_set == "musk1" else DRAWN
    return fold_tasks(setting, data_set, FAKES[setting.method], asked["seed"], asked["parameters"])


def fake_trials(asked: Mapping[str, Any]) -> Callable[[int], Task]:
    setting = MilSetting(**asked["setting"])
    return trial_tasks(setting, DRAWN, FAKES[setting.method], asked["seed"])


def main() -> None:
    """Run a job whose second step waits, in the folder given; for a test that kills this process."""
    run_job(Job(second_waits, {}, 2, 60.0, Path(sys.argv[1])), "waiting")
