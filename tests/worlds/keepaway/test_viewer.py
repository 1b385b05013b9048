from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.keepaway.viewer import LONGEST, KeepawayViewer

Picture = NDArray[np.uint8]

KEEPER, TAKER, CHOICE, PAPER = (240, 180, 20), (86, 180, 233), (178, 60, 120), (250, 249, 246)
# Far apart, none where the decision is written.
PLAYERS = np.array([[-6.0, -6.0, 0, 0, 0], [6.0, -6.0, 0, 0, 90], [0.0, 5.0, 0, 0, 180], [8.0, 8.0, 0, 0, 0]])
BALL = np.array([-3.0, -3.0, 0, 0])
SCALE = LONGEST / 20.0


@pytest.fixture
def viewer() -> KeepawayViewer:
    return KeepawayViewer(keepers=3, takers=1, length=20.0, width=20.0)


def colored(picture: Picture, color: tuple[int, int, int]) -> NDArray[np.float64]:
    """Return the pixels (column, row) of a colour."""
    rows, columns = np.nonzero((picture == color).all(axis=2))
    return np.stack([columns, rows], axis=1).astype(np.float64)


def below(picture: Picture) -> Picture:
    """Return the part under the field."""
    return picture[round(LONGEST + 64) :]


@pytest.mark.parametrize(
    ("keepers", "takers", "length", "width"),
    [(2, 1, 20.0, 20.0), (4, 3, 25.0, 25.0), (6, 5, 60.0, 20.0), (3, 2, 8.0, 1000.0), (32, 32, 8.0, 8.0)],
)
def test_pictures_have_the_form_that_gymnasium_wants(
    keepers: int, takers: int, length: float, width: float
) -> None:
    viewer = KeepawayViewer(keepers=keepers, takers=takers, length=length, width=width)
    picture = viewer.draw(
        np.zeros((keepers + takers, 5)), np.zeros(4), actor=0, values=np.ones(keepers), time=7
    )

    assert picture.dtype == np.uint8
    assert picture.shape == (*viewer.shape, 3)
    assert picture.shape[0] % 2 == picture.shape[1] % 2 == 0


def test_players_are_drawn_to_scale_with_y_pointing_down(viewer: KeepawayViewer) -> None:
    players = PLAYERS.copy()
    players[:, :2] = [[-5, -5], [-5, -5], [-5, -5], [5, 5]]
    picture = viewer.draw(players, BALL)
    taker, keepers = colored(picture, TAKER).mean(axis=0), colored(picture, KEEPER).mean(axis=0)

    assert taker - keepers == pytest.approx([10 * SCALE, 10 * SCALE], abs=1.5)
    assert taker == pytest.approx([32 + 15 * SCALE, 32 + 15 * SCALE], abs=1.0)


@pytest.mark.parametrize("body", [0.0, 90.0, 180.0, -45.0])
def test_a_player_points_where_it_faces(viewer: KeepawayViewer, body: float) -> None:
    players = PLAYERS.copy()
    players[3, 4] = body
    picture = viewer.draw(players, BALL).astype(int)
    column = 32 + 18 * SCALE + 15 * math.cos(math.radians(body))
    row = 32 + 18 * SCALE + 15 * math.sin(math.radians(body))

    assert picture[int(row), int(column)].sum() < 200
    behind = picture[int(2 * (32 + 18 * SCALE) - row), int(2 * (32 + 18 * SCALE) - column)]
    assert behind.sum() > 550


def test_equal_states_give_equal_pictures_and_others_different_ones(viewer: KeepawayViewer) -> None:
    picture = viewer.draw(PLAYERS, BALL, actor=0, time=3)
    turned = PLAYERS.copy()
    turned[2, 4] = 30.0

    np.testing.assert_array_equal(picture, viewer.draw(PLAYERS, BALL, actor=0, time=3))
    assert (picture != viewer.draw(PLAYERS, BALL + 0.2, actor=0, time=3)).any()
    assert (picture != viewer.draw(turned, BALL, actor=0, time=3)).any()
    assert (picture != viewer.draw(PLAYERS, BALL, actor=0, time=4)).any()


def test_the_ring_of_a_decision_is_the_kick_range(viewer: KeepawayViewer) -> None:
    assert len(colored(viewer.draw(PLAYERS, BALL), CHOICE)) == 0

    ring = colored(viewer.draw(PLAYERS, BALL, actor=1), CHOICE) + 0.5
    away = np.hypot(*(ring - [32 + 16 * SCALE, 32 + 4 * SCALE]).T)
    assert away == pytest.approx(np.full(len(away), 1.085 * SCALE), abs=1.5)


