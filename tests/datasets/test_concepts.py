from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.datasets import between_scenes, figure41_scenes, yellow_scenes
from relforest.scenes import Scenes
from relforest.support.errors import InputError

Generator = Callable[..., tuple[Scenes, NDArray[np.bool_]]]
Point = tuple[float, ...]
GENERATORS: tuple[Generator, ...] = (between_scenes, figure41_scenes, yellow_scenes)


def points(scenes: Scenes, name: str, scene: int) -> list[Point]:
    return [tuple(value.tolist()) for value in scenes.values[name][scenes.objects(scene)]]


def is_between(a: Point, b: Point, c: Point) -> bool:
    """Project C on the axis from A to B by dot and cross products, in units of its length."""
    axis = (b[0] - a[0], b[1] - a[1])
    offset = (c[0] - a[0], c[1] - a[1])
    squared = axis[0] ** 2 + axis[1] ** 2
    along = (axis[0] * offset[0] + axis[1] * offset[1]) / squared
    across = (axis[0] * offset[1] - axis[1] * offset[0]) / squared
    return 0.2 < along < 0.8 and abs(across) < 0.15


def is_red(color: Point) -> bool:
    return color[0] > 0.5 and color[1] < 0.5 and color[2] < 0.5


def red_at_origin(locations: list[Point], colors: list[Point]) -> bool:
    return any(is_red(c) and math.hypot(*x) <= 2 for x, c in zip(locations, colors, strict=True))


def other_than_red_with_a_far_one(locations: list[Point], colors: list[Point]) -> bool:
    return any(
        not is_red(c) and any(math.dist(x, y) > 10 for y in locations)
        for x, c in zip(locations, colors, strict=True)
    )


@pytest.mark.parametrize(("n_objects", "n_distractors"), [((5, 8), 0), ((5, 8), 20), (15, 0)])
def test_between_labels_follow_the_rule(n_objects: int | tuple[int, int], n_distractors: int) -> None:
    scenes, labels = between_scenes(
        np.random.default_rng(0), 200, n_objects=n_objects, n_distractors=n_distractors
    )
    for scene in range(len(scenes)):
        a, b = (tuple(scenes.values["location"][row].tolist()) for row in scenes.arguments[scene])
        others = [c for c in points(scenes, "location", scene) if c not in (a, b)]
        assert labels[scene] == any(is_between(a, b, c) for c in others)


def test_figure41_labels_follow_the_rule_and_both_disjuncts_matter() -> None:
    scenes, labels = figure41_scenes(np.random.default_rng(0), 400)
    only_first = only_second = 0
    for scene in range(len(scenes)):
        locations, colors = points(scenes, "location", scene), points(scenes, "color", scene)
        first, second = red_at_origin(locations, colors), other_than_red_with_a_far_one(locations, colors)
        assert labels[scene] == (first or second)
        only_first += first and not second
        only_second += second and not first
    assert only_first >= 40
    assert only_second >= 40


def test_figure41_needs_the_color_of_the_far_pair() -> None:
    scenes, labels = figure41_scenes(np.random.default_rng(1), 400)
    far_reds_in_negatives = 0
    for scene in np.flatnonzero(~labels):
        locations = points(scenes, "location", int(scene))
        far_reds_in_negatives += any(math.dist(x, y) > 10 for x in locations for y in locations)
    assert far_reds_in_negatives >= 10


def test_yellow_labels_follow_the_rule() -> None:
    scenes, labels = yellow_scenes(np.random.default_rng(0), 400)
    for scene in range(len(scenes)):
        yellow = [abs(r - g) < 0.12 and r + g > 0.5 and b < 0.2 for r, g, b in points(scenes, "color", scene)]
        assert labels[scene] == any(yellow)


def test_yellow_is_a_band_that_a_ball_cannot_hold() -> None:
    scenes, _ = yellow_scenes(np.random.default_rng(2), 2000)
    red, green, blue = scenes.values["color"].T
    yellow = (np.abs(red - green) < 0.12) & (red + green > 0.5) & (blue < 0.2)
    along, across = (red + green)[yellow] / math.sqrt(2), (red - green)[yellow] / math.sqrt(2)
    # Brightness in [.4, 1] moves R + G by .6 * 1.75: a standard deviation of .6 * 1.75 / sqrt(2 * 12) = .21.
    assert along.std() == pytest.approx(0.21, abs=0.02)
    assert across.std() < 0.025
    # The nearest hues, dim orange and dim lime, lie closer to the centre of the band than its own ends do.
    centre = scenes.values["color"][yellow].mean(axis=0)
    distances = np.linalg.norm(scenes.values["color"] - centre, axis=1)
    assert distances[~yellow].min() < distances[yellow].max()


