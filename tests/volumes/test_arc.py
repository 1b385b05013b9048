from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.support.errors import InputError, ModelFormatError
from relforest.volumes import Arc, volume_from_dict
from strategies import coordinates

angles = st.floats(-math.pi, math.pi)


def test_distance_by_hand_across_the_seam() -> None:
    # 3 to -3: 2 pi - 6 over the seam; 3 to 0: 3; 3 + 2 pi is 3 again; opposite: pi.
    arc = Arc(3.0, 0.5, 1.0)

    expected = [2 * math.pi - 6, 3.0, 0.0, math.pi]
    assert arc.distance([-3, 0, 3 + 2 * math.pi, 3 - math.pi]).tolist() == pytest.approx(expected, abs=1e-15)


def test_the_ends_are_inside() -> None:
    arc = Arc(1.0, 0.5, 1.0)

    assert arc.contains([0.5, 1.5, 1.0]).all()
    assert not arc.contains([0.49, 1.51, -2.0]).any()


def test_an_arc_may_cross_the_seam() -> None:
    assert Arc(3.0, 0.5, 1.0).contains([3.14, -3.14, -2.9, -2.7]).tolist() == [True, True, True, False]


def test_density_by_hand() -> None:
    # exp(2 (cos 0 - 1)), exp(2 (cos(pi / 2) - 1)), exp(2 (cos pi - 1)).
    density = Arc(0.5, 0.1, 2.0).density([0.5, 0.5 + math.pi / 2, 0.5 + math.pi])

    assert density.tolist() == pytest.approx([1, math.exp(-2), math.exp(-4)])


def test_without_concentration_all_angles_are_equally_typical() -> None:
    assert Arc(0.5, 0.1, 0.0).density([0.0, 3.0]).tolist() == [1, 1]


@given(angles, angles, st.integers(-3, 3))
def test_whole_turns_change_nothing(mean: float, angle: float, turns: int) -> None:
    arc, turned = Arc(mean, 0.5, 1.0), Arc(mean + 2 * math.pi * turns, 0.5, 1.0)

    assert turned.distance([angle]) == pytest.approx(arc.distance([angle]), abs=1e-12)
    assert arc.distance([angle + 2 * math.pi * turns]) == pytest.approx(arc.distance([angle]), abs=1e-12)
    assert 0 <= arc.distance([angle])[0] <= math.pi


@given(angles, coordinates(0, 100), coordinates(0, 1e6))
def test_json_round_trip_is_exact(mean: float, radius: float, kappa: float) -> None:
    arc = Arc(mean, radius, kappa)
    again = volume_from_dict(json.loads(json.dumps(arc.to_dict(), allow_nan=False)))

    assert isinstance(again, Arc)
    assert (again.mean, again.radius, again.kappa) == (mean, radius, kappa)


def test_angles_may_stand_in_a_row_or_a_column() -> None:
    arc = Arc(0.0, 1.0, 1.0)

    assert arc.distance([0.5, 1.0]).tolist() == arc.distance([[0.5], [1.0]]).tolist() == [0.5, 1.0]
    assert arc.distance(0.5).tolist() == [0.5]
    assert arc.dim == 1


@pytest.mark.parametrize("points", [[[0.5, 1.0]], np.zeros((2, 1, 1)), np.zeros((1, 0))])
def test_points_that_are_no_angles_are_refused(points: Any) -> None:
    with pytest.raises(InputError, match=r"angles must have the shape \(n,\) or \(n, 1\), got"):
        Arc(0.0, 1.0, 1.0).distance(points)


@pytest.mark.parametrize("key", ["mean", "radius", "kappa"])
def test_a_missing_key_is_named(key: str) -> None:
    document = Arc(0.0, 1.0, 1.0).to_dict()
    del document[key]
    with pytest.raises(ModelFormatError, match=f"malformed arc: the key '{key}' is missing"):
        volume_from_dict(document)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e13, "1", None, True, [1.0], {}, 10**400])
@pytest.mark.parametrize("key", ["mean", "radius", "kappa"])
def test_a_value_that_is_no_number_within_bounds_is_named(key: str, value: object) -> None:
    with pytest.raises(ModelFormatError, match=f"malformed arc: .*{key} must be a number of at least"):
        volume_from_dict(Arc(0.0, 1.0, 1.0).to_dict() | {key: value})


@pytest.mark.parametrize("key", ["radius", "kappa"])
def test_a_negative_value_is_named(key: str) -> None:
    with pytest.raises(ModelFormatError, match=f"{key} must be a number of at least 0 and .*, got -1.0"):
        volume_from_dict(Arc(0.0, 1.0, 1.0).to_dict() | {key: -1.0})


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (None, "malformed volume: expected an object, got NoneType"),
        ([], "malformed volume: expected an object, got list"),
        ({}, "unknown volume shape None: expected one of ellipsoid, arc"),
        ({"shape": "box"}, "unknown volume shape 'box'"),
        ({"shape": ["arc"]}, r"unknown volume shape \['arc'\]"),
    ],
)
def test_a_document_of_no_known_shape_is_refused(document: object, message: str) -> None:
    with pytest.raises(ModelFormatError, match=message):
        volume_from_dict(document)