def test_a_pass_is_an_arrow_to_its_receiver(viewer: KeepawayViewer) -> None:
    held = colored(viewer.draw(PLAYERS, BALL, actor=0, action=0)[: LONGEST + 60], CHOICE)
    near = colored(viewer.draw(PLAYERS, BALL, actor=0, action=1)[: LONGEST + 60], CHOICE)
    told = colored(viewer.draw(PLAYERS, BALL, actor=0, action=1, receivers=[2, 1])[: LONGEST + 60], CHOICE)

    # Keeper 1 is 12 m away, keeper 2 is 12.53 m away; 29 m of pixels lie left of keeper 1.
    assert len(held) < len(near)
    assert near[:, 0].max() > 32 + 15 * SCALE
    assert near[:, 1].max() < 32 + 6 * SCALE
    assert told[:, 1].max() > 32 + 14 * SCALE


def test_bars_are_as_long_as_values(viewer: KeepawayViewer) -> None:
    picture = viewer.draw(PLAYERS, BALL, actor=0, action=2, values=[5.0, np.nan, 10.0])
    bars = below(picture)[20:28]
    chosen = colored(bars, CHOICE)[:, 0]
    grey = colored(bars, (115, 115, 115))[:, 0]

    # The best value fills its bar; half of it fills half of a bar; nothing is known of the other.
    assert np.ptp(grey) == pytest.approx(np.ptp(chosen) / 2, abs=2.0)
    assert (np.abs(grey - 32) < np.ptp(chosen)).all()


def test_negative_values_are_told_apart(viewer: KeepawayViewer) -> None:
    bars = below(viewer.draw(PLAYERS, BALL, actor=0, values=[-3.0, -1.0, -2.0]))[20:28]
    columns = colored(bars, (115, 115, 115))[:, 0]
    lengths = [np.ptp(columns[(columns > low) & (columns < low + 180)]) for low in (25, 220, 410)]

    assert 0 < lengths[0] < lengths[2] < lengths[1]


def test_without_a_decision_nothing_is_written_below(viewer: KeepawayViewer) -> None:
    assert (below(viewer.draw(PLAYERS, BALL)) == PAPER).all()
    assert (below(viewer.draw(PLAYERS, BALL, actor=0)) != PAPER).any()


def test_trails_show_where_everything_was(viewer: KeepawayViewer) -> None:
    plain = viewer.draw(PLAYERS, BALL)
    places = np.concatenate([PLAYERS[:, :2], BALL[None, :2]])
    trail = np.array([places - (0.0, 4.0), places - (0.0, 2.0), places])
    changed = np.nonzero((viewer.draw(PLAYERS, BALL, trail=trail) != plain).any(axis=2))

    # The ball was at x = -3 m and y = -5 m, the taker at x = 8 m, y = 6 m.
    for x, y in ((-3, -5), (8, 6)):
        near = np.hypot(changed[1] - (32 + (10 + x) * SCALE), changed[0] - (32 + (10 + y) * SCALE))
        assert near.min() < 2.0
    np.testing.assert_array_equal(viewer.draw(PLAYERS, BALL, trail=trail[:1]), plain)
    np.testing.assert_array_equal(viewer.draw(PLAYERS, BALL, trail=trail[:0]), plain)


def test_what_is_far_outside_stays_in_the_picture(viewer: KeepawayViewer) -> None:
    players = PLAYERS.copy()
    players[3, :2] = 1e6, -1e6
    taker = colored(viewer.draw(players, BALL - 1e6), TAKER).mean(axis=0)

    assert taker == pytest.approx([viewer.shape[1] - 11, 11], abs=1.5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"players": PLAYERS[:3]}, r"players must contain finite numbers in shape \(4, 5\), got \(3, 5\)"),
        ({"players": PLAYERS * np.nan}, "players must contain finite numbers"),
        ({"ball": BALL[:2]}, r"ball must contain finite numbers in shape \(4,\)"),
        ({"actor": 3}, "from -1 to 2, got 3 and -1"),
        ({"actor": 0, "action": 3}, "from -1 to 2, got 0 and 3"),
        ({"actor": 0, "values": [1.0, 2.0]}, r"values must have the shape \(3,\), got \(2,\)"),
        ({"actor": 0, "receivers": [0, 1]}, r"receivers must be the teammates \[1, 2\] of 0, got \[0, 1\]"),
        ({"trail": np.zeros((5, 4, 2))}, r"trail must have the shape \(times, 5, 2\), got \(5, 4, 2\)"),
    ],
)
def test_wrong_shapes_and_numbers_are_refused(
    viewer: KeepawayViewer, change: dict[str, object], message: str
) -> None:
    arguments: dict[str, object] = {"players": PLAYERS, "ball": BALL, **change}
    with pytest.raises(InputError, match=message):
        viewer.draw(**arguments)  # type: ignore[arg-type]
