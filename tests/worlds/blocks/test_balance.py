from __future__ import annotations

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.balance import balance_scale_scenes, balance_trial, place_weights, tips_left


@pytest.mark.parametrize(
    ("x", "outcome"),
    [
        ([-6.0], True),
        ([6.0], False),
        # Above the post, which is 2 wide.
        ([0.5], None),
        # The centre of mass, weights of 16 and a beam of 10 together, lies beyond the post's edge at 1 either
        # way: 16 * (-5) / 58 = -1.4 and 16 * 5 / 58 = 1.4. So moments count, not the number of weights.
        ([-7.0, -7.0, 9.0], True),
        ([-2.0, -2.0, 9.0], False),
        # 16 * 1 / 58 = 0.3.
        ([-4.0, -4.0, 9.0], None),
        ([-6.0, 6.0], None),
    ],
)
def test_the_end_with_the_larger_moment_goes_down(x: list[float], outcome: object) -> None:
    # Of those at the same place, the second stands on the first.
    levels = [x[:place].count(own) for place, own in enumerate(x)]
    positions = np.array([(own, 12.5 + 4 * level) for own, level in zip(x, levels, strict=True)])

    assert tips_left(positions) is outcome


def test_weights_stand_on_the_beam_or_on_each_other() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        positions = place_weights(rng, 6)
        base = positions[:, 1] == 12.5

        assert base[0]
        assert (np.abs(positions[base, 0]) <= 9.5).all()
        # Tops of the beam at 10.5, weights of height 4.
        assert set(((positions[:, 1] - 12.5) / 4).tolist()) <= {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}
        gaps = np.diff(np.sort(positions[base, 0]))
        assert (gaps > 4).all()
        for x, y in positions[~base]:
            below = positions[positions[:, 1] == y - 4]
            assert np.abs(below[:, 0] - x).min() <= 4


def test_scenes_are_labelled_as_moments_say() -> None:
    scenes, labels = balance_scale_scenes(np.random.default_rng(1), 40)

    assert set(scenes.counts.tolist()) == {1, 2, 3, 4}
    assert scenes.schema.parameters == ()
    np.testing.assert_array_equal(scenes.values["extent"], 2.0)
    np.testing.assert_array_equal(scenes.values["orientation"], 0.0)
    assert np.isfinite(scenes.matrix).all()
    moments = [scenes.values["location"][scenes.objects(i), 0].sum() for i in range(len(scenes))]
    # All weights are alike, so their mean position decides, but for those that fall before the beam tilts.
    assert np.mean((np.array(moments) < 0) == labels) > 0.9
    assert 0.2 < labels.mean() < 0.8


def test_large_scenes_have_more_weights() -> None:
    scenes, _ = balance_scale_scenes(np.random.default_rng(2), 10, n_weights=(5, 6))

    assert set(scenes.counts.tolist()) <= {5, 6}


def test_equal_seeds_give_equal_scenes() -> None:
    one, other = (balance_scale_scenes(np.random.default_rng(3), 5) for _ in range(2))

    np.testing.assert_array_equal(one[0].matrix, other[0].matrix)
    np.testing.assert_array_equal(one[1], other[1])


def test_a_level_beam_is_undecided() -> None:
    outcomes = {balance_trial(np.random.default_rng(seed), (1, 2)).outcome for seed in range(40)}

    assert outcomes == {True, False, None}


@pytest.mark.parametrize(
    ("n", "n_weights", "message"),
    [
        (0, (1, 4), "n must be an integer from 1 to 100000, got 0"),
        (100_001, (1, 4), "n must be an integer from 1 to 100000, got 100001"),
        (5, (1, 21), "largest of n_weights must be an integer from 1 to 20, got 21"),
        (5, (99_999, 99_999), "smallest of n_weights must be an integer from 1 to 20"),
        (5, (1.0, 4), "smallest of n_weights must be"),
        (5, (0, 4), "smallest of n_weights must be"),
        (5, (4, 1), "largest of n_weights must be"),
        (5, np.array(3), r"n_weights must be a pair \(smallest, largest\), got array\(3\)"),
        (5, 4, r"n_weights must be a pair \(smallest, largest\), got 4"),
    ],
)
def test_bad_input_is_named(n: int, n_weights: tuple[int, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        balance_scale_scenes(np.random.default_rng(0), n, n_weights=n_weights)
