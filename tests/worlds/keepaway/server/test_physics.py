from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from keepaway_games import game, played, recorded_steps, scatter
from relforest.worlds.keepaway.server.bounds import Steps, step_violations
from relforest.worlds.keepaway.server.layout import DASH, KICK, NONE, TURN, Games
from relforest.worlds.keepaway.server.options import KeepawayOptions
from relforest.worlds.keepaway.server.physics import execute, kick_noise, kick_rate, normalised, separate

SETUP = KeepawayOptions().setup()

# Positions and velocities of the recording are rounded to 4 decimals, angles to 3, and then to float32.
ROUNDING, BODY_ROUNDING = 0.51e-4, 0.51e-3


def still() -> Games:
    games = game(SETUP)
    scatter(games)
    return games


def step_of(games: Games, player: int, *command: int) -> None:
    games.commands[0] = NONE
    games.commands[0, player] = [*command, *[0] * (3 - len(command))]
    execute(games, 0, SETUP)


def recorded_violations(steps: Steps, *, min_dash_power: int = 0) -> dict[str, int]:
    counts = step_violations(
        steps, rounding=ROUNDING, body_rounding=BODY_ROUNDING, min_dash_power=min_dash_power
    )
    return {kind: count.violations for kind, count in counts.items()}


def test_every_step_of_the_real_server_lies_inside_the_noise() -> None:
    counts = step_violations(
        recorded_steps(), rounding=ROUNDING, body_rounding=BODY_ROUNDING, min_dash_power=0
    )

    assert {kind: count.violations for kind, count in counts.items()} == dict.fromkeys(counts, 0)
    assert {kind: count.steps for kind, count in counts.items()} == {
        "free ball": 1427,
        "kick": 620,
        "turn": 5069,
        "dash": 4544,
        "collision": 489,
    }


def test_the_recorded_server_did_not_dash_backwards() -> None:
    assert recorded_violations(recorded_steps(), min_dash_power=-100)["dash"] == 100


@pytest.mark.parametrize(
    ("kind", "part", "index", "factor"),
    [
        ("free ball", "next_ball", np.s_[:, 2:], 1.01),
        ("turn", "next_players", np.s_[..., 4], 1.05),
        ("dash", "next_players", np.s_[..., 2:4], 0.98),
        ("kick", "ball", np.s_[:, :2], 1.02),
    ],
)
def test_the_bounds_are_tight_enough_to_see_small_errors(
    kind: str, part: str, index: tuple[slice, ...], factor: float
) -> None:
    steps = recorded_steps()
    changed = getattr(steps, part).copy()
    changed[index] *= factor

    assert recorded_violations(dataclasses.replace(steps, **{part: changed}))[kind] > 100


def test_collisions_of_the_real_server_are_replayed() -> None:
    # Where objects were before the server pushed them apart follows from what is left of their velocities:
    # -0.1 * 0.4 of the distance moved (players), -0.1 * 0.94 (ball). Rounding errors grow by 1 / 0.04 = 25.
    steps, games = recorded_steps(), still()
    errors = []
    for s in range(len(steps.ball)):
        bounced = np.hypot(*(steps.next_players[s, :, :2] - steps.players[s, :, :2]).T) * 0.4
        hit = np.flatnonzero(np.abs(bounced - np.hypot(*steps.next_players[s, :, 2:4].T)) > 3e-4)
        if len(hit) == 0:
            continue
        games.players[0] = steps.next_players[s]
        games.players[0, hit, 2:4] /= -0.1
        games.players[0, hit, :2] = steps.players[s, hit, :2] + games.players[0, hit, 2:4] / 0.4
        games.ball[0] = steps.next_ball[s]
        moved = steps.next_ball[s, :2] - steps.ball[s, :2]
        if np.hypot(*(moved * 0.94 - steps.next_ball[s, 2:])) > 3e-4:
            games.ball[0, 2:] /= -0.1
            games.ball[0, :2] = steps.ball[s, :2] + games.ball[0, 2:] / 0.94
        separate(games, 0, 5)
        errors += [np.hypot(*(games.players[0, hit, :2] - steps.next_players[s, hit, :2]).T).max()]

    assert len(errors) == 235
    assert max(errors) < 0.01


commands = st.tuples(
    st.sampled_from([NONE, DASH, TURN, KICK]), st.integers(-250, 250), st.integers(-250, 250)
)


@given(st.lists(st.lists(commands, min_size=5, max_size=5), min_size=1, max_size=6), st.integers(0, 2**32))
def test_our_own_steps_lie_inside_the_noise(
    given_commands: list[list[tuple[int, int, int]]], seed: int
) -> None:
    games = game(SETUP, seed=seed)
    games.players[0, :, :2] *= 0.1
    games.ball[0, :2] *= 0.1
    # The log of the server has commands as they are carried out: within their limits.
    limited = np.array(given_commands)
    limited[..., 1] = np.where(
        limited[..., 0] == TURN, limited[..., 1].clip(-180, 180), limited[..., 1].clip(-100, 100)
    )
    limited[..., 2] = limited[..., 2].clip(-180, 180)
    steps = played(games, SETUP, len(given_commands), list(np.array(given_commands)))
    counts = step_violations(dataclasses.replace(steps, commands=limited))

    assert {kind: count.violations for kind, count in counts.items()} == dict.fromkeys(counts, 0)


