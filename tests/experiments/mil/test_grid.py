from __future__ import annotations

from relforest.experiments.mil.grid import best_point, grid_points
from relforest.experiments.mil.steps import DONE, STOPPED, Step


def test_the_full_grid_is_the_sources() -> None:
    points = grid_points(1)

    # C from 10^-4 to 10^9, factors from 2^-7 to 2^7
    assert len(points) == 14 * 15
    assert {point["C"] for point in points} == {10.0**exponent for exponent in range(-4, 10)}
    assert {point["gamma_factor"] for point in points} == {2.0**exponent for exponent in range(-7, 8)}


def test_a_coarse_grid_goes_through_the_constant_parameters() -> None:
    points = grid_points(2)

    assert points[0] == {"C": 1e4, "gamma_factor": 1.0}
    assert sorted({point["C"] for point in points}) == [1e-4, 1e-2, 1e0, 1e2, 1e4, 1e6, 1e8]
    assert sorted({point["gamma_factor"] for point in points}) == [2.0**power for power in range(-6, 7, 2)]


def test_the_best_point_is_the_first_of_equals() -> None:
    points = grid_points(7)
    scores = [0.1, 0.4, None, 0.4, 0.2, None]
    steps = [
        Step(STOPPED, None, 0) if score is None else Step(DONE, 1.0, 0, {"pss": score}) for score in scores
    ]

    assert best_point(steps, points) == points[1]
    assert best_point([steps[2]] * 6, points) is None
    assert best_point([Step(DONE, 1.0, 0, {"pss": -0.5})], points) == points[0]
