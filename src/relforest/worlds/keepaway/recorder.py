"""Play episodes and record everything that happens, cycle by cycle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol, TypeAlias, final, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.support.errors import InputError
from relforest.support.options import between, one_of
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence, stream
from relforest.worlds.keepaway.advance import ASK, NO_ACTION, NOBODY, choose_commands
from relforest.worlds.keepaway.durations import LANES, POLICIES, Policy
from relforest.worlds.keepaway.games import new_games
from relforest.worlds.keepaway.layout import END, PLAYING, TIME, Setup
from relforest.worlds.keepaway.options import KeepawayOptions, checked_options
from relforest.worlds.keepaway.physics import execute
from relforest.worlds.keepaway.policies import (
    CALM,
    DISTANCE_WEIGHT,
    HOLD_SCORE,
    checked_action,
    hand_coded,
)
from relforest.worlds.keepaway.randomness import below
from relforest.worlds.keepaway.recording import Decisions, Recording
from relforest.worlds.keepaway.referee import judge, place
from relforest.worlds.keepaway.rounding import TIE
from relforest.worlds.keepaway.variables import by_distance, n_variables, state_variables
from relforest.worlds.keepaway.views import new_work

MOST_EPISODES: Final = 1000
"""Episodes in one call."""

MOST_RECORDED: Final = 300_000
"""Cycles of all episodes together: more than 8 hours of play, up to 2 GB of memory."""

Values: TypeAlias = Callable[[NDArray[np.float64]], ArrayLike]
"""Function from the state variables of a decision to the value of each action, (keepers,), NaN = unknown."""


@runtime_checkable
class Decider(Protocol):
    """A policy that sees the players themselves and can return the values of its actions."""

    def decide(
        self,
        players: NDArray[np.float64],
        ball: NDArray[np.float64],
        actor: int,
        rng: np.random.Generator,
    ) -> tuple[int, ArrayLike]:
        """Return an action of the keeper `actor`, and the value of each of its actions, (keepers,).

        `players` (n, 5) and `ball` (4,) are as this keeper perceives them, with the columns of `layout`.
        """
        ...


def record_episodes(
    policy: Policy | Decider,
    options: KeepawayOptions | None = None,
    episodes: int = 1,
    seed: RandomState = 0,
    *,
    values: Values | None = None,
) -> tuple[Recording, ...]:
    """Play keepaway and record everything.

    Parameters
    ----------
    policy, options, episodes, seed
        As for `relforest.worlds.keepaway.durations.play_episodes`, which plays the same episodes faster,
        except that the policy may also be a `Decider` and the limit is 1000 episodes.
    values : callable, optional
        Returns the values of the actions in a state, for display only. By default they are the scores of the
        hand-coded policy or the values that a `Decider` returns, and unknown for other policies.

    Returns
    -------
    tuple of Recording

    Raises
    ------
    InputError
        If an option is out of range, the policy returns an action that does not exist, ``values`` does not
        return one number per action, or the episodes together last longer than `MOST_RECORDED` cycles.
    """
    if not callable(policy) and not isinstance(policy, Decider):
        one_of("policy", policy, tuple(POLICIES))
    if values is not None and not callable(values):
        raise InputError(f"values must be a function of the state variables, got {values!r}")
    setup, episodes = checked_options(options), between("episodes", episodes, 1, MOST_EPISODES)
    lanes = min(LANES, episodes)
    root, (share, rest) = seed_sequence(seed), divmod(episodes, lanes)
    recordings: list[Recording] = []
    left = MOST_RECORDED
    for lane in range(lanes):
        recorder = _Recorder(policy, setup, values, stream(root, lane))
        for number in range(share + (lane < rest)):
            report("playing episodes", len(recordings), episodes)
            recordings.append(recorder.record(again=number > 0, most=left))
            left -= recordings[-1].duration
    return tuple(recordings)


def hand_scores(variables: NDArray[np.float64], keepers: int, takers: int) -> NDArray[np.float64]:
    """Return the scores that the hand-coded policy compares, (keepers,); NaN for passes that it ignores."""
    if variables[keepers] > CALM + TIE:
        return np.array([HOLD_SCORE] + [np.nan] * (keepers - 1))
    near, angles = np.split(variables[2 * (keepers + takers) - 1 :], 2)
    return np.concatenate([[HOLD_SCORE], DISTANCE_WEIGHT * near + angles])


@final
class _Recorder:
    """Plays consecutive episodes of one game."""

    def __init__(
        self,
        policy: Policy | Decider,
        setup: Setup,
        values: Values | None,
        seed: np.random.SeedSequence,
    ) -> None:
        self._policy, self._setup, self._values = policy, setup, values
        self._games, self._work = new_games(setup, [stream(seed, 0)]), new_work(setup)
        self._rng = generator(stream(seed, 1))

    def record(self, *, again: bool, most: int) -> Recording:
        """Play one episode of at most `most` cycles; `again` places all players anew first."""
        games, setup = self._games, self._setup
        if again:
            place(games, 0, setup)
        states = [(games.players[0].copy(), games.ball[0].copy())]
        commands: list[NDArray[np.int64]] = []
        rows: list[tuple[int, int, int]] = []
        orders: list[NDArray[np.int64]] = []
        worths: list[NDArray[np.float64]] = []
        answer = NO_ACTION
        while games.counters[0, END] == PLAYING:
            actor = choose_commands(games, 0, setup, ASK, answer, self._work)
            if actor != NOBODY:
                answer, worth = self._decide(actor)
                rows.append((int(games.counters[0, TIME]), actor, answer))
                orders.append(self._order(actor))
                worths.append(worth)
                continue
            if len(commands) == most:
                raise InputError(
                    f"the episodes together exceed {MOST_RECORDED} cycles, the limit for recordings: "
                    "choose fewer episodes or a smaller max_cycles"
                )
            answer = NO_ACTION
            commands.append(games.commands[0].copy())
            execute(games, 0, setup)
            judge(games, 0, setup)
            states.append((games.players[0].copy(), games.ball[0].copy()))
        table = np.array(rows, dtype=np.int64).reshape(-1, 3)
        return Recording(
            field=(setup.length, setup.width),
            keepers=setup.keepers,
            players=np.array([players for players, _ in states]),
            ball=np.array([ball for _, ball in states]),
            commands=np.array(commands),
            decisions=Decisions(
                times=table[:, 0],
                actors=table[:, 1],
                actions=table[:, 2],
                orders=np.array(orders, dtype=np.int64).reshape(-1, setup.keepers),
                values=np.array(worths).reshape(-1, setup.keepers),
            ),
            end=int(games.counters[0, END]),
        )

    def _order(self, actor: int) -> NDArray[np.int64]:
        order = np.full(self._setup.keepers, actor)
        by_distance(self._work.views[actor], actor, 0, order[1:])
        return order

    def _decide(self, actor: int) -> tuple[int, NDArray[np.float64]]:
        """Return the action of a keeper and the values of all its actions."""
        keepers, takers, policy = self._setup.keepers, self._setup.takers, self._policy
        variables = np.empty(n_variables(keepers, takers))
        state_variables(self._work.views[actor], self._work.balls[actor], keepers, variables)
        worth = np.full(keepers, np.nan)
        if isinstance(policy, Decider):
            seen = (self._work.views[actor].copy(), self._work.balls[actor].copy())
            answer, values = policy.decide(*seen, actor, self._rng)
            return checked_action(answer, keepers), _checked_values(values, keepers)
        if self._values is not None:
            worth = _checked_values(self._values(variables.copy()), keepers)
        elif policy == "hand":
            worth = hand_scores(variables, keepers, takers)
        if callable(policy):
            return checked_action(policy(variables.copy(), self._rng), keepers), worth
        if policy == "random":
            return below(self._games.streams, 0, keepers), worth
        return hand_coded(variables, keepers, takers) if policy == "hand" else 0, worth


def _checked_values(values: ArrayLike, keepers: int) -> NDArray[np.float64]:
    try:
        worth = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        worth = np.empty(0)
    if worth.shape != (keepers,):
        raise InputError(f"values must return one number for each of {keepers} actions, got {values!r}")
    return worth