def test_what_stands_still_and_does_nothing_stays_exactly_where_it_is() -> None:
    games = still()
    players, ball = games.players.copy(), games.ball.copy()
    execute(games, 0, SETUP)

    np.testing.assert_array_equal(games.players, players)
    np.testing.assert_array_equal(games.ball, ball)


def quiet(games: Games, player: int) -> NDArray[np.float64]:
    """What the player did, to be compared with a tolerance of its noise: 10 % of its speed."""
    return np.asarray(games.players[0, player])


def test_a_full_dash_from_rest() -> None:
    games = still()
    games.players[0, 1] = [0.0, 5.0, 0.0, 0.0, 90.0]
    step_of(games, 1, DASH, 100)

    # 0.006 * 100 = 0.6 along the body; 10 % noise; 0.4 of it is left as velocity.
    x, y, vx, vy, body = quiet(games, 1)
    assert math.hypot(x, y - 5.6) <= 0.06
    assert [vx, vy] == pytest.approx([0.4 * x, 0.4 * (y - 5.0)], abs=1e-12)
    assert body == 90.0


def test_a_backward_dash_is_as_strong_and_power_is_limited_to_100() -> None:
    games = still()
    games.players[0, 1] = [0.0, 5.0, 0.0, 0.0, 180.0]
    step_of(games, 1, DASH, -1000)

    assert math.hypot(games.players[0, 1, 0] - 0.6, games.players[0, 1, 1] - 5.0) <= 0.06


def test_speed_is_limited_only_while_a_player_dashes() -> None:
    games = still()
    games.players[0, 1] = [0.0, 5.0, 2.0, 0.0, 0.0]
    games.players[0, 2] = [0.0, -5.0, 2.0, 0.0, 0.0]
    games.commands[0, 1] = [DASH, 100, 0]
    execute(games, 0, SETUP)

    assert abs(games.players[0, 1, 0] - 1.05) <= 0.105
    assert abs(games.players[0, 2, 0] - 2.0) <= 0.2


def test_a_turn_is_slower_at_speed() -> None:
    games = still()
    games.players[0, 1] = [0.0, 5.0, 0.3, 0.4, 170.0]
    games.players[0, 2] = [0.0, -5.0, 0.0, 0.0, 170.0]
    games.commands[0, 1] = [TURN, 70, 0]
    games.commands[0, 2] = [TURN, -400, 0]
    execute(games, 0, SETUP)

    # 70 / (1 + 5 * 0.5) = 20, so 190 = -170, 10 % noise; -400 counts as -180: 170 - 180 = -10.
    assert abs(games.players[0, 1, 4] - -170.0) <= 2.0
    assert abs(games.players[0, 2, 4] - -10.0) <= 18.0


def test_hand_worked_kicks() -> None:
    # Touching, straight ahead: 0.027. At 1.085 m, a gap of 0.7: one quarter less. Behind: one quarter less.
    assert kick_rate(0.385, 0.0) == pytest.approx(0.027)
    assert kick_rate(1.085, 0.0) == pytest.approx(0.02025)
    assert kick_rate(0.385, 180.0) == pytest.approx(0.02025)
    assert kick_rate(0.735, 90.0) == pytest.approx(0.027 * (1.0 - 0.125 - 0.125))
    # 0.1 * 80/100 * (0.5 + 0.25 * 0.1/0.7 + 0.5 + 0.5 * 0.3 / 2.82) = 0.08 * (1.035714... + 0.053191...)
    assert kick_noise(80.0, 0.485, 0.0, 0.3) == pytest.approx(0.0871125, abs=1e-7)


def test_a_kick_moves_the_ball_from_reach_only() -> None:
    games = still()
    games.players[0, 0] = [-0.735, 0.0, 0.0, 0.0, 0.0]
    step_of(games, 0, KICK, 50, 90)

    # Gap 0.35: rate 0.027 * (1 - 0.125) = 0.023625, times 50 = 1.18125 at 90 degrees to the body. Errors:
    # kick 0.1 * 0.5 * (0.5 + 0.125 + 0.5) = 0.05625 and rolling 0.05 * (1.18125 + 0.05625) = 0.061875.
    assert math.hypot(games.ball[0, 0], games.ball[0, 1] - 1.18125) <= 0.05625 + 0.061875
    assert games.ball[0, 2:] == pytest.approx(0.94 * games.ball[0, :2])

    beyond = still()
    beyond.players[0, 0] = [-1.0851, 0.0, 0.0, 0.0, 0.0]
    step_of(beyond, 0, KICK, 50, 90)
    assert beyond.ball[0].tolist() == [0.0] * 4


