from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from relforest.support.errors import InputError, ModelFormatError
from relforest.volumes import Ellipsoid, volume_from_dict
from strategies import coordinates


def ellipsoid(*, radius: float = 1.0, n_keys: int = 3, prior_weight: float = 0.5) -> Ellipsoid:
    """Semi-axes 2 along x and 1 along y, times the radius, around (1, 2)."""
    return Ellipsoid(np.array([1.0, 2.0]), np.diag([4.0, 1.0]), radius, n_keys, prior_weight)


@st.composite
def ellipsoids(draw: st.DrawFn) -> Ellipsoid:
    dim = draw(st.integers(1, 4))
    root = draw(hnp.arrays(np.float64, (dim, dim), elements=coordinates(-10, 10)))
    mean = draw(hnp.arrays(np.float64, dim, elements=coordinates()))
    radius, prior_weight = draw(coordinates(0, 100)), draw(coordinates(0, 10))
    return Ellipsoid(mean, root @ root.T + np.eye(dim), radius, draw(st.integers(1, 50)), prior_weight)


def test_distance_by_hand() -> None:
    # (5 - 1)^2 / 4 = 4; (5 - 2)^2 / 1 = 9; sqrt(4 + 9).
    points = [[1, 2], [3, 2], [1, 3], [5, 5]]

    assert ellipsoid().distance(points).tolist() == pytest.approx([0, 1, 1, math.sqrt(13)])


def test_distance_in_a_correlated_space_by_hand() -> None:
    # V = [[2, 1], [1, 2]] has the inverse [[2, -1], [-1, 2]] / 3: along (1, 1) (2 - 2 + 2) / 3, across 6 / 3.
    oblique = Ellipsoid(np.zeros(2), np.array([[2.0, 1.0], [1.0, 2.0]]), 1.0, 1, 0.1)

    assert oblique.distance([[1, 1], [1, -1]]).tolist() == pytest.approx([math.sqrt(2 / 3), math.sqrt(2)])


def test_the_boundary_is_inside() -> None:
    # 3, 4, 5 with the identity: exact in floating point.
    ball = Ellipsoid(np.zeros(2), np.eye(2), 5.0, 1, 0.1)

    assert ball.contains([[3, 4], [5, 0], [0, 0]]).all()
    assert not ball.contains([[3.001, 4.0], [math.nextafter(5, 6), 0.0]]).any()


def test_a_radius_of_zero_contains_the_mean_only() -> None:
    assert ellipsoid(radius=0.0).contains([[1.0, 2.0], [1.0, 2.001]]).tolist() == [True, False]


def test_density_by_hand() -> None:
    # n + w = 3.5: exp(-3.5 * 1 / 2) at distance 1 and exp(-3.5 * 13 / 2) at (5, 5).
    density = ellipsoid().density([[1, 2], [3, 2], [5, 5]])

    assert density.tolist() == pytest.approx([1, math.exp(-1.75), math.exp(-22.75)])


def test_density_does_not_depend_on_the_radius() -> None:
    points = [[0, 0], [2, 3]]

    assert ellipsoid(radius=9.0).density(points).tolist() == ellipsoid(radius=0.1).density(points).tolist()


def test_axes_are_scaled_eigenvectors_longest_first() -> None:
    axes = ellipsoid(radius=3.0).axes

    np.testing.assert_allclose(np.abs(axes), [[6, 0], [0, 3]], atol=1e-12)


@given(ellipsoids())
def test_the_ends_of_all_axes_lie_on_the_boundary(volume: Ellipsoid) -> None:
    ends = np.vstack([volume.mean + volume.axes, volume.mean - volume.axes])

    np.testing.assert_allclose(volume.distance(ends), volume.radius, rtol=1e-6, atol=1e-6)
    lengths = np.linalg.norm(volume.axes, axis=1)
    assert (np.diff(lengths) <= 1e-9).all()
    assert volume.axes.shape == (volume.dim, volume.dim)


@given(ellipsoids(), st.data())
def test_distance_agrees_with_the_definition(volume: Ellipsoid, data: st.DataObject) -> None:
    points = data.draw(hnp.arrays(np.float64, (3, volume.dim), elements=coordinates()))
    offsets = points - volume.mean
    expected = [math.sqrt(offset @ np.linalg.solve(volume.covariance, offset)) for offset in offsets]

    np.testing.assert_allclose(volume.distance(points), expected, rtol=1e-6, atol=1e-9)
    assert volume.contains(points).tolist() == (volume.distance(points) <= volume.radius).tolist()
    assert ((volume.density(points) >= 0) & (volume.density(points) <= 1)).all()


@given(ellipsoids())
def test_json_round_trip_is_exact(volume: Ellipsoid) -> None:
    again = volume_from_dict(json.loads(json.dumps(volume.to_dict(), allow_nan=False)))

    assert isinstance(again, Ellipsoid)
    np.testing.assert_array_equal(again.mean, volume.mean)
    np.testing.assert_array_equal(again.covariance, volume.covariance)
    assert (again.radius, again.n_keys, again.prior_weight) == (
        volume.radius,
        volume.n_keys,
        volume.prior_weight,
    )


