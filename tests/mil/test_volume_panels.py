"""How the volumes of a panel are found and its rules fitted."""

from __future__ import annotations

import numpy as np
import pytest

from relforest.mil.feature_view import FeatureView
from relforest.mil.volume_panels import BALL_RULES, VOLUME_PANELS, find_volumes, volume_rule


@pytest.mark.parametrize("panel", VOLUME_PANELS)
def test_volumes_of_a_panel(panel: str) -> None:
    rng = np.random.default_rng(0)
    positive = np.arange(20) % 2 == 0
    points = rng.standard_normal((20, 5))
    points[positive] += 2.0
    view = FeatureView(np.arange(5), np.zeros(5), np.ones(5))
    bags = (points, np.arange(21), positive, np.ones(20))
    volumes = find_volumes(panel, view, bags, n_volumes=6, part_size=3, rng=rng)

    assert len(volumes) == {"parts": 6, "components": 3, "whole": 1}[panel]
    assert {volume.view.dim for volume in volumes} == {3 if panel == "parts" else 5}
    assert [volume.seeks_positive for volume in volumes] == [
        panel == "whole" or number % 2 == 0 for number in range(len(volumes))
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
    alike = np.ones(40)
    rules = [volume_rule(near, positive, alike, price=1.0)]
    rules += [fit(near, positive, alike) for fit in BALL_RULES.values()]
    for rule in rules:
        assert rule.coefficients[0] - rule.coefficients[1] > 0.5
        assert ((rule.scores(near) > 0) == positive).all()


def test_bags_of_more_weight_are_sampled_more_often() -> None:
    rng = np.random.default_rng(0)
    positive = np.arange(40) % 2 == 0
    # Negative bags 1 to 19 hold a point at -3, the others at 3; each group in turn is nearly without weight.
    points = np.where(positive, 0.0, np.where(np.arange(40) < 20, -3.0, 3.0))[:, None]
    points = points + 0.1 * rng.standard_normal((40, 1))
    view = FeatureView(np.arange(1), np.zeros(1), np.ones(1))
    centres = []
    for weights in (np.where(np.arange(40) < 20, 1.0, 1e-6), np.where(np.arange(40) < 20, 1e-6, 1.0)):
        bags = (points, np.arange(41), positive, weights)
        volumes = find_volumes("parts", view, bags, n_volumes=12, part_size=1, rng=rng)
        centres.append(np.mean([volume.centre[0] for volume in volumes if not volume.seeks_positive]))

    assert centres[0] < centres[1]
