from __future__ import annotations

import colorsys
from typing import Any

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.worlds.blocks.blocks import ARCH_HALF_EXTENTS, Block, arch_blocks, random_blocks


def test_random_blocks_have_all_sizes() -> None:
    blocks = random_blocks(np.random.default_rng(0), 4000)
    halves = np.array([block.half_extents for block in blocks])

    assert halves.min() >= 0.5
    assert halves.max() <= 5.0
    # Uniform on [0.5, 5]: mean 2.75, and standard deviation 4.5 / sqrt(12) = 1.299.
    assert halves.mean(axis=0) == pytest.approx([2.75, 2.75], abs=0.08)
    assert halves.std(axis=0) == pytest.approx([1.299, 1.299], abs=0.05)
    assert abs(np.corrcoef(halves.T)[0, 1]) < 0.05


def test_colors_are_uniform_in_hue_saturation_and_brightness() -> None:
    blocks = random_blocks(np.random.default_rng(1), 4000)
    parts = np.array([colorsys.rgb_to_hsv(*block.color) for block in blocks])

    # The mean of each is 1/2; quantisation makes the hue of very dark blocks meaningless.
    assert parts[:, 1:].mean(axis=0) == pytest.approx([0.5, 0.5], abs=0.03)
    assert parts[parts[:, 2] > 0.2, 0].mean() == pytest.approx(0.5, abs=0.03)


def test_colors_have_8_bits() -> None:
    colors = 255 * np.array([block.color for block in random_blocks(np.random.default_rng(2), 200)])

    assert colors == pytest.approx(colors.round(), abs=1e-9)


def test_blocks_of_the_arch_task_are_equal_but_for_their_colors() -> None:
    blocks = arch_blocks(np.random.default_rng(0))

    assert [block.half_extents for block in blocks] == [ARCH_HALF_EXTENTS] * 3
    assert len({block.color for block in blocks}) == 3


@pytest.mark.parametrize("draw", [random_blocks, arch_blocks])
def test_blocks_are_numbered_and_repeatable(draw: Any) -> None:
    blocks = draw(np.random.default_rng(5), 4, first_id=17)

    assert [block.id for block in blocks] == [17, 18, 19, 20]
    assert blocks == draw(np.random.default_rng(5), 4, first_id=17)
    assert draw(np.random.default_rng(5), 0) == ()


@pytest.mark.parametrize("draw", [random_blocks, arch_blocks])
@pytest.mark.parametrize(("n", "first_id"), [(-1, 0), (2.5, 0), (True, 0), (2, -1)])
def test_numbers_of_blocks_are_checked(draw: Any, n: Any, first_id: Any) -> None:
    with pytest.raises(InputError, match="must be an integer"):
        draw(np.random.default_rng(0), n, first_id=first_id)


@pytest.mark.parametrize(
    ("half_extents", "color", "message"),
    [
        ((1.0,), (0.0, 0.0, 0.0), "half_extents of a block must be 2 numbers"),
        (3.0, (0.0, 0.0, 0.0), "half_extents of a block must be 2 numbers, got 3.0"),
        ((1.0, 2.0), (0.0, 0.0), "color of a block must be 3 numbers"),
        ((1.0, 2.0), None, "color of a block must be 3 numbers, got None"),
        ((1.0, 0.0), (0.0, 0.0, 0.0), "half_extents must be"),
        ((1.0, float("nan")), (0.0, 0.0, 0.0), "half_extents must be"),
        ((float("inf"), 1.0), (0.0, 0.0, 0.0), "half_extents must be"),
        ((1.0, 2.0), (0.0, 0.0, 1.5), "color"),
        ((1.0, 2.0), (float("nan"), 0.0, 0.5), "color"),
        ((1.0, "wide"), (0.0, 0.0, 0.5), "half_extents must be"),
    ],
)
def test_blocks_are_checked(half_extents: Any, color: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Block(0, half_extents, color)


def test_blocks_hold_plain_numbers() -> None:
    halves = np.array([1, 2], dtype=np.float32)
    number: Any = np.int64(3)
    block = Block(number, (halves[0], halves[1]), (0, 1, 0))

    assert block == Block(3, (1.0, 2.0), (0.0, 1.0, 0.0))
    assert type(block.id) is int
    assert type(block.half_extents[0]) is float


@pytest.mark.parametrize("draw", [random_blocks, arch_blocks])
def test_what_is_drawn_is_checked(draw: Any) -> None:
    with pytest.raises(InputError, match="n must be an integer from 0 to 100000, got 100001"):
        draw(np.random.default_rng(0), 100_001)
    with pytest.raises(InputError, match=r"rng must be a numpy Generator, such as .*default_rng\(0\), got 0"):
        draw(0, 3)
    with pytest.raises(InputError, match="first_id must be an integer from 0 to"):
        draw(np.random.default_rng(0), 3, first_id=2**63)
