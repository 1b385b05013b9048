from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.drop_on import HALF_SIDE, drop_on_scenes, drop_on_trial, rests_over
from relforest.worlds.blocks.engine import Engine


def settled(*boxes: tuple[float, float, float]) -> Engine:
    """Return a lying support of half length 4 at 0, and boxes dropped at x, y and with an angle."""
    engine = Engine(table_half_width=20.0)
    engine.add_box((4.0, 1.0), (0.0, 1.0))
    for x, y, angle in boxes:
        engine.add_box((HALF_SIDE, HALF_SIDE), (x, y), angle)
        engine.settle(1000)
    return engine


def test_a_block_on_the_support_rests_over_it() -> None:
    assert rests_over(settled((2.0, 5.0, 0.0)), 1, 0)


def test_a_block_beside_the_support_does_not() -> None:
    assert not rests_over(settled((8.0, 5.0, 0.0)), 1, 0)


def test_others_may_lie_between() -> None:
    engine = settled((0.0, 4.0, 0.0), (0.1, 8.0, 0.0))

    assert engine.pose(2)[1] > engine.pose(1)[1] + 1.9
    assert rests_over(engine, 2, 0)


def test_a_block_that_fell_off_the_table_rests_nowhere() -> None:
    engine = settled((25.0, 5.0, 0.0))

    assert engine.keys == (0,)
    assert not rests_over(engine, 1, 0)
    assert not rests_over(engine, 0, 1)


def test_the_scene_is_the_moment_of_the_drop() -> None:
    scenes, labels = drop_on_scenes(np.random.default_rng(0), 30)

    assert scenes.schema.parameters == ("A", "B")
    assert 2 <= scenes.counts.min() <= scenes.counts.max() <= 5
    assert np.isfinite(scenes.matrix).all()
    assert 0.05 < labels.mean() < 0.8
    location, extent = scenes.values["location"], scenes.values["extent"]
    orientation = scenes.values["orientation"][:, 0]
    dropped, support = scenes.arguments.T
    np.testing.assert_array_equal(extent[dropped], HALF_SIDE)
    assert ((extent[support, 0] >= 1.5) & (extent[support, 0] <= 5.5)).all()
    lying = np.abs(orientation[support]) < 0.5
    assert 0 < lying.sum() < len(scenes)
    # The support's top is at 2 if it lies and at twice its half length if it stands, and A 9.5 to 13.5 above.
    top = np.where(lying, 2.0, 2 * extent[support, 0])
    assert (np.abs(location[dropped, 1] - top - 11.5) < 2.1).all()
    for i in range(len(scenes)):
        others = np.setdiff1d(scenes.objects(i), scenes.arguments[i])
        assert (location[others, 1] < 12).all()


def test_blocks_dropped_far_from_the_support_fail() -> None:
    scenes, labels = drop_on_scenes(np.random.default_rng(1), 40)
    dropped, support = scenes.arguments.T
    offset = np.abs(scenes.values["location"][dropped, 0] - scenes.values["location"][support, 0])

    assert not labels[offset > 8.0].any()
    assert labels[offset < 1.0].mean() > labels.mean()


def test_large_scenes_have_more_interferers() -> None:
    scenes, _ = drop_on_scenes(np.random.default_rng(2), 5, n_interferers=[4, 5])

    assert scenes.counts.max() in (6, 7)


def test_equal_seeds_give_equal_scenes() -> None:
    one, other = (drop_on_scenes(np.random.default_rng(3), 3) for _ in range(2))

    np.testing.assert_array_equal(one[0].matrix, other[0].matrix)
    np.testing.assert_array_equal(one[1], other[1])


def test_angles_of_dropped_blocks_are_those_of_squares() -> None:
    trials = [drop_on_trial(np.random.default_rng(seed), (0, 0)) for seed in range(60)]
    turns = np.array([trial.objects[1, 4] for trial in trials])

    # A normal angle of sd 90 degrees, doubled and wrapped, goes all the way round.
    assert (turns > 2.0).any()
    assert (turns < -2.0).any()
    assert (np.abs(turns) <= math.pi).all()


@pytest.mark.parametrize(
    ("n", "n_interferers", "message"),
    [
        (-1, (0, 3), "n must be an integer from 1 to 100000, got -1"),
        (5, (0, 21), "largest of n_interferers must be an integer from 0 to 20, got 21"),
        (5, (-1, 3), "smallest of n_interferers must be"),
        (5, (3, 2), "largest of n_interferers must be"),
        (5, 3, r"n_interferers must be a pair \(smallest, largest\)"),
    ],
)
def test_bad_input_is_named(n: int, n_interferers: tuple[int, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        drop_on_scenes(np.random.default_rng(0), n, n_interferers=n_interferers)
