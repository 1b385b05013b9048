from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.playing.frames import Frame
from relforest.playing.painter import paint
from relforest.playing.recorder import Recording, record_episodes
from relforest.playing.shapes import Circle, Line, Text, plain
from relforest.worlds.keepaway.decisions.scene import NOBODY
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.frames import game_frame, game_stage
from relforest.worlds.keepaway.play.batch import Batch
from relforest.worlds.keepaway.server.layout import DASH, END, KICK, OUT, TURN
from relforest.worlds.keepaway.server.options import KeepawayOptions

SETUP = KeepawayOptions().setup()


@pytest.fixture
def batch() -> Batch:
    """Players who stand about: keepers 0 to 2, takers 3 and 4; the ball is in front of keeper 0."""
    made = Batch(SETUP, 1)
    places = [(-5.0, 4.0), (6.0, 4.0), (5.0, -7.0), (0.0, 0.0), (1.0, 2.0)]
    made.games.players[0, :, :2] = places
    made.games.players[0, :, 4] = [0.0, 90.0, -90.0, 30.0, 180.0]
    made.games.ball[0, :2] = (-4.0, 4.0)
    return made


def thing(frame: Frame, key: str) -> Any:
    return next(thing for thing in frame.things if thing.key == key)


def rings(frame: Frame) -> list[str]:
    return [
        thing.key
        for thing in frame.things
        for shape in thing.shapes
        if isinstance(shape, Circle) and shape.edge == "choice"
    ]


def test_players_stand_where_they_are_with_y_pointing_down(batch: Batch) -> None:
    frame = game_frame(batch, 0)

    assert [thing(frame, f"player {i}")[2:4] for i in (0, 3)] == [(-5.0, -4.0), (0.0, 0.0)]
    assert [thing(frame, f"player {i}").angle for i in (0, 1, 2)] == pytest.approx([0, -np.pi / 2, np.pi / 2])
    assert (thing(frame, "ball").x, thing(frame, "ball").y) == (-4.0, -4.0)
    names = [
        [shape.words for shape in thing(frame, f"player {i}").shapes if isinstance(shape, Text)]
        for i in range(5)
    ]
    assert names == [["1"], ["2"], ["3"], [], []]
    # The ball is in reach of keeper 0, less than 1.085 m away.
    assert frame.band == "keeper"


def test_the_band_tells_who_can_kick(batch: Batch) -> None:
    batch.games.ball[0, :2] = (-3.0, 4.0)
    assert game_frame(batch, 0).band == ""
    batch.games.players[0, 4, :2] = (-3.0, 5.0)
    assert game_frame(batch, 0).band == "taker"


def test_a_ring_marks_who_decides_and_an_arrow_a_pass(batch: Batch) -> None:
    assert rings(game_frame(batch, 0)) == []
    held = game_frame(batch, 0, (1, NOBODY))
    passed = game_frame(batch, 0, (1, 2))
    batch.seen.actors[0] = 0
    asked = game_frame(batch, 0, (1, 2))
    (arrow,) = passed.notes

    assert (rings(held), held.notes) == (["player 1"], ())
    assert rings(passed) == ["player 1"]
    assert isinstance(arrow, Line)
    assert arrow.arrow
    # Between the players, from beside one to beside the other.
    for point, place in zip(arrow.points, ((6.0, -4.0), (5.0, 7.0)), strict=True):
        assert 0.3 < np.hypot(point[0] - place[0], point[1] - place[1]) < 0.7
    assert (rings(asked), asked.notes) == (["player 0"], ())
    batch.games.players[0, 2, :2] = (6.0, 4.5)
    assert game_frame(batch, 0, (1, 2)).notes == ()


def test_what_is_far_outside_is_drawn_at_the_edge(batch: Batch) -> None:
    batch.games.ball[0, :2] = (1e6, -1e6)
    stage, ball = game_stage(SETUP), thing(game_frame(batch, 0), "ball")

    assert 0 < stage.view[1] - ball.x < 1
    assert 0 < stage.view[3] - ball.y < 1


def test_the_end_is_told(batch: Batch) -> None:
    assert game_frame(batch, 0).caption == ""
    batch.games.counters[0, END] = OUT
    batch.seen.actors[0] = 1
    frame = game_frame(batch, 0)
    assert (frame.caption, rings(frame)) == ("the ball went out", [])


def test_the_details_are_the_commands(batch: Batch) -> None:
    batch.games.commands[0, :4] = [(KICK, 67, -23), (DASH, 100, 0), (TURN, -9, 0), (0, 0, 0)]
    lines = [plain(words) for words in game_frame(batch, 0).details]

    assert lines == [
        "1 kicks with power 67, direction \N{MINUS SIGN}23\N{DEGREE SIGN}",
        "2 dashes with power 100",
        "3 turns by \N{MINUS SIGN}9\N{DEGREE SIGN}",
        "1 does nothing",
        "2 does nothing",
    ]


@pytest.mark.parametrize(("keepers", "takers", "size"), [(2, 1, 8.0), (3, 2, (100.0, 8.0)), (20, 5, (8, 90))])
def test_games_of_any_form_can_be_drawn(keepers: int, takers: int, size: Any) -> None:
    setup = KeepawayOptions(keepers, takers, size).setup()
    picture = paint(game_stage(setup), game_frame(Batch(setup, 1), 0))

    assert max(picture.shape) <= 624 + 32
    assert min(picture.shape[:2]) > 150


def recorded(env: KeepawayEnv, policy: str, seed: int = 5) -> Recording:
    return record_episodes(env, env.policies[policy], seed=seed)[0]


def test_every_cycle_is_recorded() -> None:
    env = KeepawayEnv(max_cycles=25)
    episode = recorded(env, "random")
    times = np.array([frame.time for frame in episode.frames])

    np.testing.assert_allclose(np.diff(times), 0.1)
    assert times[0] == 0.0
    assert episode.duration == int(env.batch.times[0]) / 10
    assert episode.frames[-1] == env._frame()
    assert episode.end == "capped"


@compiled_only
def test_to_watch_a_game_does_not_change_it() -> None:
    plain_env, watched = KeepawayEnv(), KeepawayEnv()
    frames: list[Frame] = []
    watched.watch(frames.append)
    rng = np.random.default_rng(1)
    for seed in (1, None, 7, None):
        for one, other in zip(
            plain_env.reset(seed=seed)[0].values(), watched.reset(seed=seed)[0].values(), strict=True
        ):
            np.testing.assert_array_equal(one, other)
        ended = False
        while not ended:
            action = int(rng.integers(3))
            alone, seen = plain_env.step(action), watched.step(action)
            assert alone[1:4] == seen[1:4]
            assert alone[4]["duration"] == seen[4]["duration"]
            np.testing.assert_array_equal(alone[4]["variables"], seen[4]["variables"])
            np.testing.assert_array_equal(alone[4]["last_times"], seen[4]["last_times"])
            ended = alone[2] or alone[3]
        assert frames[-1].time == int(watched.batch.times[0]) / 10


def test_choices_are_told_by_the_keepers_numbers() -> None:
    env = KeepawayEnv(max_cycles=60)
    episode = recorded(env, "hand", seed=0)
    first = episode.choices[0]
    actor = plain(first.words)[0]

    assert len(first.options) == 3
    assert plain(first.options[0]) == f"{actor} holds"
    assert {plain(words)[:-1] for words in first.options[1:]} == {f"{actor} passes to "}
    assert first.values is not None
    assert first.values[0] == 90.0
    assert recorded(env, "hold").choices[0].values is None
