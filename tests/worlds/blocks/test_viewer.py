from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.blocks.viewer import HEIGHT, WIDTH, BlocksViewer

Picture = NDArray[np.uint8]

RED, BLUE, TOOL = (255, 0, 0), (0, 0, 255), (178, 60, 120)
COLORS = np.array([RED, BLUE]) / 255
# A red block of 8 by 4 on the table, a blue one of 4 by 4 on its right.
SIDES = np.array([[4.0, 2.0], [2.0, 2.0]])
POSES = np.array([[-10.0, 2.0, 0.0], [10.0, 2.0, 0.0]])
SCALE = WIDTH / 80


def colored(picture: Picture, color: tuple[int, int, int]) -> NDArray[np.float64]:
    """Return the pixels (column, row) of a colour."""
    rows, columns = np.nonzero((picture == color).all(axis=2))
    return np.stack([columns, rows], axis=1).astype(np.float64)


def middle(picture: Picture, color: tuple[int, int, int]) -> NDArray[np.float64]:
    pixels = colored(picture, color)
    found: NDArray[np.float64] = (pixels.min(axis=0) + pixels.max(axis=0)) / 2
    return found


def extent(picture: Picture, color: tuple[int, int, int]) -> NDArray[np.float64]:
    """Return width and height of what has a colour, in world units at the usual scale, rims included."""
    found: NDArray[np.float64] = (np.ptp(colored(picture, color), axis=0) + 1 + 3.5) / SCALE
    return found


@pytest.mark.parametrize("n", [0, 1, 2])
def test_pictures_have_the_form_that_gymnasium_wants(n: int) -> None:
    viewer = BlocksViewer()
    picture = viewer.draw(
        SIDES[:n], POSES[:n], COLORS[:n], ids=range(n), caption="put(1, 2)", time=1.5, score="mean height 2"
    )

    assert picture.dtype == np.uint8
    assert picture.shape == (*viewer.shape, 3) == (HEIGHT, WIDTH, 3)
    assert HEIGHT % 2 == WIDTH % 2 == 0


def test_blocks_are_drawn_to_scale_with_y_pointing_up() -> None:
    poses = POSES + np.array([[0.0, 0.0, 0.0], [0.0, 20.0, 0.0]])
    picture = BlocksViewer().draw(SIDES, poses, COLORS)

    assert extent(picture, RED) == pytest.approx([8.0, 4.0], abs=0.25)
    assert extent(picture, BLUE) == pytest.approx([4.0, 4.0], abs=0.25)
    assert middle(picture, BLUE) - middle(picture, RED) == pytest.approx([20 * SCALE, -20 * SCALE], abs=1.5)
    assert middle(picture, RED)[0] == pytest.approx(WIDTH / 2 - 10 * SCALE, abs=1.0)


def test_blocks_turn_counter_clockwise() -> None:
    poses = POSES.copy()
    poses[0, 2] = np.pi / 2
    assert extent(BlocksViewer().draw(SIDES, poses, COLORS), RED) == pytest.approx([4.0, 8.0], abs=0.25)

    poses[0] = [-10.0, 10.0, 0.5]
    pixels = colored(BlocksViewer().draw(SIDES, poses, COLORS), RED)
    center = (pixels.min(axis=0) + pixels.max(axis=0)) / 2
    # Its right end is higher: pixels on the right have smaller rows.
    assert ((pixels - center).prod(axis=1)).mean() < -50


def test_equal_states_give_equal_pictures_and_others_different_ones() -> None:
    told: dict[str, Any] = {"ids": [1, 2], "caption": "drop", "time": 3.0}
    viewer = BlocksViewer()
    picture = viewer.draw(SIDES, POSES, COLORS, **told)

    np.testing.assert_array_equal(picture, viewer.draw(SIDES, POSES, COLORS, **told))
    told_as_array = {**told, "ids": np.array([1, 2])}
    np.testing.assert_array_equal(picture, viewer.draw(SIDES, POSES, COLORS, **told_as_array))
    assert (picture != viewer.draw(SIDES, POSES + 0.1, COLORS, **told)).any()
    for change in ({"ids": [1, 3]}, {"caption": "done"}, {"time": 3.1}, {"score": "1"}):
        assert (picture != viewer.draw(SIDES, POSES, COLORS, **{**told, **change})).any()


