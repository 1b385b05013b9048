"""The width of the kernel: by hand, for many points, and where there is none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.distance import pdist

from relforest.mil.baselines.kernel_width import MOST_POINTS, heuristic_gamma, kernel_gamma
from relforest.support.errors import InputError

LINE = np.array([[0.0], [1.0], [3.0]])


def test_the_heuristic_by_hand() -> None:
    # Distances 1, 2, 3: percentiles 10 and 90 are 1.2 and 2.8, s is 2, and 1 / (2 s^2) is 1/8.
    assert heuristic_gamma(LINE) == pytest.approx(0.125, rel=1e-12)
    assert kernel_gamma(LINE, "heuristic", 4.0) == pytest.approx(0.5, rel=1e-12)
    assert kernel_gamma(LINE, 3.0, 0.5) == 1.5


def test_all_distances_count() -> None:
    points = np.random.default_rng(0).normal(size=(200, 3))
    low, high = np.percentile(pdist(points), [10, 90])

    assert heuristic_gamma(points) == pytest.approx(2 / (low + high) ** 2, rel=1e-12)


@given(st.integers(-1000, 1000), st.integers(0, 5))
def test_it_depends_on_neither_place_nor_order(shift: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(20, 2))
    moved = rng.permutation(points) + shift

    assert heuristic_gamma(moved) == pytest.approx(heuristic_gamma(points), rel=1e-9)


@given(st.floats(0.01, 100))
def test_it_scales_with_the_inverse_square_of_the_units(unit: float) -> None:
    assert heuristic_gamma(LINE * unit) == pytest.approx(0.125 / unit**2, rel=1e-9)


def test_many_points_are_thinned_out_whatever_their_order() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(size=(MOST_POINTS + 1000, 2))
    low, high = np.percentile(pdist(points), [10, 90])
    gamma = heuristic_gamma(points)

    assert gamma == pytest.approx(2 / (low + high) ** 2, rel=0.03)
    assert gamma != pytest.approx(2 / (low + high) ** 2, rel=1e-9)
    assert heuristic_gamma(rng.permutation(points)) == gamma


def test_where_most_points_coincide_the_mean_distance_is_the_width() -> None:
    # 9 points at 0 and one at 10: of 45 distances, 9 are 10; the 90th percentile is 10 and s is 5.
    most = np.zeros((10, 1))
    most[0] = 10.0
    assert heuristic_gamma(most) == pytest.approx(1 / 50)
    # 29 points at 0: of 435 distances, 29 are 10, fewer than a tenth; their mean is 2/3.
    most = np.zeros((30, 1))
    most[0] = 10.0
    assert heuristic_gamma(most) == pytest.approx(1 / (2 * (2 / 3) ** 2))


def test_where_all_points_coincide_gamma_is_the_factor() -> None:
    assert heuristic_gamma(np.full((4, 2), 7.0)) == 1.0
    assert kernel_gamma(np.full((4, 2), 7.0), "heuristic", 0.25) == 0.25


@pytest.mark.parametrize(
    ("points", "gamma", "factor", "message"),
    [
        (LINE, "scale", 1.0, "gamma must be 'heuristic' or a finite number above 0, got 'scale'"),
        (LINE, 0.0, 1.0, "gamma must be a finite number above 0, got 0.0"),
        (LINE, np.inf, 1.0, "gamma must be a finite number above 0, got inf"),
        (LINE, None, 1.0, "gamma must be a finite number above 0, got None"),
        (LINE, "heuristic", -1.0, "gamma_factor must be a finite number above 0, got -1.0"),
        (
            LINE * 1e-160,
            "heuristic",
            1.0,
            "is too large or too small for a floating point number: scale the features",
        ),
        (LINE, 1e-300, 1e-300, "gamma 1e-300 times gamma_factor 1e-300 is too large or too small"),
    ],
)
def test_values_without_sense_are_refused(
    points: NDArray[np.float64], gamma: Any, factor: Any, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        kernel_gamma(points, gamma, factor)
