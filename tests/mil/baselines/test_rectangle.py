"""Growing a box, selecting its features, and moving its bounds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import norm

from reference import baselines as reference
from relforest.mil.baselines.rectangle import discriminating, expansion, grow

Floats = NDArray[np.float64]


def grown(bags: list[Floats]) -> list[int]:
    """Row within its bag of the point chosen from each bag."""
    starts = np.cumsum([0, *map(len, bags)])
    rows: list[int] = (grow(np.concatenate(bags), starts) - starts[:-1]).tolist()
    return rows


def test_a_box_grown_by_hand() -> None:
    # Intervals of the bags: [0, 10], [4, 4], [5, 9]. Least maximum 4, greatest minimum 5: centre 4.5.
    # Seed 4 (or 5, later); then 5 enlarges by 1, then of {0, 10} 0 by 4.
    bags = [np.array([[0.0], [10.0]]), np.array([[4.0]]), np.array([[9.0], [5.0]])]

    assert grown(bags) == [0, 0, 1]


def test_backfitting_revises_a_choice() -> None:
    # Bag 0 {(4, 3), (9, 0)}, bag 1 (0, 0), bag 2 (8, 0). Least maxima (0, 0), greatest minima (8, 0): the
    # centre is (4, 0). (4, 3), 3 away, is the nearest and begins. (0, 0) enlarges the box by 4 + 3, (8, 0)
    # also: bag 1 is added first, and with it alone (4, 3), of size 7, remains better than (9, 0), of size 9.
    # Then bag 2 is added. Around (0, 0) and (8, 0), (4, 3) enlarges the box by 3, but (9, 0) only by 1: bag 0
    # changes to it. Without backfitting it would keep row 0.
    assert grown([np.array([[4.0, 3.0], [9.0, 0.0]]), np.array([[0.0, 0.0]]), np.array([[8.0, 0.0]])]) == [
        1,
        0,
        0,
    ]


@given(st.integers(0, 2**32 - 1))
def test_the_plain_twin_grows_the_same_box(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bags = [rng.standard_normal((rng.integers(1, 5), 3)) for _ in range(rng.integers(1, 7))]

    assert grown(bags) == reference.grow(bags)


def test_equal_boxes_do_not_change_places_for_ever() -> None:
    rng = np.random.default_rng(0)
    bags = [rng.choice([0.0, 0.1, 0.3], (4, 2)) for _ in range(12)]

    assert len(grown(bags)) == 12


def test_features_selected_by_hand() -> None:
    # The box is [0, 1] along three features, the margin 1. Points 0 and 1 are clearly out along feature 0,
    # point 1 also along 1; point 2 nowhere clearly, and farthest along 2; point 3 is inside.
    negatives = np.array([[3.0, 0.5, 0.5], [-2.0, 5.0, 0.5], [0.5, 1.1, 1.9], [0.5, 0.5, 0.5]])
    box = np.array([[0.0] * 3, [1.0] * 3])

    assert discriminating(negatives, box, 1.0).tolist() == [True, False, True]
    # Without a margin every feature that leaves a point outside excludes it: 1 has points 1 and 2.
    assert discriminating(negatives, box, 0.0).tolist() == [True, True, False]
    assert discriminating(negatives[3:], box, 1.0).tolist() == [False] * 3
    assert discriminating(negatives[:0], box, 1.0).tolist() == [False] * 3


@given(st.integers(0, 2**32 - 1), st.floats(0, 2))
def test_the_selected_features_exclude_all_that_can_be(seed: int, margin: float) -> None:
    rng = np.random.default_rng(seed)
    negatives = 2 * rng.standard_normal((20, 4))
    box = np.array([[-1.0] * 4, [1.0] * 4])
    selected = discriminating(negatives, box, margin)
    outside = np.maximum(box[0] - negatives, negatives - box[1]) > 0

    assert (outside[:, selected].any(axis=1) == outside.any(axis=1)).all()


def test_bounds_move_to_the_quantiles_of_the_density() -> None:
    values = np.array([[0.0], [1.0], [1.5], [4.0]])
    tau, epsilon = 0.9, 0.02
    sigma = 2.0 / norm.ppf(0.95)
    moves = expansion(values, tau, epsilon)

    assert np.mean(norm.cdf(-moves[0, 0], values[:, 0], sigma)) == pytest.approx(epsilon / 2)
    assert np.mean(norm.sf(4 + moves[1, 0], values[:, 0], sigma)) == pytest.approx(epsilon / 2)


def test_bounds_never_move_inwards() -> None:
    # Of 100 values one is at each end; with narrow kernels less than a tenth of the mass is beyond.
    values = np.linspace(0, 1, 100)[:, None]

    assert expansion(values, 0.999, 0.2).tolist() == [[0.0], [0.0]]


def test_a_box_without_width_stays() -> None:
    assert expansion(np.full((5, 2), 3.0), 0.999, 0.01).tolist() == [[0, 0], [0, 0]]


def test_smaller_tau_and_epsilon_make_larger_boxes() -> None:
    values = np.random.default_rng(0).standard_normal((20, 3))
    usual = expansion(values, 0.999, 0.01)

    assert (expansion(values, 0.99, 0.01) > usual).all()
    assert (expansion(values, 0.999, 0.001) > usual).all()
