"""Covariant aggregation: one ellipsoid (or arc) learned from labelled bags (Algorithm 3.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, NamedTuple, final

import numpy as np

from relforest.support.errors import InputError
from relforest.support.jit import kernel
from relforest.support.notebook import drawn
from relforest.support.options import one_of
from relforest.volumes.aggregation import Found, Problem, aggregate_keys
from relforest.volumes.arc import Arc
from relforest.volumes.bag_layout import NO_EVIDENCE, Instances
from relforest.volumes.categories import best_category, category_volume
from relforest.volumes.conditioning import condition
from relforest.volumes.diverse_density import diverse_density_keys
from relforest.volumes.ellipsoid import Ellipsoid
from relforest.volumes.models import FEW_DIMENSIONS
from relforest.volumes.objectives import OBJECTIVES, WEIGHTED, Objective, entropy_table
from relforest.volumes.principal_axes import PrincipalAxes, principal_axes
from relforest.volumes.settings import CovAggSettings
from relforest.volumes.slab import Slab
from relforest.volumes.witnesses import CIRCLE, DIAGONAL, EUCLIDEAN

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.volumes.volume import Volume


# Within this bound no product in the search overflows or vanishes.
_LARGEST_VALUE: Final = 1e30
_DEFAULT: Final = CovAggSettings()


@final
@dataclass(frozen=True, slots=True, eq=False)
class Aggregation:
    """The result of covariant aggregation.

    Parameters
    ----------
    volume : Ellipsoid, Arc or Slab
        The best decision volume over all steps and restarts.
    score : float
        Its objective on the training bags: the number of correctly labelled bags, or log L.
    n_models : int
        Number of volumes tried.
    """

    volume: Volume
    score: float
    n_models: int

    _repr_html_ = drawn


def aggregate(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    labels: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
    space: Literal["euclidean", "circle", "category"] = "euclidean",
    objective: Objective = "accuracy",
    evidence: NDArray[np.float64] | None = None,
    settings: CovAggSettings = _DEFAULT,
) -> Aggregation | None:
    """Learn the decision volume that best separates positive from negative bags.

    Parameters
    ----------
    points : (n_points, d) float64
        Instances, grouped by bag; angles (n_points, 1) in radians if `space` is "circle"; numbers of
        categories (n_points, 1) if it is "category": then every category is tried.
    starts : (n_bags + 1,) int64
        Bag i holds ``points[starts[i]:starts[i + 1]]``; no bag is empty.
    labels : (n_bags,) bool
        True for positive bags.
    rng : Generator
        Random source for sampling bags.
    space, objective, settings
        The space of the points, the objective that scores a volume, and the parameters.
    evidence : (n_bags, 2) float64, optional
        What each bag weighs as a negative and as a positive one ("weighted-log-likelihood"), or its weight,
        and its weight times its value ("squared-error"). Required by these two, unused by the others. Bags
        labelled positive are those that a volume is built from.

    Returns
    -------
    Aggregation or None
        None if no volume separates anything: without positive bags, or, for the log-likelihood, if no
        volume makes its Yes leaf more probable than its No leaf.

    Raises
    ------
    InputError
        If the shapes do not match, a bag is empty, a value is not finite or beyond 1e30, or
        `space` or `objective` is unknown.

    Notes
    -----
    Where the source is silent: start bags are drawn without replacement; the smallest of equally
    good radii is taken, midway between two witnesses; aggregation ends when no witness of an
    unrepresented bag lies inside; the trend is extrapolated from its fitted end.

    References
    ----------
    Palmer (2015), Algorithm 3.1, section 3.2, eq. 3.4-3.7; section 4.2 for the likelihood objective.
    """
    circular = one_of("space", space, ("euclidean", "circle", "category")) == "circle"
    one_of("objective", objective, tuple(OBJECTIVES))
    _check(points, starts, labels, circular=circular)
    _check_evidence(evidence, len(labels), objective)
    if space == "category":
        category, score, n_tried = best_category(points, starts, (labels, evidence), objective)
        return None if score == -np.inf else Aggregation(category_volume(category), score, n_tried)
    searched = _search(points, starts, (labels, evidence), rng, circular, objective, settings)
    if searched is None or searched.score == -np.inf:
        return None
    if circular:
        volume: Volume = _arc(searched.found, _of_positives(points, starts, labels), settings)
    else:
        ellipsoid = _ellipsoid(searched, settings)
        dim = points.shape[1]
        volume = ellipsoid if searched.axis is None else Slab(ellipsoid, searched.axis, dim)
    return Aggregation(volume, searched.score, searched.n_models)


def _arc(found: Found, angles: NDArray[np.float64], settings: CovAggSettings) -> Arc:
    """Return the arc found; `angles` (n, 1) are those of positive bags."""
    kappa = _concentration(found.total / found.n_keys, angles, found.n_keys, settings.prior_weight)
    return Arc(float(found.centre[0]), found.radius, kappa)


def _ellipsoid(searched: _Searched, settings: CovAggSettings) -> Ellipsoid:
    found = searched.found
    mean, covariance = found.centre, found.scatter + searched.prior
    condition(covariance, settings.max_condition)
    if searched.turned is not None:
        mean, covariance = searched.turned.back(mean, covariance)
    return Ellipsoid(mean, covariance, found.radius, found.n_keys, float(settings.prior_weight))


def best_score(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    labels: NDArray[np.bool_],
    *,
    rng: np.random.Generator,
    space: Literal["euclidean", "circle", "category"],
    objective: Objective,
    evidence: NDArray[np.float64] | None,
    settings: CovAggSettings,
) -> float:
    """Return the score that `aggregate` would reach, minus infinity for None, without checks or a volume."""
    if space == "category":
        return best_category(points, starts, (labels, evidence), objective)[1]
    circular = space == "circle"
    searched = _search(points, starts, (labels, evidence), rng, circular, objective, settings)
    return -np.inf if searched is None else searched.score


class _Searched(NamedTuple):
    """What the compiled part found."""

    found: Found
    prior: NDArray[np.float64]
    turned: PrincipalAxes | None
    n_models: int
    axis: int | None = None  # the only coordinate that the search has seen

    @property
    def score(self) -> float:
        return self.found.score


def _search(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    known: tuple[NDArray[np.bool_], NDArray[np.float64] | None],
    rng: np.random.Generator,
    circular: bool,  # noqa: FBT001
    objective: Objective,
    settings: CovAggSettings,
) -> _Searched | None:
    """Run the compiled loop on bags with these labels and evidence; None without positive bags."""
    labels, evidence = known
    n_positive, dim = int(np.count_nonzero(labels)), points.shape[1]
    if n_positive == 0:
        return None
    if settings.shape == "axis" and dim > 1:
        columns = [np.ascontiguousarray(points[:, axis : axis + 1]) for axis in range(dim)]
        each = [_search(column, starts, known, rng, circular, objective, settings) for column in columns]
        found = [one._replace(axis=axis) for axis, one in enumerate(each) if one is not None]
        # The first of equals.
        best = max(found, key=lambda one: one.score)
        return best._replace(n_models=sum(one.n_models for one in found))
    is_diagonal = settings.shape == "diagonal" and dim > 1
    turned = None
    if circular:  # which has no covariance
        prior = np.zeros((1, 1))
    elif is_diagonal:
        prior = np.diag(settings.prior_weight * _of_positives(points, starts, labels).var(axis=0))
    elif dim > FEW_DIMENSIONS:  # a rotation would make other matrices diagonal
        turned = principal_axes(points, _of_positives(points, starts, labels))
        points, prior = turned.coordinates, np.diag(settings.prior_weight * turned.variances)
    else:
        prior = prior_of(points, starts, labels, settings.prior_weight)
    code = CIRCLE if circular else DIAGONAL if is_diagonal else EUCLIDEAN
    plan = (settings.window, settings.restarts, settings.sampled)
    table = entropy_table(len(labels))
    problem = Problem(code, OBJECTIVES[objective], prior, float(settings.max_condition), table, plan)
    most_sampled = min(settings.sampled, n_positive)
    draws = rng.random(min(settings.restarts, n_positive) * (1 + most_sampled * n_positive))
    instances = Instances(points, starts, labels, NO_EVIDENCE if evidence is None else evidence)
    if settings.learner == "covagg":
        found_keys = aggregate_keys(instances, problem, draws)
    else:
        sharpness = settings.prior_weight
        if circular:
            angles = _of_positives(points, starts, labels)
            sharpness = 0.5 / max(_circular_variance(angles), 1e-12)
        found_keys = diverse_density_keys(instances, problem, sharpness, draws)
    return _Searched(found_keys, prior, turned, found_keys.n_models)


def _check(
    points: NDArray[np.float64], starts: NDArray[np.int64], labels: NDArray[np.bool_], *, circular: bool
) -> None:
    if points.ndim != 2 or points.shape[1] == 0 or len(starts) != len(labels) + 1 or len(labels) == 0:
        raise InputError(
            f"points {points.shape}, starts {starts.shape} and labels {labels.shape} do not match: "
            "pass (n_points, d), (n_bags + 1,) and (n_bags,)"
        )
    if starts[0] != 0 or starts[-1] != len(points) or (np.diff(starts) <= 0).any():
        raise InputError(
            "starts must rise from 0 to the number of points, with no empty bag: drop empty bags first"
        )
    if circular and points.shape[1] != 1:
        raise InputError(f"points on the circle are angles, one column, got {points.shape[1]} columns")
    # The negated test also catches NaN.
    if not (np.abs(points) <= _LARGEST_VALUE).all():
        raise InputError(
            f"points contain NaN, infinite values or values beyond {_LARGEST_VALUE:g}: "
            "drop those instances first, or use other units"
        )


def _check_evidence(evidence: NDArray[np.float64] | None, n_bags: int, objective: Objective) -> None:
    if (evidence is not None) != (OBJECTIVES[objective] >= WEIGHTED):
        raise InputError(f"objective {objective!r} {'needs' if evidence is None else 'takes no'} evidence")
    if evidence is not None and not (evidence.shape == (n_bags, 2) and np.isfinite(evidence).all()):
        raise InputError(
            f"evidence must be two finite numbers for each of {n_bags} bags, got {evidence.shape}"
        )


@kernel
def prior_of(
    points: NDArray[np.float64], starts: NDArray[np.int64], labels: NDArray[np.bool_], weight: float
) -> NDArray[np.float64]:
    """``w ncov(P) / p`` of eq. 3.5, where P are the points of positive bags."""
    chosen = _of_positives(points, starts, labels)
    n, dim = chosen.shape
    mean, prior = np.zeros(dim), np.zeros((dim, dim))
    for row in range(n):
        for i in range(dim):
            mean[i] += chosen[row, i]
    mean /= n
    for row in range(n):
        for i in range(dim):
            for j in range(i + 1):
                prior[i, j] += (chosen[row, i] - mean[i]) * (chosen[row, j] - mean[j])
    for i in range(dim):
        for j in range(i + 1):
            prior[i, j] = weight * (prior[i, j] / n)
            prior[j, i] = prior[i, j]
    return prior


@kernel
def _of_positives(
    points: NDArray[np.float64], starts: NDArray[np.int64], labels: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return the points of positive bags."""
    n = 0
    for bag in range(len(labels)):
        n += starts[bag + 1] - starts[bag] if labels[bag] else 0
    chosen = np.empty((n, points.shape[1]))
    n = 0
    for bag in range(len(labels)):
        if labels[bag]:
            for place in range(starts[bag], starts[bag + 1]):
                for i in range(points.shape[1]):
                    chosen[n, i] = points[place, i]
                n += 1
    return chosen


def _concentration(
    key_mean: NDArray[np.float64], angles: NDArray[np.float64], n_keys: int, prior_weight: float
) -> float:
    """Kappa of the von Mises density, with a prior that plays the part of w in eq. 3.5.

    The circular variance of the keys is averaged with that of all positive points, and kappa follows
    from the mean resultant length by the usual approximation (Mardia, 1975).
    """
    spread_keys = 1.0 - float(np.hypot(*key_mean))
    spread_all = _circular_variance(angles)
    spread = (n_keys * spread_keys + prior_weight * spread_all) / (n_keys + prior_weight)
    length = min(max(1.0 - spread, 0.0), 1.0 - 1e-9)
    return length * (2.0 - length**2) / (1.0 - length**2)


def _circular_variance(angles: NDArray[np.float64]) -> float:
    """One less the mean resultant length; half of the variance where angles are close."""
    return 1.0 - float(np.hypot(np.cos(angles).mean(), np.sin(angles).mean()))