def test_kicks_of_several_players_add_up_to_a_limit() -> None:
    games = still()
    games.players[0, 0] = [-0.735, 0.0, 0.0, 0.0, 0.0]
    games.players[0, 3] = [0.735, 0.0, 0.0, 0.0, 180.0]
    games.commands[0, 0] = [KICK, 100, 90]
    games.commands[0, 3] = [KICK, 100, -90]
    execute(games, 0, SETUP)

    # 2 * 2.3625 = 4.725 along +y, cut to 2.7; the errors of both kicks turn it by less than 0.225 / 4.5 rad.
    assert abs(games.ball[0, 1] - 2.7) <= 0.05 * 2.7 + 0.02
    assert abs(games.ball[0, 0]) <= 0.05 * 2.7 + 2.7 * 0.225 / 4.5


def test_opposite_kicks_cancel() -> None:
    games = still()
    games.players[0, 0] = [-0.735, 0.0, 0.0, 0.0, 0.0]
    games.players[0, 3] = [0.735, 0.0, 0.0, 0.0, 180.0]
    games.commands[0, [0, 3]] = [KICK, 20, 90], [KICK, 20, 90]
    execute(games, 0, SETUP)

    # Errors: 2 * 0.1 * 0.2 * 1.125 = 0.045, and 5 % of that.
    assert np.hypot(*games.ball[0, :2]) <= 0.045 * 1.05


def test_touching_objects_do_not_collide() -> None:
    games = still()
    games.players[0, 0, :2] = [0.385, 0.0]
    games.players[0, 1, :2] = [0.985 + 1e-12, 0.0]
    before = games.players.copy()
    execute(games, 0, SETUP)

    np.testing.assert_array_equal(games.players, before)


def test_two_overlapping_objects_part_symmetrically_and_turn_back() -> None:
    games = still()
    games.players[0, 0] = [0.0, 1.0, 0.2, 0.0, 0.0]
    games.players[0, 1] = [0.4, 1.0, -0.1, 0.3, 0.0]
    separate(games, 0, 5)

    # Middle 0.2, touching distance 0.6: at -0.1 and 0.5; a tenth of the velocity, reversed.
    assert games.players[0, 0] == pytest.approx([-0.1, 1.0, -0.02, 0.0, 0.0])
    assert games.players[0, 1] == pytest.approx([0.5, 1.0, 0.01, -0.03, 0.0])
    assert games.players[0, 2, 1] == 8.0


def test_a_player_and_the_ball_part_at_their_own_distance() -> None:
    games = still()
    games.players[0, 3, :2] = [0.0, -0.185]
    games.ball[0] = [0.0, 0.0, 1.0, 0.0]
    separate(games, 0, 5)

    # Middle -0.0925, half of 0.385 = 0.1925 to both sides.
    assert games.players[0, 3, :2] == pytest.approx([0.0, -0.285])
    assert games.ball[0] == pytest.approx([0.0, 0.1, -0.1, 0.0])


def test_the_middle_of_three_stays() -> None:
    games = still()
    games.players[0, :3, :2] = [[0.0, 1.0], [0.5, 1.0], [1.0, 1.0]]
    games.players[0, :3, 2] = 1.0
    separate(games, 0, 5)

    # The middle one is asked to 0.55 and 0.45, so it stays; the others overlap it by less each round. All
    # bounce once, however many rounds there are.
    assert games.players[0, :3, 0] == pytest.approx([-0.1, 0.5, 1.1], abs=2e-4)
    assert games.players[0, :3, 2] == pytest.approx([-0.1] * 3)


def test_coincident_players_part_in_some_direction() -> None:
    games = still()
    games.players[0, 0, :2] = games.players[0, 1, :2] = [0.0, 5.0]
    separate(games, 0, 5)
    one, other = games.players[0, 0, :2], games.players[0, 1, :2]

    assert np.hypot(*(one - other)) == pytest.approx(0.6)
    assert (one + other) / 2 == pytest.approx([0.0, 5.0])


def test_a_crowd_at_one_point_ends_finite() -> None:
    setup = KeepawayOptions(keepers=32, takers=32).setup()
    games = game(setup)
    games.players[0, :, :2] = 0.0
    games.ball[0] = 0.0
    for _ in range(20):
        execute(games, 0, setup)

    assert np.isfinite(games.players).all()
    assert np.abs(games.players[0, :, :2]).max() < 20.0


@given(st.floats(-360.0, 360.0))
def test_angles_are_normalised(angle: float) -> None:
    result = normalised(angle)

    assert -180.0 <= result <= 180.0
    assert math.cos(math.radians(result - angle)) == pytest.approx(1.0)