@pytest.mark.parametrize("place", [(-95.0, 2.0), (95.0, 2.0), (10.0, 90.0), (-60.0, 60.0)])
def test_all_blocks_are_in_view(place: tuple[float, float]) -> None:
    poses = POSES.copy()
    poses[1, :2] = place
    picture = BlocksViewer().draw(SIDES, poses, COLORS)
    seen = {color: colored(picture, color) for color in (RED, BLUE)}

    wide, high = (np.ptp(seen[RED], axis=0) + 1 + 3.5) / [8.0, 4.0]
    assert wide == pytest.approx(high, rel=0.1)
    # The blue square is whole: as wide as half of the red block, and not at the edge.
    assert np.ptp(seen[BLUE], axis=0) + 4.5 == pytest.approx([4 * wide, 4 * wide], abs=1.5)
    assert seen[BLUE].min() > 0
    assert seen[BLUE][:, 0].max() < WIDTH - 1


def test_the_view_moves_smoothly() -> None:
    viewer, columns = BlocksViewer(), []
    for x in np.linspace(20.0, 60.0, 41):
        poses = POSES.copy()
        poses[1, 0] = x
        columns.append(middle(viewer.draw(SIDES, poses, COLORS), RED))

    assert np.abs(np.diff(np.array(columns), axis=0)).max() < 5.0


def test_a_block_lost_far_away_does_not_shrink_the_others() -> None:
    poses = POSES.copy()
    poses[1] = [1e7, -1e7, 0.0]
    picture = BlocksViewer().draw(SIDES, poses, COLORS)

    assert np.ptp(colored(picture, RED)[:, 0]) > 15
    assert len(colored(picture, BLUE)) == 0


def test_the_table_has_ends() -> None:
    poses = POSES.copy()
    poses[:, 0] = [-30.0, 30.0]
    narrow = BlocksViewer(table=20.0).draw(SIDES, poses, COLORS)
    wood = colored(narrow, (214, 200, 178))

    assert np.ptp(wood[:, 0]) == pytest.approx(40 * SCALE, abs=2.0)


def test_the_tool_is_a_ring_around_the_grasp() -> None:
    assert len(colored(BlocksViewer().draw(SIDES, POSES, COLORS), TOOL)) == 0

    picture = BlocksViewer().draw(SIDES, POSES, COLORS, tool=(0.0, 20.0))
    assert middle(picture, TOOL)[0] == pytest.approx(WIDTH / 2, abs=1.0)
    assert middle(picture, TOOL)[1] == pytest.approx(middle(picture, RED)[1] - 18 * SCALE, abs=1.5)


def test_ids_are_readable_on_any_colour_and_size() -> None:
    for shade in (0.0, 0.4, 1.0):
        for side in (0.5, 5.0):
            colors = np.full((1, 3), shade)
            sides, poses = np.full((1, 2), side), np.array([[0.0, side, 0.4]])
            plain = BlocksViewer().draw(sides, poses, colors).astype(int)
            named = BlocksViewer().draw(sides, poses, colors, ids=[128]).astype(int)
            changed = np.abs(named - plain).max(axis=2)

            assert (changed > 100).sum() > 15


def test_a_score_without_a_caption_takes_its_line() -> None:
    both = BlocksViewer().draw(SIDES, POSES, COLORS, caption="drop", score="arch 40.7")
    alone = BlocksViewer().draw(SIDES, POSES, COLORS, score="arch 40.7")
    rows = [np.nonzero((picture[:80, :200] < 200).any(axis=(1, 2)))[0] for picture in (both, alone)]

    assert rows[0].max() > rows[1].max()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"half_extents": SIDES[:, :1]}, r"half_extents must contain finite numbers in shape \(2, 2\)"),
        ({"poses": POSES[:1]}, r"poses must contain finite numbers in shape \(2, 3\), got \(1, 3\)"),
        ({"poses": POSES * np.nan}, "poses must contain finite numbers"),
        ({"colors": COLORS[:, :2]}, r"colors must contain finite numbers in shape \(2, 3\)"),
        ({"ids": [1]}, "ids must name all 2 blocks, got 1"),
        ({"tool": [1.0]}, "tool must be two finite numbers"),
    ],
)
def test_wrong_shapes_and_numbers_are_refused(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"half_extents": SIDES, "poses": POSES, "colors": COLORS, **change}
    with pytest.raises(InputError, match=message):
        BlocksViewer().draw(**arguments)  # type: ignore[arg-type]


def test_a_table_must_have_a_width() -> None:
    with pytest.raises(InputError, match="table"):
        BlocksViewer(table=0.0)
