"""Scaled and rotated coordinates of points."""

from __future__ import annotations

import numpy as np
import pytest

from relforest.mil.feature_view import FeatureView, principal_view, scaled_view


def test_features_are_centred_and_scaled_and_constant_ones_left_out() -> None:
    # Second column: mean 4, deviations -2, 0, 2, standard deviation sqrt(8 / 3).
    view = scaled_view(np.array([[5.0, 2.0], [5.0, 4.0], [5.0, 6.0]]))

    assert view.columns.tolist() == [1]
    assert view.coordinates(np.array([[9.0, 8.0]]))[0] == pytest.approx(4.0 / np.sqrt(8.0 / 3.0))


def test_rounding_is_no_variation() -> None:
    constant = np.full(7, 0.1) * np.array([1, 1, 1, 1, 1, 1, 1 + 1e-15])
    view = scaled_view(np.column_stack([np.arange(7.0), 1e6 * constant]))

    assert view.columns.tolist() == [0]


def test_one_feature_remains_if_none_varies() -> None:
    view = scaled_view(np.full((3, 2), 8.0))

    assert view.columns.tolist() == [0]
    assert view.coordinates(np.full((1, 2), 8.0)).tolist() == [[0.0]]


def test_a_feature_far_from_0_counts_as_one_that_is_not() -> None:
    # Such as seconds since 1970: two thirds of a second are 4e-10 of the values, but no rounding.
    times = 1.7e9 + np.array([0.0, 0.5, 1.0, 1.5])
    view = scaled_view(times[:, None])

    np.testing.assert_allclose(view.coordinates(times[:, None])[:, 0], np.array([-3, -1, 1, 3]) / np.sqrt(5))


def test_a_rotated_view_and_its_inverse() -> None:
    # Scaled by 2 and 4 the point (7, 1) - (5, 5) is (1, -1); along (.6, .8) that is -.2.
    view = FeatureView(np.array([0, 2]), np.array([5.0, 5.0]), np.array([2.0, 4.0]), np.array([[0.6, 0.8]]))

    np.testing.assert_allclose(view.coordinates(np.array([[7.0, 0.0, 1.0]])), [[-0.2]])
    # Back: -.2 (.6, .8) = (-.12, -.16), times (2, 4), plus (5, 5).
    np.testing.assert_allclose(view.original(np.array([[-0.2]])), [[4.76, 4.36]])
    assert view.dim == 1


def test_a_part_sees_some_columns() -> None:
    view = FeatureView(np.array([1, 3, 4]), np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]))
    part = view.part(np.array([0, 2]))

    assert (part.columns.tolist(), part.centre.tolist(), part.scale.tolist()) == ([1, 4], [1, 3], [4, 6])


def test_principal_components_are_directions_of_greatest_variance() -> None:
    rng = np.random.default_rng(0)
    points = rng.standard_normal((3000, 1)) @ np.array([[3.0, 4.0, 0.0]]) + 0.01 * rng.standard_normal(
        (3000, 3)
    )
    plain = FeatureView(np.arange(3), np.zeros(3), np.ones(3))
    view = principal_view(plain, points, 1, rng)

    assert view.rotation is not None
    np.testing.assert_allclose(np.abs(view.rotation), [[0.6, 0.8, 0.0]], atol=0.01)


def test_directions_without_any_variance_are_no_components() -> None:
    points = np.outer(np.arange(5.0), [1.0, 2.0])
    view = principal_view(
        FeatureView(np.arange(2), np.zeros(2), np.ones(2)), points, 9, np.random.default_rng(0)
    )

    assert view.dim == 1
