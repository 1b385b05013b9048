from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest.support.errors import InputError
from relforest.support.progress import Stage, listening
from relforest.worlds.keepaway.durations import Policy, play_episodes
from relforest.worlds.keepaway.layout import BODY, CAPPED, KICK, NONE, OUT, TAKEN, VX, VY, X, Y
from relforest.worlds.keepaway.options import KeepawayOptions
from relforest.worlds.keepaway.recorder import Values, hand_scores, record_episodes
from relforest.worlds.keepaway.recording import Recording

pytestmark = compiled_only

KICKABLE = 1.085


def pass_now(variables: NDArray[np.float64], rng: np.random.Generator) -> int:
    return 1 + int(rng.integers(2)) if variables[3] < 8 else 0


@pytest.fixture(scope="module")
def game() -> Recording:
    return record_episodes("random", seed=5)[0]


@pytest.mark.parametrize("policy", ["random", "hold", "hand", pass_now])
def test_recorded_episodes_are_those_that_are_only_counted(policy: Policy) -> None:
    options = KeepawayOptions(max_cycles=60)
    recordings = record_episodes(policy, options, 3, 7)
    played = play_episodes(policy, options, 3, 7)

    assert [recording.duration for recording in recordings] == played.durations.tolist()
    assert [recording.end for recording in recordings] == played.ends.tolist()


