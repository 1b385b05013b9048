from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.scenes.color import srgb_to_lab
from relforest.support.errors import InputError
from relforest.worlds.blocks.color import ciede2000
from relforest.worlds.blocks.scores import (
    COLOR_DISTANCES,
    color_distance,
    grouping_score,
    match_score,
    mean_height,
    prototype,
)
from relforest.worlds.blocks.stacks import connected, stacks
from relforest.worlds.blocks.state import BlocksState
from worlds.blocks.staged_blocks import reordered, row, shifted, staged

RGB, CIEDE = COLOR_DISTANCES["rgb"], COLOR_DISTANCES["ciede2000"]


@st.composite
def states(draw: st.DrawFn) -> BlocksState:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(1, 6))
    return staged(
        *(
            (tuple(rng.uniform(0.5, 5.0, 2)), (rng.uniform(-15, 15), rng.uniform(1, 9), rng.uniform(-4, 4)))
            for _ in range(n)
        ),
        colors=[tuple(color) for color in rng.random((n, 3))],
    )


def test_the_mean_height_is_that_of_the_centres() -> None:
    # (2 + 5 + 2) / 3
    assert mean_height(
        staged(((2, 2), (0, 2, 0)), ((1, 1), (0, 5, 0.3)), ((2, 2), (9, 2, 0)))
    ) == pytest.approx(3.0)
    assert mean_height(staged()) == 0.0


def test_the_score_of_a_distance_by_hand() -> None:
    # Below 30: sin((30 - d) / 30 * 90 degrees); 0 -> 1, 10 -> sin 60, 30 -> 0.
    # Above: sin((30 - d) / 90 * 90 degrees); 60 -> -sin 30, 75 -> -sin 45, 120 -> -1, and -1 beyond.
    distances = np.array([0.0, 10.0, 30.0, 60.0, 75.0, 120.0, 500.0])
    expected = [1.0, math.sin(math.pi / 3), 0.0, -0.5, -math.sqrt(0.5), -1.0, -1.0]
    assert match_score(distances, CIEDE) == pytest.approx(expected)


def test_isolated_blocks_score_nothing() -> None:
    # Side 4: midpoints 4.1 apart lie outside each other.
    assert grouping_score(row(-4.1, 0.0, 4.1), RGB) == 0.0
    assert grouping_score(staged(), RGB) == 0.0


def test_a_stack_of_three_by_hand() -> None:
    # Greys 0.0, 0.1, 0.5 and their mean 0.2: 0.1 is nearest. Distances from it, times sqrt(3) for RGB:
    # 0.1732 -> sin((0.5 - 0.1732) / 0.5 * pi/2) = sin(1.02665) = 0.85565
    # 0.6928 -> sin((0.5 - 0.6928) / (1.7321 - 0.5) * pi/2) = sin(-0.24583) = -0.24336
    state = row(0.0, 1.0, 2.0, colors=[(0.0,) * 3, (0.1,) * 3, (0.5,) * 3])
    assert grouping_score(state, RGB) == pytest.approx(0.85565 - 0.24336, abs=1e-4)


def test_two_stacks_add_up_and_equal_colors_score_one_each() -> None:
    red, blue = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    state = row(-20.0, -20.0, 20.0, 20.0, 20.0, colors=[red, red, blue, blue, blue])
    # Five blocks, two prototypes.
    for distance in (RGB, CIEDE):
        assert grouping_score(state, distance) == pytest.approx(3.0)


def test_the_prototype_is_the_member_nearest_to_the_mean_in_lab() -> None:
    colors = [(0.9, 0.2, 0.1), (0.8, 0.3, 0.2), (0.3, 0.3, 0.9)]
    lab = srgb_to_lab(colors)
    to_mean = ciede2000(lab, lab.mean(axis=0))
    centre = int(np.argmin(to_mean))
    others = [i for i in range(3) if i != centre]
    expected = sum(match_score(ciede2000(lab[others], lab[centre]), CIEDE))
    assert grouping_score(row(0.0, 0.0, 0.0, colors=colors), CIEDE) == pytest.approx(expected)


def test_midpoints_make_stacks_and_any_overlap_connects() -> None:
    # A wide block (-5 to 5); a small one whose midpoint is at 4; one that only reaches in, from 4.5 to 8.5;
    # one whose span holds no midpoint and whose midpoint lies in the third one.
    state = staged(((5, 1), (0, 1, 0)), ((0.4, 0.4), (4, 3, 0)), ((2, 2), (6.5, 2, 0)), ((1, 1), (8, 9, 0)))
    assert stacks(state.poses[:, 0], state.bounds).tolist() == [0, 0, 2, 2]
    assert connected(state.bounds).tolist() == [0, 0, 0, 0]
    assert connected(state.bounds[[1, 3]]).tolist() == [0, 1]


def test_links_reach_along_a_chain() -> None:
    state = row(0.0, 8.0, 2.0, 6.0, 4.0)
    assert stacks(state.poses[:, 0], state.bounds).tolist() == [0] * 5


@given(states(), st.randoms(use_true_random=False), st.floats(-20.0, 20.0))
def test_scores_depend_neither_on_order_nor_on_place(state: BlocksState, random: object, x: float) -> None:
    order = list(range(len(state)))
    random.shuffle(order)  # type: ignore[attr-defined]
    moved = shifted(reordered(state, order), round(x * 8) / 8)
    for distance in (RGB, CIEDE):
        score = grouping_score(state, distance)
        assert grouping_score(moved, distance) == pytest.approx(score, abs=1e-9)
        assert 1 - len(state) <= score <= len(state) - 1
    assert mean_height(moved) == pytest.approx(mean_height(state))


def test_an_unknown_distance_is_an_error_that_lists_the_known_ones() -> None:
    with pytest.raises(InputError, match="distance must be one of 'ciede2000', 'rgb', got 'lab'"):
        color_distance("lab")


@given(states())
def test_the_score_is_the_sum_over_stacks_taken_one_by_one(state: BlocksState) -> None:
    labels = stacks(state.poses[:, 0], state.bounds)
    for distance in (RGB, CIEDE):
        total = 0.0
        for label in set(labels.tolist()):
            points = distance.coordinates(state.colors[labels == label])
            centre = prototype(points, distance.difference)
            others = np.delete(points, centre, axis=0)
            total += float(match_score(distance.difference(others, points[centre]), distance).sum())
        assert grouping_score(state, distance) == pytest.approx(total, abs=1e-9)