@pytest.mark.parametrize("points", [[[1.0]], [[1.0, 2.0, 3.0]], [1.0, 2.0, 3.0], 1.0, [[[1.0, 2.0]]]])
def test_points_of_another_space_are_refused(points: Any) -> None:
    with pytest.raises(InputError, match=r"points must have the shape \(n, 2\), got"):
        ellipsoid().distance(points)


def test_a_single_point_needs_no_second_axis() -> None:
    assert ellipsoid().distance([3, 2]).tolist() == [1]


def document(**changes: object) -> dict[str, object]:
    return ellipsoid().to_dict() | changes


@pytest.mark.parametrize("key", ["mean", "covariance", "radius", "n_keys", "prior_weight"])
def test_a_missing_key_is_named(key: str) -> None:
    incomplete = document()
    del incomplete[key]
    with pytest.raises(ModelFormatError, match=f"malformed ellipsoid: the key '{key}' is missing"):
        volume_from_dict(incomplete)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radius": -1.0}, r"radius must be a number of at least 0 and of at most 1e\+90, got -1.0"),
        ({"radius": math.inf}, "radius must be a number"),
        ({"radius": math.nan}, "radius must be a number"),
        ({"radius": "1"}, "radius must be a number of at least 0 .*, got '1'"),
        ({"radius": True}, "radius must be a number"),
        ({"radius": None}, "radius must be a number"),
        ({"radius": [1.0]}, "radius must be a number"),
        ({"radius": 10**400}, "radius must be a number"),
        ({"n_keys": -1}, "n_keys must be an integer of at least 0, got -1"),
        ({"n_keys": 2.7}, "n_keys must be an integer"),
        ({"n_keys": "3"}, "n_keys must be an integer"),
        ({"n_keys": 10**400}, "n_keys must be a number"),
        ({"prior_weight": -0.1}, "prior_weight must be a number of at least 0"),
        ({"prior_weight": {}}, "prior_weight must be a number of at least 0"),
        ({"mean": ["1", "2"]}, r"expected numbers, got \['1', '2'\]"),
        ({"mean": [True, False]}, "expected numbers"),
        ({"mean": [1.0, None]}, "expected numbers"),
        ({"mean": [1.0, 10**400]}, "expected numbers"),
        ({"mean": {"0": 1.0}}, "expected numbers"),
        ({"mean": [1.0, [2.0]]}, "malformed ellipsoid"),
        ({"mean": [1.0, math.nan]}, r"the mean must not exceed 1e\+40, nor the covariance 1e\+80"),
        ({"mean": [1.0, -1e41]}, "the mean must not exceed"),
        ({"covariance": [[1e81, 0.0], [0.0, 1e81]]}, "nor the covariance"),
        ({"radius": 1e91}, "radius must be a number"),
        ({"radius": 1e40}, r"it extends beyond 1e\+40"),
        ({"n_keys": 10**16}, "n_keys must be a number"),
        ({"prior_weight": 1e16}, "prior_weight must be a number"),
        ({"covariance": [[4.0, 0.0], [0.0, math.inf]]}, "nor the covariance"),
        ({"mean": []}, r"mean \(0,\) and covariance \(2, 2\) do not match"),
        ({"mean": [], "covariance": []}, "do not match"),
        ({"mean": 1.0, "covariance": 4.0}, r"mean \(\) and covariance \(\) do not match|malformed"),
        ({"mean": [1.0]}, r"mean \(1,\) and covariance \(2, 2\) do not match"),
        ({"covariance": [[4.0, 0.0]]}, "do not match"),
        ({"covariance": [[4.0, 1.0], [0.0, 1.0]]}, "the covariance is not symmetric"),
        ({"covariance": [[4e-12, 1e-12], [0.0, 1e-12]]}, "the covariance is not symmetric"),
        ({"covariance": [[1.0, 2.0], [2.0, 1.0]]}, "the covariance is not positive definite"),
        ({"covariance": [[1.0, 0.0], [0.0, 0.0]]}, "the covariance is not positive definite"),
        ({"covariance": [[0.0, 0.0], [0.0, 0.0]]}, "the covariance is not positive definite"),
        ({"covariance": [[1.0, 0.0], [0.0, 1e-16]]}, "the covariance is not positive definite"),
        ({"covariance": [[1e-320, 0.0], [0.0, 1e-320]]}, "the covariance is not positive definite"),
        ({"covariance": [[-1.0, 0.0], [0.0, -1.0]]}, "the covariance is not positive definite"),
    ],
)
def test_malformed_documents_say_what_is_wrong(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ModelFormatError, match=message):
        volume_from_dict(document(**changes))


def test_a_document_of_whole_numbers_is_fine() -> None:
    volume = volume_from_dict(document(mean=[1, 2], covariance=[[4, 0], [0, 1]], radius=1, prior_weight=0))

    assert volume.distance([[3, 2]]).tolist() == [1]


def test_the_precision_inverts_the_covariance() -> None:
    volume = Ellipsoid(np.zeros(2), np.array([[2.0, 1.0], [1.0, 2.0]]), 1.0, 1, 0.1)
    expected: NDArray[np.float64] = np.array([[2.0, -1.0], [-1.0, 2.0]]) / 3

    np.testing.assert_allclose(volume.precision, expected)
