from __future__ import annotations

import math
import os
import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest.support.errors import InputError
from relforest.support.progress import Stage, listening
from relforest.worlds.keepaway.play.durations import LANES, _Finished, episode_durations, play_episodes
from relforest.worlds.keepaway.play.events import (
    DASHES,
    FIRST_TOUCH,
    KEEPER_CYCLES,
    KEEPER_KICKS,
    TAKER_CYCLES,
    TRANSFERS,
    TURNS,
)
from relforest.worlds.keepaway.server.layout import CAPPED, OUT, TAKEN
from relforest.worlds.keepaway.server.options import KeepawayOptions

pytestmark = compiled_only

Variables = NDArray[np.float64]

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT") == "1"


def hold(variables: Variables, rng: np.random.Generator) -> int:  # noqa: ARG001 - the signature of policies
    return 0


def test_the_seed_alone_decides() -> None:
    first = episode_durations("random", episodes=6, seed=5)

    np.testing.assert_array_equal(first, episode_durations("random", episodes=6, seed=5))
    assert first.dtype == np.int64
    assert not np.array_equal(first, episode_durations("random", episodes=6, seed=6))


def test_threads_change_nothing() -> None:
    alone, together = (
        play_episodes("random", episodes=12 if INTERPRETED else LANES + 3, seed=1, n_jobs=n) for n in (1, 4)
    )

    np.testing.assert_array_equal(alone.durations, together.durations)
    np.testing.assert_array_equal(alone.ends, together.ends)
    np.testing.assert_array_equal(alone.events, together.events)
    np.testing.assert_array_equal(alone.keeper_distances, together.keeper_distances)


def test_a_function_plays_like_the_policy_that_is_built_in() -> None:
    np.testing.assert_array_equal(
        episode_durations(hold, episodes=5, seed=2), episode_durations("hold", episodes=5, seed=2)
    )


def test_a_policy_is_given_the_state_variables_and_a_generator() -> None:
    seen = []

    def first_pass(variables: Variables, rng: np.random.Generator) -> np.int64:
        seen.append(variables)
        return rng.integers(1, 4)

    durations = episode_durations(first_pass, keepers=4, takers=3, size=25.0, episodes=2, seed=3)

    assert {variables.shape for variables in seen} == {(19,)}
    assert all(np.isfinite(variables).all() for variables in seen)
    assert len({id(variables) for variables in seen}) == len(seen)
    np.testing.assert_array_equal(
        durations, episode_durations(first_pass, keepers=4, takers=3, size=25.0, episodes=2, seed=3)
    )


def test_what_is_counted_fits_together() -> None:
    played = play_episodes("random", episodes=20, seed=4)
    cycles = played.durations.sum()
    events = played.events

    assert set(played.ends) <= {OUT, TAKEN}
    assert played.speeds.sum() == cycles
    assert (events[:, FIRST_TOUCH] >= 0).all()
    assert (events[:, FIRST_TOUCH] + events[:, KEEPER_CYCLES] <= played.durations).all()
    assert (events[played.ends == TAKEN, TAKER_CYCLES] >= 4).all()
    assert (events[:, TRANSFERS] <= events[:, KEEPER_KICKS]).all()
    assert (events[:, DASHES] + events[:, TURNS] <= 5 * played.durations).all()
    assert (np.diff(played.keeper_distances) > 0.0).all()
    assert played.keeper_distances.shape == (3,)


def test_random_play_lasts_about_as_long_as_with_the_real_server() -> None:
    durations = episode_durations("random", episodes=64, seed=0)

    # The real server: 53 to 58 cycles, standard deviation 18, so the mean of 64 is known to 2.3.
    assert 49.0 < durations.mean() < 64.0
    # The ball must roll out or be held for four cycles first.
    assert durations.min() > 8


@pytest.mark.parametrize(
    "options",
    [
        KeepawayOptions(),
        KeepawayOptions(keepers=2, takers=1, size=(40.0, 8.0)),
        KeepawayOptions(keepers=2, takers=4, perception="exact"),
    ],
)
def test_long_random_play_never_hangs_and_stays_finite(options: KeepawayOptions) -> None:
    played = play_episodes("random", options, 10 if INTERPRETED else 3000, seed=7)

    # Some episodes end before any keeper has the ball, none lasts for a minute.
    assert played.durations.min() > 0
    assert played.durations.max() < 600
    assert set(played.ends) <= {OUT, TAKEN}
    # The last cell is open: a ball faster than 3.19 cannot be.
    assert played.speeds[-1] == 0
    assert np.isfinite(played.keeper_distances).all()


def test_episodes_are_cut_off_at_the_cap() -> None:
    played = play_episodes("hold", KeepawayOptions(max_cycles=7), episodes=3)

    assert played.durations.tolist() == [7, 7, 7]
    assert played.ends.tolist() == [CAPPED] * 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"policy": "best"}, "policy must be one of 'random', 'hold', 'hand', got 'best'"),
        ({"policy": None}, "policy must be one of"),
        ({"keepers": 1}, "keepers must be an integer from 2 to 32"),
        ({"takers": 0}, "takers must be an integer from 1 to 32"),
        ({"size": math.nan}, "size must be"),
        ({"episodes": 0}, "episodes must be an integer from 1 to 1000000, got 0"),
        ({"episodes": 1_000_001}, "episodes must be an integer from 1 to 1000000, got 1000001"),
        ({"episodes": True}, "episodes must be"),
        ({"seed": -1}, "random_state must be"),
        ({"n_jobs": 0}, "n_jobs must be"),
    ],
)
def test_bad_arguments_are_named(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        episode_durations(**{"policy": "random", "episodes": 1, **arguments})


@pytest.mark.parametrize("action", [3, -1, 1.0, math.nan, None, True, "hold", 2**70])
def test_actions_that_do_not_exist_are_refused(action: Any) -> None:
    with pytest.raises(InputError, match=r"the policy must return an integer from 0 \(hold\) to 2"):
        episode_durations(lambda *_: action, episodes=1)


def test_options_of_another_kind_are_refused() -> None:
    options: Any = {"keepers": 4}
    with pytest.raises(InputError, match=r"options must be KeepawayOptions, .* got \{'keepers': 4\}"):
        play_episodes("hold", options)


def test_an_episode_without_end_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.worlds.keepaway.play.durations.MOST_CYCLES", 10)
    with pytest.raises(InputError, match="an episode has not ended after 10 cycles: set max_cycles"):
        episode_durations(lambda *_: 0, episodes=1)


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_every_finished_episode_is_reported(n_jobs: int) -> None:
    stages: list[Stage] = []
    with listening(stages.append):
        play_episodes("hold", KeepawayOptions(max_cycles=6), 5, n_jobs=n_jobs)
    assert stages == [Stage("playing episodes", done, 5) for done in range(1, 6)]


def test_other_processes_report_to_nobody() -> None:
    stages: list[Stage] = []
    with listening(stages.append):
        sent = pickle.dumps(_Finished(2))
    received = pickle.loads(sent)  # noqa: S301 - our own bytes
    received.one_more()
    assert stages == []
