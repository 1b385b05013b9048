"""Covariant aggregation (Palmer 2015, section 3.2.3, Algorithm 3.1) written plainly with NumPy.

The twin of the compiled search of ``relforest.volumes``: the same random numbers, the same order of
comparisons and the same stopping rule, so that both return the same volume. It is also the peer whose time
the benchmarks divide by, hence vectorised where NumPy can be, and free of special cases for small dimensions.

Letters: n points in d dimensions, b bags, k key points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import xlogy

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]

_NO_DIRECTION = 1e-12
_RISING = 1e-9
_BEYOND_LAST = 1 + 1e-9


@dataclass(frozen=True, slots=True)
class Settings:
    """The constants of the search (Palmer 2015, section 3.3): A, w, c, N and M."""

    window: int = 8
    prior_weight: float = 0.1
    max_condition: float = 1e5
    restarts: int = 4
    sampled: int = 4
    shape: Literal["full", "diagonal"] = "full"


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """Bags to separate: ``points`` (n, d) grouped by bag, ``starts`` (b + 1,), ``labels`` (b,) bool.

    ``prior`` (d, d) is the weighted covariance of all points of positive bags (eq. 3.5), absent on the
    circle.
    """

    points: Floats
    starts: Integers
    labels: Booleans
    objective: Literal["accuracy", "log-likelihood"]
    settings: Settings
    prior: Floats | None


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A volume with all that the search asks of it.

    Attributes
    ----------
    keys : (k, d) key points
    mean : (d,) centre of the key points
    covariance : (d, d) conditioned V of eq. 3.6, all ones on the circle
    squared : (n,) squared distance of every point
    nearest : (b,) squared distance of the witness of every bag
    edge : squared distance of the outermost witness inside
    radius : distance at which the volume ends, between two witnesses
    score : value of the objective
    """

    keys: Floats
    mean: Floats
    covariance: Floats
    squared: Floats
    nearest: Floats
    edge: float
    radius: float
    score: float


def aggregate(
    points: Floats,
    starts: Integers,
    labels: Booleans,
    *,
    space: Literal["euclidean", "circle"] = "euclidean",
    objective: Literal["accuracy", "log-likelihood"] = "accuracy",
    settings: Settings | None = None,
    rng: np.random.Generator,
) -> Model | None:
    """Return the best volume met by all restarts, None if no volume separates anything."""
    settings = settings or Settings()
    points = np.asarray(points, dtype=np.float64)
    starts = np.asarray(starts, dtype=np.int64)
    labels = np.asarray(labels, dtype=np.bool_)
    positives = [int(bag) for bag in np.flatnonzero(labels)]
    prior = None
    if space == "euclidean" and positives:
        in_positive = np.repeat(labels, np.diff(starts))
        prior = settings.prior_weight * np.atleast_2d(np.cov(points[in_positive], rowvar=False, bias=True))
    problem = Problem(points, starts, labels, objective, settings, prior)
    best: Model | None = None
    for restart in range(min(settings.restarts, len(positives))):
        swap = restart + _below(rng, len(positives) - restart)
        positives[restart], positives[swap] = positives[swap], positives[restart]
        best = _grow(problem, positives[restart], best, rng)
    return best


def kappa(model: Model, points: Floats, starts: Integers, labels: Booleans, prior_weight: float) -> float:
    """Return the concentration of the von Mises density around a model on the circle.

    The spread of the keys is shrunk towards that of all points of positive bags, as eq. 3.5 does for the
    covariance; R (2 - R^2) / (1 - R^2) approximates the maximum likelihood estimate.
    """
    n = len(model.keys)
    spread_of_keys = 1 - _resultant_length(model.keys)
    spread_of_all = 1 - _resultant_length(points[np.repeat(labels, np.diff(starts))])
    length = 1 - (n * spread_of_keys + prior_weight * spread_of_all) / (n + prior_weight)
    length = min(length, 1 - 1e-9)
    return length * (2 - length**2) / (1 - length**2)


def conditioned(covariance: Floats, max_condition: float) -> Floats:
    """Return the covariance with a condition number of at most ``max_condition`` (section 3.2.1)."""
    eigenvalues = np.linalg.eigvalsh(covariance)
    smallest, largest = eigenvalues[0], eigenvalues[-1]
    if largest <= 0:
        return np.eye(len(covariance))
    if smallest > 0 and largest <= max_condition * smallest:
        return covariance
    shift = (largest - max_condition * smallest) / (max_condition - 1)
    shifted: Floats = covariance + shift * np.eye(len(covariance))
    return shifted


def _grow(problem: Problem, start_bag: int, best: Model | None, rng: np.random.Generator) -> Model | None:
    """Run one restart from a positive bag and return the better of its best model and ``best``."""
    starts, labels, settings = problem.starts, problem.labels, problem.settings
    first_points = problem.points[starts[start_bag] : starts[start_bag + 1]]
    model = _best_of([_fit(problem, point[np.newaxis]) for point in first_points])
    if model is None:
        return best
    history = [model.score]
    best = _better(model, best)
    remaining = np.flatnonzero(labels)
    remaining = remaining[remaining != start_bag]
    while True:
        inside = remaining[model.nearest[remaining] <= model.edge].tolist()
        if not inside:
            return best
        sample = _draw(inside, settings.sampled, rng)
        extended = [_fit(problem, np.vstack([model.keys, _witness(problem, model, bag)])) for bag in sample]
        step = _best_of(extended)
        if step is None:
            return best
        chosen = sample[extended.index(step)]
        model = step
        remaining = remaining[remaining != chosen]
        history.append(model.score)
        best = _better(model, best)
        if len(history) > settings.window and not _progress(
            np.array(history[-settings.window :]), len(remaining), best.score
        ):
            return best


