"""Training a committee of volumes on one split of the bags.

Letters: n points, d features, b bags, t bags left out, m balls, k volumes, f coordinates of a view.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.mil.feature_view import FeatureView
from relforest.mil.placed_volume import PlacedVolume, bag_nearness
from relforest.mil.volume_panels import BALL_RULES, PANELS, VOLUME_PANELS, Rule, find_volumes, volume_rule
from relforest.scenes.bags import rows_of
from relforest.support.rng import generator, stream

# Volumes of a panel, and the nearness (b, k) of all bags to them.
FoundVolumes: TypeAlias = tuple[list[PlacedVolume], NDArray[np.float64]]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Training:
    """Data shared by all splits."""

    shown: dict[str, tuple[FeatureView, NDArray[np.float64]]]  # volume panel -> its view, points (n, f) in it
    points: NDArray[np.float64]  # (n, d)
    starts: NDArray[np.int64]  # (b + 1,)
    positive: NDArray[np.bool_]  # (b,)
    weights: NDArray[np.float64]  # (b,)
    ball_bags: NDArray[np.int64]  # (m,) bag of the instance at the centre of each ball
    ball_features: dict[str, NDArray[np.float64]]  # (b, m) for each of `BALL_RULES`
    n_volumes: int
    part_size: int


@final
@dataclass(frozen=True, slots=True, eq=False)
class PanelMember:
    """What a panel learned in one split, and its scores of the left-out bags."""

    volumes: list[PlacedVolume]
    balls: NDArray[np.int64]  # indices of the balls in use
    rule: Rule
    scores: NDArray[np.float64]  # (t,)


def find_split_volumes(
    training: Training, panels: tuple[str, ...], train: NDArray[np.int64], seed: np.random.SeedSequence
) -> dict[str, FoundVolumes]:
    """Aggregate the volumes of each volume panel from the bags `train`."""
    positive, weights = training.positive[train], training.weights[train]
    rows, starts = rows_of(training.starts, train)
    found = {}
    for name in panels:
        if name not in training.shown:
            continue
        view, coordinates = training.shown[name]
        # The stream's key is fixed for each panel, so leaving one panel out does not change the others.
        rng = generator(stream(seed, PANELS.index(name)))
        volumes = find_volumes(
            name,
            view,
            (coordinates[rows], starts, positive, weights),
            n_volumes=training.n_volumes,
            part_size=training.part_size,
            rng=rng,
        )
        found[name] = volumes, bag_nearness(volumes, training.points, training.starts)
    return found


def train_panels(
    training: Training,
    panels: tuple[str, ...],
    found: dict[str, FoundVolumes],
    train: NDArray[np.int64],
    test: NDArray[np.int64],
) -> list[PanelMember]:
    """Learn the rule of every panel from the bags `train`, and score the bags `test`."""
    positive, weights = training.positive[train], training.weights[train]
    members = []
    for name in panels:
        balls = np.empty(0, dtype=np.int64)
        volumes: list[PlacedVolume] = []
        if name in found:
            volumes, near = found[name]
            rule = volume_rule(near[train], positive, weights, price=VOLUME_PANELS[name].price)
        else:
            balls = np.flatnonzero(np.isin(training.ball_bags, train))
            near = training.ball_features[name][:, balls]
            rule = BALL_RULES[name](near[train], positive, weights)
        members.append(PanelMember(volumes, balls, rule, rule.scores(near[test])))
    return members
