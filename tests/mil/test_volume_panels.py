"""How the volumes of a panel are found and its rules fitted."""

from __future__ import annotations

import numpy as np
import pytest

from relforest.mil.feature_view import FeatureView
from relforest.mil.volume_panels import BALL_RULES, VOLUME_PANELS, find_volumes, rows_of, volume_rule

STARTS = np.array([0, 2, 3, 6])


def test_rows_of_chosen_bags() -> None:
    rows, starts = rows_of(STARTS, np.array([0, 2]))

    assert rows.tolist() == [0, 1, 3, 4, 5]
    assert starts.tolist() == [0, 2, 5]


@pytest.mark.parametrize("panel", VOLUME_PANELS)
def test_volumes_of_a_panel(panel: str) -> None:
    rng = np.random.default_rng(0)
    positive = np.arange(20) % 2 == 0
    points = rng.standard_normal((20, 5))
    points[positive] += 2.0
    view = FeatureView(np.arange(5), np.zeros(5), np.ones(5))
    volumes = find_volumes(panel, view, (points, np.arange(21), positive), n_volumes=6, part_size=3, rng=rng)
    space = VOLUME_PANELS[panel].space

    assert len(volumes) == (3 if space == "components" else 6)
    assert {volume.view.dim for volume in volumes} == {5 if space == "components" else 3}
    assert [volume.seeks_positive for volume in volumes] == [
        number % 2 == 0 for number in range(len(volumes))
    ]
    for volume in volumes:
        near = volume.nearness_at(volume.view.coordinates(points))
        inside = near[positive] if volume.seeks_positive else near[~positive]
        outside = near[~positive] if volume.seeks_positive else near[positive]
        assert inside.mean() > outside.mean()


def test_a_rule_likes_the_volume_that_positive_bags_are_near() -> None:
    positive = np.arange(40) % 4 == 0
    rng = np.random.default_rng(0)
    near = np.column_stack([0.8 * positive, 0.8 * ~positive, np.zeros(40)]) + 0.1 * rng.random((40, 3))
    for fit in (volume_rule, *BALL_RULES.values()):
        rule = fit(near, positive)

        assert rule.coefficients[0] - rule.coefficients[1] > 0.5
        assert ((rule.scores(near) > 0) == positive).all()
