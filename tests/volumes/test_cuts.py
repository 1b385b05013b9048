"""The best cut without sorting against a scan over the sorted witnesses."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.volumes.cuts import best_cut, best_weighted_cut, new_buckets, radius_at
from relforest.volumes.objectives import (
    ACCURACY,
    LOG_LIKELIHOOD,
    SQUARED_ERROR,
    WEIGHTED,
    entropy_table,
    score_sums,
)

Floats = NDArray[np.float64]
Booleans = NDArray[np.bool_]

N_TRIALS = 300 if os.environ.get("NUMBA_DISABLE_JIT") == "1" else 1500


def scanned(squared: Floats, labels: Booleans, objective: int, floor: float) -> tuple[float, float]:
    """Score of the cut behind every distinct distance, in rising order; the first best one."""

    def entropy(count: int) -> float:
        return count * math.log(count) if count else 0.0

    best, edge = -math.inf, -math.inf
    for distance in np.unique(squared):
        inside = squared <= distance
        p_in, n_in = int(labels[inside].sum()), int((~labels[inside]).sum())
        p_out, n_out = int(labels[~inside].sum()), int((~labels[~inside]).sum())
        if objective == ACCURACY:
            score = float(p_in + n_out)
        elif (p_out + n_out) * p_in > (p_in + n_in) * p_out:
            yes = entropy(p_in) + entropy(n_in) - entropy(p_in + n_in)
            score = yes + (entropy(p_out) + entropy(n_out) - entropy(p_out + n_out))
        else:
            continue
        # The table's logarithms may differ in the last digit.
        if score > best + 1e-9:
            best, edge = score, float(distance)
    return (best, edge) if best > floor else (-math.inf, -math.inf)


def found(
    squared: Floats, labels: Booleans, objective: int, *, scale: float = 1.0, floor: float = -math.inf
) -> tuple[float, float]:
    weights = np.where(labels, 2**32, 1)
    table = entropy_table(len(labels))
    return best_cut(squared, weights, (objective, table), scale, floor, new_buckets(len(labels)))


DISTANCES: dict[str, Callable[[np.random.Generator, int], NDArray[Any]]] = {
    "squared normal": lambda rng, n: rng.chisquare(2, size=n),
    "ties": lambda rng, n: rng.integers(0, 5, size=n).astype(np.float64),
    "close ties": lambda rng, n: 7.0 + 1e-15 * rng.integers(0, 4, size=n),
    "many decades": lambda rng, n: 10.0 ** rng.uniform(-250, 250, size=n),
    "all in the first bucket": lambda rng, n: np.append(1e-9 * rng.random(n - 1), 1e9),
    "some zero": lambda rng, n: rng.random(n) * (rng.random(n) < 0.5),
}


def labelled(rng: np.random.Generator, squared: Floats) -> Booleans:
    """Labels at random, or such that near witnesses tend to be positive, so that cuts are good."""
    if rng.random() < 0.5:
        return rng.random(len(squared)) < rng.random()
    return squared + rng.normal(scale=np.median(squared) + 1e-300, size=len(squared)) < np.median(squared)


@pytest.mark.parametrize("objective", [ACCURACY, LOG_LIKELIHOOD], ids=["accuracy", "log-likelihood"])
@pytest.mark.parametrize("name", DISTANCES)
def test_random_witnesses(name: str, objective: int) -> None:
    rng = np.random.default_rng([len(name), objective])
    for _ in range(N_TRIALS // 6):
        n = int(rng.choice([2, 3, 5, 20, 70]))
        squared = DISTANCES[name](rng, n)
        labels = labelled(rng, squared)
        # The scale must affect nothing but speed, so it may be far off.
        scale = float(np.median(squared) + 1e-300) * 10.0 ** rng.uniform(-3, 3)
        score, edge = found(squared, labels, objective, scale=scale)
        expected_score, expected_edge = scanned(squared, labels, objective, -math.inf)
        assert score == pytest.approx(expected_score, abs=1e-9)
        assert edge == expected_edge


@pytest.mark.parametrize("objective", [ACCURACY, LOG_LIKELIHOOD], ids=["accuracy", "log-likelihood"])
def test_a_floor_hides_only_what_does_not_exceed_it(objective: int) -> None:
    rng = np.random.default_rng(objective)
    for _ in range(N_TRIALS // 6):
        squared = rng.integers(0, 12, size=15).astype(np.float64)
        labels = rng.random(15) < 0.5
        score, edge = found(squared, labels, objective)
        if score == -math.inf:
            continue
        scale = float(rng.uniform(0.1, 10))
        assert found(squared, labels, objective, scale=scale, floor=score - 1e-6) == (score, edge)
        for floor in (score, score + 1e-6, math.inf):
            assert found(squared, labels, objective, scale=scale, floor=floor) == (-math.inf, -math.inf)


def test_more_bags_than_first_buckets() -> None:
    # 32 buckets grow with the number of bags; several bags share each of them.
    rng = np.random.default_rng(0)
    squared = rng.chisquare(2, size=2000)
    labels = rng.random(2000) < np.exp(-squared)
    for objective in (ACCURACY, LOG_LIKELIHOOD):
        score, edge = found(squared, labels, objective)
        assert (score, edge) == pytest.approx(scanned(squared, labels, objective, -math.inf))


def test_equal_distances_cannot_be_separated() -> None:
    # P at 0, P and N at 1, N at 4. Behind 0: 1 + 2 correct. Behind 1: 2 + 1. The smaller one wins.
    squared, labels = np.array([0.0, 1.0, 1.0, 4.0]), np.array([True, True, False, False])

    assert found(squared, labels, ACCURACY) == (3, 0)


def test_nothing_inside_is_no_cut() -> None:
    # The nearest witness is negative; the best cut leaves as little inside as possible.
    squared, labels = np.array([1.0, 2.0, 3.0]), np.array([False, False, False])

    assert found(squared, labels, ACCURACY) == (2, 1)
    assert found(squared, labels, LOG_LIKELIHOOD) == (-math.inf, -math.inf)


def test_one_class_has_no_likelihood_to_gain() -> None:
    squared, labels = np.array([1.0, 2.0, 3.0]), np.array([True, True, True])

    assert found(squared, labels, ACCURACY) == (3, 3)
    assert found(squared, labels, LOG_LIKELIHOOD) == (-math.inf, -math.inf)


def test_a_single_bag() -> None:
    assert found(np.array([0.0]), np.array([True]), ACCURACY) == (1, 0)
    assert found(np.array([0.0]), np.array([False]), ACCURACY) == (0, 0)


def test_the_radius_lies_midway_to_the_next_witness() -> None:
    squared = np.array([16.0, 1.0, 4.0, 4.0])

    # sqrt: 4, 1, 2, 2.
    assert radius_at(1.0, squared) == 1.5
    assert radius_at(4.0, squared) == 3
    # Nothing beyond: a hair more than the last distance.
    assert radius_at(16.0, squared) == pytest.approx(4, rel=2e-9)
    assert radius_at(16.0, squared) > 4


@pytest.mark.parametrize("objective", [WEIGHTED, SQUARED_ERROR])
@pytest.mark.parametrize("seed", range(5))
def test_the_best_weighted_cut_is_the_best_of_all(objective: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    squared = rng.integers(0, 8, size=12).astype(np.float64)
    evidence = rng.uniform(0.1, 1, size=(2, 12))
    if objective == SQUARED_ERROR:
        evidence[1] *= rng.normal(size=12)
    totals = (evidence[0].sum(), evidence[1].sum())
    scores = {}
    for edge in np.unique(squared):
        inside = evidence[:, squared <= edge].sum(axis=1)
        scores[edge] = score_sums(objective, (inside[0], inside[1]), totals)
    expected = max(list(scores)[:-1], key=lambda edge: scores[edge])

    found, edge = best_weighted_cut(squared, evidence, objective, -np.inf)
    if scores[expected] == -np.inf:
        assert (found, edge) == (-np.inf, -np.inf)
    else:
        assert found == pytest.approx(scores[expected])
        assert edge == expected
        assert best_weighted_cut(squared, evidence, objective, found + 1e-6) == (-np.inf, -np.inf)
