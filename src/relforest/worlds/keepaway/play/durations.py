"""How long keepers keep the ball: many episodes, played without an environment.

Episodes are played in `LANES` sequences. Each is a game with its own random numbers, in which bodies keep
their directions from one episode to the next, as in the RoboCup 2-D server. The number of episodes in each
sequence is fixed in advance, so that short episodes are not over-represented, and results do not depend on
the number of sequences played in parallel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextvars import copy_context
from dataclasses import dataclass
from threading import Lock
from types import MappingProxyType
from typing import Final, SupportsIndex, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.options import between, one_of
from relforest.support.parallel import run_tasks
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence, stream
from relforest.worlds.keepaway.decisions.policies import checked_action
from relforest.worlds.keepaway.decisions.variables import n_variables, state_variables
from relforest.worlds.keepaway.play.advance import (
    ASK,
    HAND,
    HOLD,
    NO_ACTION,
    NOBODY,
    RANDOM,
    UNFINISHED,
    advance,
)
from relforest.worlds.keepaway.play.events import N_EVENTS, Tally, forget_events, new_tally
from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.players.views import Work, new_work
from relforest.worlds.keepaway.server.layout import END, TIME, Games, Setup
from relforest.worlds.keepaway.server.options import MOST_CYCLES, KeepawayOptions, checked_options
from relforest.worlds.keepaway.server.referee import place

LANES: Final = 64
"""Number of sequences of episodes."""

MOST_EPISODES: Final = 1_000_000
"""Episodes in one call."""

POLICIES: Final[Mapping[str, int]] = MappingProxyType({"random": RANDOM, "hold": HOLD, "hand": HAND})
"""Name of a policy that is built into the simulator -> its code."""

Policy: TypeAlias = str | Callable[[NDArray[np.float64], np.random.Generator], SupportsIndex]

# A kernel cannot be interrupted, so it returns after this many cycles, about a second.
_CYCLES: Final = 20_000


@final
@dataclass(frozen=True, slots=True, eq=False)
class Played:
    """The results of `play_episodes` for e episodes.

    Parameters
    ----------
    durations : (e,) int64
        Cycles of 0.1 s from the beginning of each episode to its end.
    ends : (e,) int64
        OUT, TAKEN or CAPPED, see `layout`.
    events : (e, N_EVENTS) int64
        Counts, see the columns of `events`.
    speeds : (N_SPEEDS,) int64
        Cycles by speed of the ball, in cells of 0.01 metres per cycle.
    keeper_distances : (K (K - 1) / 2,) float64
        Mean distances between keepers in metres, the nearest two first.
    """

    durations: NDArray[np.int64]
    ends: NDArray[np.int64]
    events: NDArray[np.int64]
    speeds: NDArray[np.int64]
    keeper_distances: NDArray[np.float64]


def episode_durations(
    policy: Policy,
    keepers: int = 3,
    takers: int = 2,
    size: float | tuple[float, float] = 20.0,
    episodes: int = 500,
    seed: RandomState = 0,
    *,
    n_jobs: int = 1,
) -> NDArray[np.int64]:
    """Play keepaway and return how long each episode took.

    Parameters
    ----------
    policy : {"random", "hold", "hand"} or callable
        What decides for all keepers: uniformly at random, never pass, the hand-coded policy of the benchmark,
        or a function ``(state_variables, rng) -> int`` that returns 0 to hold the ball or i to pass it to the
        i-th nearest teammate. The array is new in each call.
    keepers, takers, size
        The rules, see `KeepawayOptions`; `play_episodes` takes all of them.
    episodes : int
        Number of episodes, 1 to 1 000 000.
    seed : int, SeedSequence, Generator or None
        The same seed gives the same durations for any ``n_jobs``.
    n_jobs : int
        Number of threads, -1 = one per core. Only built-in policies benefit.

    Returns
    -------
    (episodes,) int64
        Cycles of 0.1 s.

    Raises
    ------
    InputError
        If an option is out of range, the policy returns an action that does not exist, or an episode does not
        end within 1 000 000 cycles.

    References
    ----------
    Stone, Kuhlmann, Taylor, and Liu (2006), "Keepaway soccer: from machine learning testbed to benchmark".

    Examples
    --------
    >>> hold, random = (episode_durations(policy, episodes=20, seed=1) for policy in ("hold", "random"))
    >>> bool(hold.mean() < random.mean())
    True
    """
    options = KeepawayOptions(keepers=keepers, takers=takers, size=size)
    return play_episodes(policy, options, episodes, seed, n_jobs=n_jobs).durations


def play_episodes(
    policy: Policy,
    options: KeepawayOptions | None = None,
    episodes: int = 500,
    seed: RandomState = 0,
    *,
    n_jobs: int = 1,
) -> Played:
    """Play keepaway and count what happens.

    Without options, three keepers play against two takers on 20 m by 20 m. All else is as for
    `episode_durations`, which can set fewer rules.
    """
    if not callable(policy):
        one_of("policy", policy, tuple(POLICIES))
    setup, episodes = checked_options(options), between("episodes", episodes, 1, MOST_EPISODES)
    lanes = min(LANES, episodes)
    root, finished = seed_sequence(seed), _Finished(episodes)
    share, rest = divmod(episodes, lanes)
    tasks = [(policy, setup, share + (lane < rest), stream(root, lane), finished) for lane in range(lanes)]
    played = run_tasks(_play_lane, tasks, n_jobs=n_jobs, prefer="threads")
    durations = np.concatenate([lane.durations for lane in played])
    distances = np.sum([lane.keeper_distances * lane.durations.sum() for lane in played], axis=0)
    return Played(
        durations=durations,
        ends=np.concatenate([lane.ends for lane in played]),
        events=np.concatenate([lane.events for lane in played]),
        speeds=np.sum([lane.speeds for lane in played], axis=0),
        keeper_distances=distances / durations.sum(),
    )


@final
class _Finished:
    """Counts finished episodes across threads and reports them to the listener of the calling thread."""

    def __init__(self, total: int) -> None:
        self._total, self._done = total, 0
        self._lock, self._context = Lock(), copy_context()

    def __reduce__(self) -> tuple[type[_Finished], tuple[int]]:
        """Drop the listener when sent to another process."""
        return _Finished, (self._total,)

    def one_more(self) -> None:
        """Count and report a finished episode."""
        with self._lock:
            self._done += 1
            self._context.run(report, "playing episodes", self._done, self._total)


def _play_lane(
    policy: Policy, setup: Setup, episodes: int, seed: np.random.SeedSequence, finished: _Finished
) -> Played:
    games, work, tally = new_games(setup, [stream(seed, 0)]), new_work(setup), new_tally(setup)
    rng = generator(stream(seed, 1))
    durations, ends = np.empty(episodes, dtype=np.int64), np.empty(episodes, dtype=np.int64)
    events = np.empty((episodes, N_EVENTS), dtype=np.int64)
    for episode in range(episodes):
        if episode > 0:
            place(games, 0, setup)
        forget_events(tally)
        _play_episode(policy, games, setup, work, tally, rng)
        durations[episode] = games.counters[0, TIME]
        ends[episode] = games.counters[0, END]
        events[episode] = tally.events
        finished.one_more()
    return Played(durations, ends, events, tally.speeds, tally.pairs / durations.sum())


def _play_episode(
    policy: Policy, games: Games, setup: Setup, work: Work, tally: Tally, rng: np.random.Generator
) -> None:
    code = ASK if callable(policy) else POLICIES[policy]
    action, actor = NO_ACTION, UNFINISHED
    while actor != NOBODY:
        if games.counters[0, TIME] >= MOST_CYCLES:
            raise InputError(f"an episode has not ended after {MOST_CYCLES} cycles: set max_cycles")
        actor = advance(games, 0, setup, code, action, work, tally, _CYCLES)
        action = NO_ACTION
        if actor >= 0 and callable(policy):
            variables = np.empty(n_variables(setup.keepers, setup.takers))
            state_variables(work.views[actor], work.balls[actor], setup.keepers, variables)
            action = checked_action(policy(variables, rng), setup.keepers)