def test_more_episodes_than_lanes_go_on_in_the_same_games(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.worlds.keepaway.recorder.LANES", 2)
    first, second, other = record_episodes("hold", None, 3, 7)

    # The second episode of a game begins with the bodies of the first, a new game with all facing +x.
    assert second.players[0, :, BODY].tolist() == first.players[-1, :, BODY].tolist()
    assert other.players[0, :, BODY].tolist() == [0.0] * 5


def test_bodies_go_where_their_speeds_take_them(game: Recording) -> None:
    moved = game.players[1:, :, [X, Y]] - game.players[:-1, :, [X, Y]]
    # What is left of the movement after a cycle is 0.4 of it, unless players collided.
    free = np.hypot(*(moved * 0.4 - game.players[1:, :, [VX, VY]]).transpose(2, 0, 1)) < 1e-9

    assert free.mean() > 0.8


def test_only_who_has_the_ball_kicks_it(game: Recording) -> None:
    away = np.hypot(*(game.players[:-1, :, :2] - game.ball[:-1, None, :2]).transpose(2, 0, 1))
    kicks = game.commands[:, :, 0] == KICK

    assert kicks.any()
    assert (away[kicks] <= KICKABLE).all()
    assert (game.commands[:, :, 0] != NONE).mean() > 0.9


def test_decisions_belong_to_the_state_in_which_they_are_made(game: Recording) -> None:
    decisions = game.decisions
    actors = game.players[decisions.times, decisions.actors]
    away = np.hypot(*(actors[:, :2] - game.ball[decisions.times, :2]).T)

    assert len(decisions) > 3
    # The ball is perceived to about a twentieth of its distance.
    assert (away < 1.1 * KICKABLE).all()
    assert (np.diff(decisions.times) >= 0).all()
    assert (decisions.orders[:, 0] == decisions.actors).all()
    assert (np.sort(decisions.orders, axis=1) == np.arange(3)).all()
    assert np.isnan(decisions.values).all()


def test_an_episode_ends_as_it_says() -> None:
    ends = {recording.end: recording for recording in record_episodes("random", None, 12, 1)}

    assert set(ends) <= {OUT, TAKEN}
    for end, recording in ends.items():
        reach = np.abs(recording.ball[:, :2]).max(axis=1)
        assert reach[:-1].max() < 10.0
        assert (reach[-1] < 10.0) == (end == TAKEN)
    (capped,) = record_episodes("hold", KeepawayOptions(max_cycles=4), 1, 1)
    assert (capped.end, capped.duration, len(capped.decisions)) == (CAPPED, 4, 0)


def test_the_hand_coded_policy_tells_its_scores() -> None:
    decisions = record_episodes("hand", None, 2, 0)[0].decisions
    told = np.isfinite(decisions.values).all(axis=1)

    assert 0 < told.sum() < len(decisions)
    chosen = np.take_along_axis(decisions.values, decisions.actions[:, None], axis=1)[told, 0]
    assert chosen == pytest.approx(decisions.values[told].max(axis=1))
    assert (decisions.values[:, 0] == 90.0).all()
    assert (decisions.actions[~told] == 0).all()
    assert np.isnan(decisions.values[~told, 1:]).all()


def test_scores_weigh_distance_and_angle() -> None:
    # 3 against 2: the fourth variable is the distance to the nearest taker, then 9 and 10 the distances of
    # the teammates to their nearest takers, 11 and 12 the angles. 4 * 6 + 30 = 54, 4 * 2.5 + 100 = 110.
    variables = np.array([1.0, 9, 12, 4.9, 6, 5, 5, 4, 4, 6.0, 2.5, 30.0, 100.0])
    assert hand_scores(variables, 3, 2).tolist() == [90.0, 54.0, 110.0]

    variables[3] = 5.1
    np.testing.assert_array_equal(hand_scores(variables, 3, 2), [90.0, np.nan, np.nan])


def test_values_of_ones_own_are_kept() -> None:
    def policy(variables: NDArray[np.float64], rng: np.random.Generator) -> int:
        variables[:] = np.nan
        return int(rng.integers(3))

    def values(variables: NDArray[np.float64]) -> list[float]:
        return [float(variables[0]), 1.0, np.nan]

    (recording,) = record_episodes(policy, seed=5, values=values)
    (plain,) = record_episodes(policy, seed=5)
    players = recording.players[recording.decisions.times, recording.decisions.actors]

    np.testing.assert_array_equal(recording.players, plain.players)
    assert (recording.decisions.values[:, 1] == 1.0).all()
    assert recording.decisions.values[:, 0] == pytest.approx(np.hypot(players[:, 0], players[:, 1]), abs=1.0)


@pytest.mark.parametrize(
    ("policy", "options", "message"),
    [
        ("best", {}, "policy must be one of 'random', 'hold', 'hand', got 'best'"),
        ("hold", {"episodes": 0}, "episodes must be an integer from 1 to 1000, got 0"),
        ("hold", {"episodes": 1001}, "episodes must be an integer from 1 to 1000, got 1001"),
        ("hold", {"options": 5}, "options must be KeepawayOptions, such as .*, got 5"),
        ("hold", {"values": [1.0, 2.0, 3.0]}, r"values must be a function of the state variables, got \[1.0"),
        ("hold", {"values": lambda _: "abc"}, "one number for each of 3 actions, got 'abc'"),
        ("hold", {"seed": -1}, "integer of at least 0, .* got -1"),
        ("hold", {"values": lambda _: [1.0, 2.0]}, r"one number for each of 3 actions, got \[1.0, 2.0\]"),
        (lambda _, __: 3, {}, r"an integer from 0 \(hold\) to 2 .*, got 3"),
        (lambda _, __: np.nan, {}, r"an integer from 0 \(hold\) to 2 .*, got nan"),
        (lambda _, __: True, {}, r"an integer from 0 \(hold\) to 2 .*, got True"),
    ],
)
def test_bad_policies_and_options_are_refused(policy: Policy, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        record_episodes(policy, **options)


def test_values_may_be_arrays_of_integers() -> None:
    values: Values = lambda _: np.array([1, 2, 3])  # noqa: E731 - typed as the parameter is

    assert record_episodes("hold", seed=2, values=values)[0].decisions.values[0].tolist() == [1.0, 2.0, 3.0]


def test_recordings_that_do_not_fit_into_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.worlds.keepaway.recorder.MOST_RECORDED", 20)
    assert record_episodes("hold", KeepawayOptions(max_cycles=10), 2)
    with pytest.raises(InputError, match=r"exceed 20 cycles, .* choose fewer episodes or a smaller"):
        record_episodes("hold", KeepawayOptions(max_cycles=10), 3)


def test_progress_is_reported() -> None:
    stages: list[Stage] = []
    with listening(stages.append):
        record_episodes("hold", KeepawayOptions(max_cycles=5), 2)
    assert stages == [Stage("playing episodes", 0, 2), Stage("playing episodes", 1, 2)]
