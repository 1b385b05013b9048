from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.rl.baselines import TileCoding
from relforest.rl.baselines.tile_coding import TileKind
from relforest.support.errors import InputError, ModelFormatError

KEEPAWAY = [2.0, 2.0, 3.0, 2.0, 3.0, 2.0, 3.0, 3.0, 3.0, 4.0, 4.0, 10.0, 10.0]


def active(tiles: TileCoding, observation: Sequence[float], action: int = 0) -> list[int]:
    found: list[int] = tiles.features(observation).indices[action].tolist()
    return found


def test_tiles_worked_by_hand() -> None:
    # Width 2 in 4 tilings: steps of 0.5, and 0 to 4 is q = 0 to 8, so 8 + 4 tiles.
    tiles = TileCoding([2.0], 1, tilings=4, lower=0.0, upper=4.0)
    assert (tiles.n_features, tiles.n_active) == (12, 4)
    assert (tiles.n_variables, tiles.n_actions) == (1, 1)
    # 0: q = 0, cells (0, -1, -1, -1) of the tilings; 1.3: q = 2, cells (0, 0, 0, -1). Tilings 0 and 3 agree.
    assert active(tiles, [0.0]) == [0, 1, 2, 3]
    assert active(tiles, [1.3]) == [2, 3, 4, 5]
    # 1.499 is still in the step from 1 to 1.5, 1.5 in the next; 4 is the last step, q = 8.
    assert active(tiles, [1.499]) == [2, 3, 4, 5]
    assert active(tiles, [1.5]) == [3, 4, 5, 6]
    assert active(tiles, [4.0]) == [8, 9, 10, 11]


def test_actions_and_variables_have_tiles_of_their_own() -> None:
    # The first variable has 2 / 1 * 2 + 2 = 6 tiles, the second 3 / 3 * 2 + 2 = 4: 10 per action.
    tiles = TileCoding([1.0, 3.0], 2, tilings=2, lower=[0.0, -3.0], upper=[2.0, 0.0])
    assert tiles.n_features == 20
    # 0.6 / 1 * 2: q = 1. -1.2 / 3 * 2 = -0.8: q = -1, one above the q = -2 of the lower bound.
    features = tiles.features([0.6, -1.2])
    assert features.indices.tolist() == [[1, 2, 7, 8], [11, 12, 17, 18]]
    assert features.values.tolist() == [[1.0] * 4] * 2


def test_beyond_the_range_are_the_tiles_of_the_nearer_bound() -> None:
    tiles = TileCoding([2.0], 1, tilings=4, lower=-1.0, upper=3.0)
    assert active(tiles, [-1e300]) == active(tiles, [-1.0]) == [0, 1, 2, 3]
    assert active(tiles, [1e300]) == active(tiles, [3.0])
    assert max(active(tiles, [3.0])) == tiles.n_features - 1


def test_the_benchmark_has_416_active_tiles() -> None:
    tiles = TileCoding(KEEPAWAY, 3)
    assert tiles.n_active == 416
    # By default 64 tiles of 32 steps each, and a tile more for the shifts.
    assert tiles.n_features == 3 * 13 * 65 * 32


