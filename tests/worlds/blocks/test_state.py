from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.engine import Engine
from relforest.worlds.blocks.state import BlocksState, is_upright, orientations
from worlds.blocks.staged_blocks import LONG, UPRIGHT, staged


def test_bounds_by_hand() -> None:
    state = staged((LONG, (1, 2, 0)), (LONG, (0, 4, UPRIGHT)), ((1, 1), (0, 0, math.pi / 4)))
    root = math.sqrt(2.0)
    expected = [(-3, 5, 0, 4), (-2, 2, 0, 8), (-root, root, -root, root)]
    np.testing.assert_allclose(state.bounds, expected, atol=1e-12)


def test_bounds_agree_with_the_engine() -> None:
    rng, engine = np.random.default_rng(0), Engine()
    placed = [
        (tuple(rng.uniform(0.5, 5, 2)), tuple(rng.uniform((-30, 5, -4), (30, 30, 4)))) for _ in range(20)
    ]
    for half_extents, (x, y, angle) in placed:
        engine.add_box(half_extents, (x, y), angle)
    np.testing.assert_allclose(staged(*placed).bounds, engine.bounds(), atol=1e-4)


@pytest.mark.parametrize(
    ("half_extents", "angle", "expected"),
    [
        ((4, 2), 0.0, 0.0),
        ((2, 4), 0.0, math.pi),
        ((4, 2), math.pi / 2, math.pi),
        ((4, 2), -math.pi / 2, math.pi),
        ((2, 4), math.pi / 2, 0.0),
        ((4, 2), math.pi, 0.0),
        ((4, 2), 0.3, 0.6),
        ((4, 2), 0.3 + 7 * math.pi, 0.6),
        ((2, 4), 0.3, 0.6 - math.pi),
        ((3, 3), 0.3, 0.6),
    ],
)
def test_orientations_by_hand(half_extents: tuple[float, float], angle: float, expected: float) -> None:
    found = orientations(np.array([half_extents], dtype=float), np.array([angle]))
    assert found == pytest.approx(expected, abs=1e-12)


def test_upright_means_nearer_the_vertical() -> None:
    state = staged(*((LONG, (0, 4, math.radians(angle))) for angle in (0, 44, 46, 90, 134, 136, -46, 180)))
    assert is_upright(state.orientations).tolist() == [False, False, True, True, True, False, True, False]


def test_contacts_are_told_by_ids() -> None:
    state = staged((LONG, (0, 2, 0)), (LONG, (0, 6, 0)), (LONG, (20, 2, 0)), contacts=[(0, 1)])
    assert state.touching.tolist() == [[False, True, False], [True, False, False], [False, False, False]]


def test_arrays_of_the_wrong_shape_are_refused() -> None:
    good = staged((LONG, (0, 2, 0)))
    with pytest.raises(InputError, match=r"poses must have the shape \(1, 3\) for 1 blocks"):
        BlocksState(good.ids, good.half_extents, good.colors, np.zeros((2, 3)), good.touching)
