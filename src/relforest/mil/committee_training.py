"""Training a committee of volumes on one split of the bags.

Letters: n points, d features, b bags, t bags left out, m balls, k volumes, f coordinates of a view.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, final

import numpy as np
from numpy.random import RandomState as LegacyGenerator
from numpy.typing import NDArray

from relforest.mil.feature_view import FeatureView
from relforest.mil.placed_volume import PlacedVolume, bag_nearness
from relforest.mil.volume_panels import BALL_RULES, PANELS, Rule, find_volumes, rows_of, volume_rule
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


def split_bags(
    positive: NDArray[np.bool_], n_splits: int, rng: np.random.Generator
) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Return training and left-out bags of each split; if splitting is impossible, all bags are both."""
    n_splits = min(n_splits, int(positive.sum()), int((~positive).sum()))
    if n_splits < 2:
        return [(np.arange(len(positive)),) * 2]
    # The folds of scikit-learn's `StratifiedKFold`, which would change warning filters for all threads.
    shuffler = LegacyGenerator(int(rng.integers(2**31)))
    fold = np.empty(len(positive), dtype=np.int64)
    n_dealt = 0
    for is_member in (positive == positive[0], positive != positive[0]):
        n_members = int(np.count_nonzero(is_member))
        dealt = np.sort(np.arange(n_dealt, n_dealt + n_members) % n_splits)
        shuffler.shuffle(dealt)
        fold[is_member] = dealt
        n_dealt += n_members
    return [(np.flatnonzero(fold != number), np.flatnonzero(fold == number)) for number in range(n_splits)]


def find_split_volumes(
    training: Training, panels: tuple[str, ...], train: NDArray[np.int64], seed: np.random.SeedSequence
) -> dict[str, FoundVolumes]:
    """Aggregate the volumes of each volume panel from the bags `train`."""
    positive = training.positive[train]
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
            (coordinates[rows], starts, positive),
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
    positive = training.positive[train]
    members = []
    for name in panels:
        balls = np.empty(0, dtype=np.int64)
        volumes: list[PlacedVolume] = []
        if name in found:
            volumes, near = found[name]
            rule = volume_rule(near[train], positive)
        else:
            balls = np.flatnonzero(np.isin(training.ball_bags, train))
            near = training.ball_features[name][:, balls]
            rule = BALL_RULES[name](near[train], positive)
        members.append(PanelMember(volumes, balls, rule, rule.scores(near[test])))
    return members