@pytest.mark.parametrize("generator", GENERATORS)
def test_half_of_the_scenes_are_positive_in_random_order(generator: Generator) -> None:
    scenes, labels = generator(np.random.default_rng(0), 201)
    assert len(scenes) == len(labels) == 201
    assert labels.sum() == 100
    assert 25 < labels[:100].sum() < 75


@pytest.mark.parametrize("generator", GENERATORS)
def test_numbers_of_objects_cover_their_range(generator: Generator) -> None:
    scenes, _ = generator(np.random.default_rng(0), 200)
    assert sorted(set(scenes.counts.tolist())) == [5, 6, 7, 8]
    many, _ = generator(np.random.default_rng(0), 20, n_objects=15)
    assert set(many.counts.tolist()) == {15}


@pytest.mark.parametrize("generator", GENERATORS)
def test_scenes_do_not_share_objects(generator: Generator) -> None:
    scenes, _ = generator(np.random.default_rng(0), 50)
    np.testing.assert_array_equal(scenes.rows, np.arange(len(scenes.matrix)))
    assert scenes.counts.sum() == len(scenes.matrix)
    assert np.isfinite(scenes.matrix).all()


@pytest.mark.parametrize("generator", GENERATORS)
def test_the_same_generator_state_gives_the_same_scenes(generator: Generator) -> None:
    first, second = (generator(np.random.default_rng(5), 30) for _ in range(2))
    np.testing.assert_array_equal(first[0].matrix, second[0].matrix)
    np.testing.assert_array_equal(first[1], second[1])


def test_between_arguments_are_two_objects_of_the_scene() -> None:
    scenes, _ = between_scenes(np.random.default_rng(0), 50)
    assert scenes.schema.parameters == ("A", "B")
    for scene in range(len(scenes)):
        assert set(scenes.arguments[scene]) <= set(scenes.objects(scene))
        assert len(set(scenes.arguments[scene])) == 2


def test_locations_fill_their_square_evenly() -> None:
    # Uniform on [0, 10]: mean 5, variance 100 / 12 = 8.33. The arguments of balanced scenes lie further apart
    # than that, because a long axis has more room between; the colors of yellow_scenes say nothing about
    # locations.
    scenes, _ = yellow_scenes(np.random.default_rng(0), 4000)
    location = scenes.values["location"]
    np.testing.assert_allclose(location.mean(axis=0), 5, atol=0.1)
    np.testing.assert_allclose(location.var(axis=0), 100 / 12, atol=0.2)
    between, _ = between_scenes(np.random.default_rng(0), 4000, n_distractors=5)
    assert between.matrix.min() >= 0
    assert between.matrix.max() <= 10


def test_distractors_are_added_to_the_other_objects() -> None:
    scenes, _ = between_scenes(np.random.default_rng(0), 100, n_objects=(5, 8), n_distractors=20)
    assert sorted(set(scenes.counts.tolist())) == [25, 26, 27, 28]


@pytest.mark.parametrize(
    ("generator", "options", "message"),
    [
        (between_scenes, {"n_objects": 2}, "n_objects must be an integer of at least 3"),
        (between_scenes, {"n_objects": (8, 5)}, "the largest n_objects must be an integer of at least 8"),
        (between_scenes, {"n_distractors": -1}, "n_distractors must be an integer of at least 0"),
        (figure41_scenes, {"n_objects": 0}, "n_objects must be an integer of at least 1"),
        (yellow_scenes, {"n_objects": 0}, "n_objects must be an integer of at least 1"),
        (yellow_scenes, {"n_scenes": 1}, "n_scenes must be an integer of at least 2"),
    ],
)
def test_bad_numbers_are_refused(generator: Generator, options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        generator(np.random.default_rng(0), **options)


def test_scenes_that_are_hardly_ever_negative_are_refused() -> None:
    with pytest.raises(
        InputError, match="too few of 2000 drawn scenes are negative: choose another n_objects"
    ):
        yellow_scenes(np.random.default_rng(0), 2, n_objects=300)
