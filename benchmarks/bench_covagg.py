"""Covariant aggregation: milliseconds a fit, how much faster than the plain twin, and the classifier."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from clock import median_seconds
from numpy.typing import NDArray
from peers import covagg as twin
from table import Cell, Table

from relforest.datasets import covariant1
from relforest.mil import CovAggClassifier
from relforest.support.parallel import one_blas_thread
from relforest.volumes import aggregate

Objective = Literal["accuracy", "log-likelihood"]
REPEATS = 50
TWIN_REPEATS = 15


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Bags to separate and the seed of the search."""

    points: NDArray[np.float64]
    starts: NDArray[np.int64]
    labels: NDArray[np.bool_]
    seed: int


@dataclass(frozen=True, slots=True)
class Case:
    """A row of the table."""

    name: str
    objective: Objective
    draw: Callable[[int], Problem]


def covariant(seed: int) -> Problem:
    """Covariant 1 of Palmer (2015), Table 3.1, in the reading that reproduces the source."""
    bags = covariant1(np.random.default_rng(seed))
    return flat(np.stack(bags.bags), bags.labels, seed)


def clustered(n_bags: int, size: int, dim: int) -> Callable[[int], Problem]:
    """Standard normal points; half of the bags hold one from N(1, .09 I) instead."""

    def draw(seed: int) -> Problem:
        rng = np.random.default_rng(seed)
        points = rng.standard_normal((n_bags, size, dim))
        labels = np.arange(n_bags) % 2 == 0
        points[labels, 0] = 1 + 0.3 * rng.standard_normal((np.count_nonzero(labels), dim))
        return flat(points, labels, seed)

    return draw


def flat(points: NDArray[np.float64], labels: NDArray[np.bool_], seed: int) -> Problem:
    """Return bags (n_bags, size, d) as rows grouped by bag."""
    n_bags, size, dim = points.shape
    return Problem(points.reshape(-1, dim), np.arange(n_bags + 1) * size, labels, seed)


CASES = (
    Case("Covariant 1: 100 bags x 3 x 2-D", "accuracy", covariant),
    Case("500 bags x 5 x 2-D", "log-likelihood", clustered(500, 5, 2)),
    Case("500 bags x 20 x 2-D", "log-likelihood", clustered(500, 20, 2)),
    Case("500 bags x 5 x 3-D", "log-likelihood", clustered(500, 5, 3)),
    Case("500 bags x 5 x 1-D", "log-likelihood", clustered(500, 5, 1)),
    Case("100 bags x 5 x 10-D", "accuracy", clustered(100, 5, 10)),
    Case("100 bags x 5 x 40-D", "accuracy", clustered(100, 5, 40)),
    Case("90 bags x 5 x 166-D, like Musk 1", "accuracy", clustered(90, 5, 166)),
    Case("100 bags x 60 x 166-D, like Musk 2", "accuracy", clustered(100, 60, 166)),
)


def measure(case: Case) -> tuple[Cell, ...]:
    """Time one case with the compiled search and with its twin."""

    def fit(problem: Problem) -> int:
        rng = np.random.default_rng(problem.seed)
        found = aggregate(problem.points, problem.starts, problem.labels, objective=case.objective, rng=rng)
        return 0 if found is None else found.n_models

    def fit_twin(problem: Problem) -> object:
        rng = np.random.default_rng(problem.seed)
        return twin.aggregate(
            problem.points, problem.starts, problem.labels, objective=case.objective, rng=rng
        )

    problems = [case.draw(seed) for seed in range(REPEATS)]
    n_models = float(np.median([fit(problem) for problem in problems]))
    compiled = median_seconds(fit, problems, calls=3)
    plain = median_seconds(fit_twin, problems[:TWIN_REPEATS])
    return case.name, case.objective, n_models, 1e3 * compiled, 1e3 * plain, plain / compiled


def measure_classifier() -> tuple[Cell, ...]:
    """Time `CovAggClassifier` on Covariant 1, with everything around the search: checks, labels, settings."""
    problems = [covariant1(np.random.default_rng(seed)) for seed in range(REPEATS)]
    models = [CovAggClassifier(random_state=seed) for seed in range(REPEATS)]

    def fit(seed: int) -> object:
        return models[seed].fit(problems[seed].bags, problems[seed].labels)

    def predict(seed: int) -> object:
        return models[seed].predict(problems[seed].bags)

    fitting = median_seconds(fit, range(REPEATS), calls=3)
    predicting = median_seconds(predict, range(REPEATS), calls=3)
    return 1e3 * fitting, 1e3 * predicting


def run() -> tuple[Table, Table]:
    """Measure all cases."""
    with one_blas_thread():
        rows = tuple(measure(case) for case in CASES)
        classifier = measure_classifier()
    search = Table(
        "covagg",
        "Aim: at least 80 times faster than the twin on Covariant 1, 30 times on 500 bags x 5 x 2-D.",
        ("case", "objective", "models a fit", "compiled ms", "NumPy twin ms", "times faster"),
        rows,
    )
    around = Table(
        "covagg-classifier",
        "Aim: at most 1.2 ms for a fit.",
        ("case", "fit ms", "predict ms"),
        (("fit and predict of 100 bags as a list", *classifier),),
    )
    return search, around


if __name__ == "__main__":
    for table in run():
        table.report()
