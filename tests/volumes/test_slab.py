from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError, ModelFormatError
from relforest.volumes import Ellipsoid, Slab, volume_from_dict

# y from -1 to 5: 2 -+ 1.5 * 2.
SLAB = Slab(Ellipsoid(np.array([2.0]), np.array([[4.0]]), 1.5, 3, 0.5), 1, 3)
POINTS = [[9.0, 5.0, -9.0], [0.0, 5.1, 0.0], [0.0, -1.0, 7.0], [1e30, 2.0, -1e30]]


def test_only_one_coordinate_counts() -> None:
    assert SLAB.contains(POINTS).tolist() == [True, False, True, True]
    assert SLAB.distance(POINTS).tolist() == pytest.approx([1.5, 1.55, 1.5, 0])
    # exp(-3.5 D^2 / 2), 1 at the centre.
    assert SLAB.density(POINTS).tolist() == pytest.approx(np.exp(-1.75 * np.array([2.25, 2.4025, 2.25, 0])))


def test_its_form_as_an_ellipsoid_without_end() -> None:
    assert (SLAB.radius, SLAB.density_sharpness) == (1.5, 3.5)
    offsets = np.array(POINTS) - SLAB.mean
    squared = np.einsum("ij,jk,ik->i", offsets, SLAB.precision, offsets)
    np.testing.assert_allclose(np.sqrt(squared), SLAB.distance(POINTS))


def test_json_round_trip_is_exact() -> None:
    again = volume_from_dict(json.loads(json.dumps(SLAB.to_dict(), allow_nan=False)))

    assert isinstance(again, Slab)
    assert again.to_dict() == SLAB.to_dict()
    assert (again.axis, again.dim) == (1, 3)


def test_points_of_another_dimension_are_refused() -> None:
    with pytest.raises(InputError, match=r"points must have the shape \(n, 3\), got \(1, 2\)"):
        SLAB.contains([0.0, 1.0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axis": 3}, "axis must be an integer from 0 to 2, got 3"),
        ({"axis": True}, "axis must be an integer"),
        ({"dim": 1}, "dim must be an integer from 2"),
        ({"dim": 10**9}, "dim must be an integer from 2"),
        ({"interval": []}, "malformed"),
        ({"interval": None}, "malformed"),
        ({"interval": Ellipsoid(np.zeros(2), np.eye(2), 1.0, 1, 0.1).to_dict()}, "has 2 dimensions, not 1"),
        ({"interval": SLAB.to_dict()}, "malformed"),
    ],
)
def test_malformed_slabs_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ModelFormatError, match=message):
        volume_from_dict(SLAB.to_dict() | changes)


@pytest.mark.parametrize("key", ["axis", "dim", "interval"])
def test_a_missing_key_is_named(key: str) -> None:
    document = SLAB.to_dict()
    del document[key]
    with pytest.raises(ModelFormatError, match=f"malformed slab: the key '{key}' is missing"):
        volume_from_dict(document)