@given(
    st.floats(0.3, 5.0),
    st.integers(1, 7),
    st.lists(st.floats(-20.0, 20.0), min_size=2, max_size=12),
)
def test_features_are_the_cells_of_the_definition(width: float, tilings: int, numbers: list[float]) -> None:
    tiles = TileCoding([width], 1, tilings=tilings, lower=-20.0, upper=20.0)
    feature_of: dict[tuple[int, int], int] = {}
    for number in numbers:
        q = math.floor(number / width * tilings)
        cells = {(j, math.floor((q - j) / tilings)) for j in range(tilings)}
        found = active(tiles, [number])
        assert len(set(found)) == tilings
        assert 0 <= min(found) <= max(found) < tiles.n_features
        # Tiling j has the features that are j modulo tilings, but for a constant.
        shift = found[0] - (q - tilings + 1)
        cell_of = {((feature - shift) % tilings, (feature - shift) // tilings): feature for feature in found}
        assert set(cell_of) == cells
        for cell, feature in cell_of.items():
            assert feature_of.setdefault(cell, feature) == feature
    assert len(set(feature_of.values())) == len(feature_of)


def test_bells_stand_in_the_middle_of_their_tiles() -> None:
    tiles = TileCoding([2.0, 10.0], 2, tilings=8, lower=-3.0, kind="bells")
    for observation in ([0.3, 17.0], [-3.0, 0.0], [-9.0, 1e300]):
        indices, values = tiles.features(observation)
        for i, width in enumerate((2.0, 10.0)):
            number = min(max(observation[i], -3.0), -3.0 + 64 * width)
            q = math.floor(number / width * 8)
            # The last active tile begins at step q, each one before it a step earlier.
            middles = [(q - 7 + j) * width / 8 + width / 2 for j in range(8)]
            bells = [math.exp(-((number - middle) ** 2) / (2 * (width / 8) ** 2)) for middle in middles]
            scale = math.sqrt(8 / math.sqrt(math.pi))
            for row in values:
                np.testing.assert_allclose(row[8 * i : 8 * i + 8], scale * np.array(bells), rtol=1e-9)
        plain = TileCoding([2.0, 10.0], 2, tilings=8, lower=-3.0)
        np.testing.assert_array_equal(indices, plain.features(observation).indices)


@given(st.floats(-1.0, 30.0))
def test_bells_are_as_long_as_tiles_wherever_a_state_is(number: float) -> None:
    features = TileCoding([2.0], 1, tilings=8, kind="bells").features([number])
    # What a step of size 1 changes the value by.
    assert (features.values[0] ** 2).sum() == pytest.approx(8.0, rel=1e-3)


def test_features_of_different_states_are_different_arrays() -> None:
    tiles = TileCoding([1.0], 1, tilings=2)
    first = tiles.features([0.0]).indices
    tiles.features([5.0])
    assert first.tolist() == [[0, 1]]


@pytest.mark.parametrize(
    ("observation", "message"),
    [
        ([1.0], r"must hold 2 variables.*shape \(1,\)"),
        ([1.0, 2.0, 3.0], "must hold 2 variables"),
        ([[1.0, 2.0]], "must hold 2 variables"),
        (3.0, "must hold 2 variables"),
        ([1.0, float("nan")], "variable 1 of an observation must be finite, got nan"),
        ([float("-inf"), 1.0], "variable 0 of an observation must be finite, got -inf"),
        (["a", "b"], "must be an array of numbers"),
        ([[1.0], [2.0, 3.0]], "must be an array of numbers"),
        (None, "an observation must"),
    ],
)
def test_bad_observations_are_refused(observation: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        TileCoding([1.0, 1.0], 2).features(observation)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"widths": []}, "widths must be at least one number"),
        ({"widths": 2.0}, "widths must be at least one number"),
        ({"widths": "23"}, "widths must be at least one number"),
        ({"widths": [1.0, 0.0]}, r"widths\[1\] must be above 0"),
        ({"widths": [-1.0]}, r"widths\[0\] must be above 0"),
        ({"widths": [float("nan")]}, r"widths\[0\] must be a finite number"),
        ({"widths": [None]}, r"widths\[0\] must be a finite number"),
        ({"widths": [1e-300], "upper": 1.0}, r"widths\[0\] = 1e-300 is too small"),
        ({"widths": [1e-6], "upper": 5.0}, r"need \d+ features.*use wider tiles"),
        ({"widths": [1e307]}, r"upper\[0\] must be a finite number"),
        ({"n_actions": 0}, "n_actions must be an integer of at least 1"),
        ({"n_actions": 10**9}, "need .* features"),
        ({"kind": "cones"}, "kind must be one of 'tiles', 'bells', got 'cones'"),
        ({"tilings": 0}, "tilings must be an integer of at least 1"),
        ({"tilings": 2.5}, "tilings must be an integer of at least 1"),
        ({"widths": [1.0] * 10_001}, "widths must be at most 10000 numbers, got 10001"),
        ({"lower": [0.0, 0.0]}, "lower must be one number, or 1 as the widths"),
        ({"upper": [[1.0]]}, r"upper\[0\] must be a finite number"),
        ({"upper": 0.0}, r"upper\[0\] must be above lower\[0\] = 0.0, got 0.0"),
        ({"upper": float("inf")}, r"upper\[0\] must be a finite number"),
        ({"lower": 7.0, "upper": 5.0}, r"upper\[0\] must be above lower"),
    ],
)
def test_bad_options_are_refused(options: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"widths": [1.0], "n_actions": 2}
    with pytest.raises(InputError, match=message):
        TileCoding(**(given | options))


@pytest.mark.parametrize("kind", ["tiles", "bells"])
def test_tilings_survive_json(kind: TileKind) -> None:
    upper: Any = np.linspace(20, 32, 13)
    tiles = TileCoding(KEEPAWAY, 3, tilings=8, lower=-1, upper=upper, kind=kind)
    stored = json.loads(json.dumps(tiles.to_dict()))
    again = TileCoding.from_dict(stored)
    assert again.to_dict() == tiles.to_dict()
    observation = np.linspace(0, 25, 13)
    for one, other in zip(again.features(observation), tiles.features(observation), strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    "changes",
    [
        {"kind": "dense"},
        {"more": 1},
        {"widths": None},
        {"widths": {"0": 1.0}},
        {"widths": [[1.0]]},
        {"n_actions": "3"},
        {"n_actions": True},
        {"tilings": None},
        {"lower": [1.0, 2.0]},
        {"upper": "high"},
        {"upper": [1e308], "widths": [1e-308]},
    ],
)
def test_hostile_documents_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ModelFormatError, match="malformed tile coding"):
        TileCoding.from_dict(TileCoding([1.0], 2).to_dict() | changes)


@pytest.mark.parametrize("document", [None, 3, [], {}, "tiles"])
def test_other_values_are_no_tile_coding(document: Any) -> None:
    with pytest.raises(ModelFormatError, match="malformed tile coding"):
        TileCoding.from_dict(document)