def _best_of(models: list[Model | None]) -> Model | None:
    """Return the first model of the highest score."""
    admissible = [model for model in models if model is not None]
    return max(admissible, key=lambda model: model.score, default=None)


def _better(model: Model, best: Model | None) -> Model:
    if best is None or (model.score, len(model.keys)) >= (best.score, len(best.keys)):
        return model
    return best


def _below(rng: np.random.Generator, n: int) -> int:
    """Return an integer of [0, n)."""
    return int(rng.random() * n)


def _draw(candidates: list[int], size: int, rng: np.random.Generator) -> list[int]:
    """Draw without replacement (the first steps of a Fisher-Yates shuffle)."""
    size = min(size, len(candidates))
    for i in range(size):
        swap = i + _below(rng, len(candidates) - i)
        candidates[i], candidates[swap] = candidates[swap], candidates[i]
    return candidates[:size]


def _witness(problem: Problem, model: Model, bag: int) -> Floats:
    """Return the point of a bag nearest to the centre of the model, (d,)."""
    first, last = problem.starts[bag], problem.starts[bag + 1]
    witness: Floats = problem.points[first + np.argmin(model.squared[first:last])]
    return witness


def _progress(scores: Floats, steps_left: int, best_score: float) -> bool:
    """Tell whether the line through the last scores rises and would end above the best."""
    middle = (len(scores) - 1) / 2
    steps = np.arange(len(scores)) - middle
    slope = float(steps @ scores / (steps @ steps))
    return slope > _RISING and float(scores.mean()) + slope * (middle + steps_left) > best_score + 1e-9


def _fit(problem: Problem, keys: Floats) -> Model | None:
    """Return the model of the key points at its best radius, None if no radius is admissible."""
    if problem.prior is None:
        if _resultant_length(keys) < _NO_DIRECTION:
            return None
        mean = np.array([np.arctan2(np.sin(keys).sum(), np.cos(keys).sum())])
        covariance = np.ones((1, 1))
        squared = _wrap(problem.points[:, 0] - mean) ** 2
    else:
        mean = keys.mean(axis=0)
        centred = keys - mean
        posterior = centred.T @ centred + problem.prior
        if problem.settings.shape == "diagonal":
            posterior = np.diag(np.diag(posterior))
        covariance = conditioned(posterior, problem.settings.max_condition)
        offsets = problem.points - mean
        squared = np.einsum("ij,ij->i", offsets @ np.linalg.inv(covariance), offsets)
    nearest = np.minimum.reduceat(squared, problem.starts[:-1])
    order = np.argsort(nearest)
    distances = nearest[order]
    scores = _scores(problem.labels[order], problem.objective)
    scores[:-1][distances[:-1] == distances[1:]] = -np.inf
    cut = int(np.argmax(scores))
    if scores[cut] == -np.inf:
        return None
    edge = float(distances[cut])
    if cut + 1 < len(distances):
        radius = (np.sqrt(edge) + np.sqrt(distances[cut + 1])) / 2
    else:
        radius = np.sqrt(edge) * _BEYOND_LAST
    return Model(keys, mean, covariance, squared, nearest, edge, float(radius), float(scores[cut]))


def _scores(labels: Booleans, objective: Literal["accuracy", "log-likelihood"]) -> Floats:
    """Return the objective for a volume that ends behind each bag of the sorted ones, (b,)."""
    inside = np.arange(1, len(labels) + 1)
    positive_in = np.cumsum(labels, dtype=np.int64)
    negative_in = inside - positive_in
    positive_out = positive_in[-1] - positive_in
    negative_out = negative_in[-1] - negative_in
    if objective == "accuracy":
        correct: Floats = (positive_in + negative_out).astype(np.float64)
        return correct
    outside = positive_out + negative_out
    scores = _log_likelihood(positive_in, negative_in) + _log_likelihood(positive_out, negative_out)
    admissible = (outside > 0) & (positive_in * outside > positive_out * inside)
    result: Floats = np.where(admissible, scores, -np.inf)
    return result


def _log_likelihood(positive: Integers, negative: Integers) -> Floats:
    """Return the log-likelihood of the labels in a leaf that predicts their own frequency."""
    total = positive + negative
    value = xlogy(positive, positive) + xlogy(negative, negative) - xlogy(total, total)
    return np.asarray(value, dtype=np.float64)


def _resultant_length(angles: Floats) -> float:
    return float(np.hypot(np.sin(angles).mean(), np.cos(angles).mean()))


def _wrap(angles: Floats) -> Floats:
    return (angles + np.pi) % (2 * np.pi) - np.pi
