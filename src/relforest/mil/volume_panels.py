"""Panels of a committee of volumes: how their volumes are found and weighted.

A panel is a set of volumes found by one method, with a linear rule that weights the nearness of a bag to each
volume. Letters: b bags, k volumes of a panel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, TypeAlias, cast, final

import numpy as np
from numpy.typing import NDArray

from relforest.mil.covagg import aggregated_volume
from relforest.mil.feature_view import FeatureView
from relforest.mil.logistic_rule import balance, fit_logistic
from relforest.mil.placed_volume import PlacedVolume
from relforest.mil.sparse_machine import train_sparse_machine
from relforest.scenes.bags import rows_of
from relforest.support.progress import report
from relforest.volumes import CovAggSettings, Ellipsoid


@final
@dataclass(frozen=True, slots=True)
class VolumePanel:
    """Settings for aggregating the volumes of a panel.

    Parameters
    ----------
    space : {"parts", "components", "whole"}
        Whether each volume uses a random subset of the features, or all volumes the principal components, or
        all features if there are few, and else the principal components.
    share : float
        Number of volumes relative to the "parts" panel; the others are more expensive.
    least_ratio : float or None
        Smallest ratio of bags to enclose to bags to exclude. With more bags to exclude, each one enclosed
        costs more, and volumes become purer. None: every volume is aggregated from all bags, and encloses
        positive ones, like that of `CovAggClassifier`.
    conditions : tuple of float
        Condition numbers c of eq. 3.6 to choose from.
    restarts : int
        Number N of bags to start from.
    price : float
        Weight of the loss relative to the penalty when the volumes are weighted. With few volumes, more.
    """

    space: Literal["parts", "components", "whole"]
    share: float
    least_ratio: float | None
    conditions: tuple[float, ...]
    restarts: int
    price: float


VOLUME_PANELS: Final[Mapping[str, VolumePanel]] = MappingProxyType(
    {
        "parts": VolumePanel("parts", 1.0, 0.25, (10.0, 1000.0), 2, 1.0),
        "components": VolumePanel("components", 0.5, 1.0, (3.0, 30.0), 2, 1.0),
        "whole": VolumePanel("whole", 4.0 / 30.0, None, (1e5,), 4, 10.0),
    }
)
NEAR_BALLS: Final = "near balls"
BALL_SHARES: Final = "ball shares"
PANELS: Final = (*VOLUME_PANELS, NEAR_BALLS, BALL_SHARES)
# Of a panel that samples, every volume leaves some bags out, so that no two are from the same bags.
_SAMPLED: Final = 0.9


@final
@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """A linear rule on the nearness (b, k) of bags to the volumes of a panel."""

    coefficients: NDArray[np.float64]
    intercept: float

    def scores(self, near: NDArray[np.float64]) -> NDArray[np.float64]:
        """Score of each bag, (b,)."""
        scores: NDArray[np.float64] = near @ self.coefficients + self.intercept
        return scores


# For splits in which every ball is around an instance of a left-out bag.
_NO_RULE: Final = Rule(np.empty(0), 0.0)


def find_volumes(
    panel: str,
    view: FeatureView,
    bags: tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_], NDArray[np.float64]],
    *,
    n_volumes: int,
    part_size: int,
    rng: np.random.Generator,
) -> list[PlacedVolume]:
    """Aggregate the volumes of a panel; if it samples bags, alternately from positive and from negative ones.

    Parameters
    ----------
    panel : str
        A key of `VOLUME_PANELS`.
    view : FeatureView
        Coordinates of the volumes, or of which they use a part.
    bags : (coordinates (n, f), starts (b + 1,), positive (b,), weights (b,))
        The training points in that view.
    n_volumes, part_size : int
        Number of volumes in the "parts" panel, and of features in each of them.
    rng : Generator
        Samples bags and features.

    Returns
    -------
    list of PlacedVolume
        With weights of 0.
    """
    plan = VOLUME_PANELS[panel]
    coordinates, starts, positive, weights = bags
    found = []
    n_wanted = max(1, round(plan.share * n_volumes))
    for number in range(n_wanted):
        report(f"finding volumes of the panel {panel!r}", number, n_wanted)
        seeks_positive = plan.least_ratio is None or number % 2 == 0
        wanted = positive if seeks_positive else ~positive
        sampled = np.arange(len(positive))
        if plan.least_ratio is not None:
            sampled = _sample_bags(wanted, weights, plan.least_ratio, rng)
        features, part = np.arange(view.dim), view
        if plan.space == "parts" and part_size < view.dim:
            features = np.sort(rng.choice(view.dim, part_size, replace=False))
            part = view.part(features)
        settings = CovAggSettings(max_condition=float(rng.choice(plan.conditions)), restarts=plan.restarts)
        rows, sample_starts = rows_of(starts, sampled)
        points = np.ascontiguousarray(coordinates[np.ix_(rows, features)])
        volume = aggregated_volume(points, sample_starts, wanted[sampled], rng=rng, settings=settings)
        found.append(PlacedVolume(panel, part, cast(Ellipsoid, volume), seeks_positive, 0.0))
    return found


def volume_rule(
    near: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64], *, price: float
) -> Rule:
    """Fit logistic regression to the nearness (b, k), with equal weight for both classes."""
    if near.shape[1] == 0:
        return _NO_RULE
    return Rule(*fit_logistic(near, positive, weights, C=price))


def _near_ball_rule(
    near: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64]
) -> Rule:
    """Select a few balls, as MILES does: squared hinge loss with an L1 penalty."""
    if near.shape[1] == 0:
        return _NO_RULE
    # Stopping early acts as regularisation: the panel is judged on other bags.
    machine = train_sparse_machine(
        near, positive, balance(positive, weights), fit_intercept=True, tol=1e-4, max_passes=3000, seed=0
    )
    return Rule(machine.coefficients, machine.intercept)


def _share_rule(
    shares: NDArray[np.float64], positive: NDArray[np.bool_], weights: NDArray[np.float64]
) -> Rule:
    return volume_rule(shares, positive, weights, price=100.0)


# Fits a rule to nearness (b, k), labels (b,) and weights (b,).
_Fit: TypeAlias = Callable[[NDArray[np.float64], NDArray[np.bool_], NDArray[np.float64]], Rule]

BALL_RULES: Final[Mapping[str, _Fit]] = MappingProxyType(
    {NEAR_BALLS: _near_ball_rule, BALL_SHARES: _share_rule}
)


def _sample_bags(
    wanted: NDArray[np.bool_], weights: NDArray[np.float64], least_ratio: float, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Sample bags of both classes, in equal numbers or with fewer wanted ones, by a random ratio."""
    inside, outside = np.flatnonzero(wanted), np.flatnonzero(~wanted)
    ratio = float(np.exp(rng.uniform(np.log(least_ratio), 0.0)))
    n_outside = max(1, int(_SAMPLED * min(len(outside), len(inside) / ratio)))
    n_inside = min(len(inside), max(1, int(ratio * n_outside)))
    chosen = []
    for group, size in ((inside, n_inside), (outside, n_outside)):
        own = weights[group]
        # Equal weights must not change the numbers drawn.
        odds = None if (own == own[0]).all() else own / own.sum()
        chosen.append(rng.choice(group, size, replace=False, p=odds))
    return np.sort(np.concatenate(chosen))
