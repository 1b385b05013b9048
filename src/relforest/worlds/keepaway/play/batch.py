"""A batch of games, played from one decision to the next with a single kernel call.

`env`, `lockstep`, `vector` and `parallel` are built on it. A game depends only on its own seed and actions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from typing import Any, Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.smdp import Decision, Decisions
from relforest.support.errors import InputError
from relforest.support.jit import kernel
from relforest.worlds.keepaway.decisions.scene import (
    attributes_of,
    blank_scenes,
    decisions,
    describe,
    objects,
)
from relforest.worlds.keepaway.decisions.variables import (
    by_distance,
    n_variables,
    nearest_keeper,
    state_variables,
)
from relforest.worlds.keepaway.play.advance import ASK, FOREVER, NO_ACTION, NOBODY, UNFINISHED, advance
from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.players.memory import DECIDED
from relforest.worlds.keepaway.players.views import Work, new_work
from relforest.worlds.keepaway.server.layout import CAPPED, END, OUT, TAKEN, TIME, Games, Setup
from relforest.worlds.keepaway.server.referee import place

DISCOUNT: Final = 0.9
"""Discount factor per cycle (Palmer (2015), section 7.4)."""

END_NAMES: Final = {OUT: "out", TAKEN: "taken", CAPPED: "capped"}
"""How an episode ended -> its name."""

START: Final = -1
RESTART: Final = -2
GO_ON: Final = -3
"""Codes beside the actions: begin with the players as they are placed, or place them first; continue a game
that was interrupted."""

MOST_REPLAYS: Final = 1000
"""Consecutive episodes without a decision after which a game is given up."""


class Seen(NamedTuple):
    """The visible state of G games: n players (K keepers), v state variables."""

    objects: NDArray[np.float64]  # (G, n, 6) of the scene
    variables: NDArray[np.float64]  # (G, v)
    receivers: NDArray[np.int64]  # (G, K - 1) teammates of the actor in the order of the actions
    last_times: NDArray[np.int64]  # (G, K) when each keeper last had the ball, -1 = not in this episode
    actors: NDArray[np.int64]  # (G,) the keeper that must decide, or NOBODY
    elapsed: NDArray[np.int64]  # (G,) cycles since the decision before, 0 at the first one
    skipped: NDArray[np.int64]  # (G,) episodes without a decision before this one
    asked: NDArray[np.int64]  # (G,) whether a keeper has decided in this episode


@final
class Batch:
    """Games with the same rules, each waiting for a decision or at its end; `begin` them first.

    Each thread plays a share of the games; how many there are does not affect the results.
    """

    def __init__(self, setup: Setup, n_games: int, n_threads: int = 1) -> None:
        self.setup = setup
        self.games = Games(*_repeated(new_games(setup, [np.random.SeedSequence(0)]), n_games))
        self._works = Work(*_repeated([array[None] for array in new_work(setup)], n_games))
        keepers, takers = setup.keepers, setup.takers
        self.seen = Seen(
            objects=np.tile(objects(keepers, takers), (n_games, 1, 1)),
            variables=np.zeros((n_games, n_variables(keepers, takers))),
            receivers=np.zeros((n_games, keepers - 1), dtype=np.int64),
            last_times=np.zeros((n_games, keepers), dtype=np.int64),
            actors=np.full(n_games, NOBODY),
            elapsed=np.zeros(n_games, dtype=np.int64),
            skipped=np.zeros(n_games, dtype=np.int64),
            asked=np.zeros(n_games, dtype=np.int64),
        )
        self._blank = blank_scenes(n_games, keepers, takers)
        ends = np.linspace(0, n_games, min(n_threads, n_games) + 1).astype(np.int64).tolist()
        self._shares = [slice(first, last) for first, last in pairwise(ends)]
        self._pool: ThreadPoolExecutor | None = None

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the threads, which cannot be copied; new ones start when they are needed."""
        return self.__dict__ | {"_pool": None}

    def close(self) -> None:
        """Stop the threads; new ones start when they are needed."""
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None

    def __len__(self) -> int:
        """Return the number of games."""
        return len(self.seen.actors)

    @property
    def ends(self) -> NDArray[np.int64]:
        """The status of each episode, (G,): PLAYING, OUT, TAKEN or CAPPED."""
        return self.games.counters[:, END]

    @property
    def times(self) -> NDArray[np.int64]:
        """Cycles since each episode began, (G,)."""
        return self.games.counters[:, TIME]

    def begin(
        self,
        seeds: Sequence[np.random.SeedSequence | None],
        watch: Callable[[], None] | None = None,
    ) -> None:
        """Begin an episode in each game: a new game where there is a seed, else the next of the same game.

        ``watch`` is called and errors are raised as by `play`.
        """
        codes = np.full(len(self), RESTART)
        begun = np.array([seed is not None for seed in seeds])
        fresh = new_games(self.setup, [seed for seed in seeds if seed is not None])
        for mine, new in zip(self.games, fresh, strict=True):
            mine[begun] = new
        codes[begun] = START
        self.play(codes, watch)

    def play(self, actions: NDArray[np.int64], watch: Callable[[], None] | None = None) -> None:
        """Play each game on to its next decision, or to its end.

        Parameters
        ----------
        actions : (G,) int64
            The answer to the pending decision: 0 = hold, i = pass to the i-th of the receivers; or `START`,
            `RESTART`, or `GO_ON` to leave the game as it is. It is not checked.
        watch : callable, optional
            Called after every cycle, and when an episode has begun.

        Raises
        ------
        InputError
            If episode after episode ends before any keeper has the ball.
        """
        if watch is None:
            self._play(actions, FOREVER)
            return
        # To begin takes no time: the players are placed, and then shown.
        self._play(actions, 0 if actions.max() < 0 else 1)
        while (self.seen.actors == UNFINISHED).any():
            watch()
            self._play(np.full(len(self), GO_ON), 1)

    def _play(self, actions: NDArray[np.int64], cycles: int) -> None:
        play = partial(self._play_share, actions, cycles)
        # A pool costs more than a few games take.
        if len(self._shares) > 1 and self._pool is None:
            self._pool = ThreadPoolExecutor(len(self._shares))
        most = map(play, self._shares) if self._pool is None else self._pool.map(play, self._shares)
        if max(most) >= MOST_REPLAYS:
            raise InputError(
                f"{MOST_REPLAYS} episodes in a row ended before any keeper had the ball: choose a larger "
                f"max_cycles than {self.setup.max_cycles}, or 0 for no limit"
            )

    def _play_share(self, actions: NDArray[np.int64], cycles: int, share: slice) -> int:
        games, works = Games(*_part(self.games, share)), Work(*_part(self._works, share))
        seen = Seen(*_part(self.seen, share))
        return play_games(games, works, self.setup, actions[share], seen, cycles)

    def observation(self) -> dict[str, NDArray[Any]]:
        """Return the padded scenes, arrays of length G."""
        shape = self.seen.objects.shape[:2]
        return {**attributes_of(self.seen.objects), "mask": np.ones(shape, dtype=np.int8)}

    def info(self) -> dict[str, NDArray[Any]]:
        """Return the information about every decision, arrays of length G."""
        keepers = self.setup.keepers
        mask = np.repeat((self.seen.actors != NOBODY).astype(np.int8)[:, None], keepers, axis=1)
        return {
            "actor": self.seen.actors.copy(),
            "time": self.times.copy(),
            "last_times": self.seen.last_times.copy(),
            "variables": self.seen.variables.copy(),
            "action_mask": mask,
        }

    def scenes(self) -> Scenes:
        """Return one scene per game."""
        return self._blank.with_matrix(self.seen.objects.reshape(self._blank.matrix.shape).copy())

    def decision(self, g: int) -> Decision:
        """Return the objects and the available actions of one game."""
        return self.decisions(np.array([g]))[0]

    def decisions(self, games: NDArray[np.int64]) -> Decisions:
        """Return the objects and the available actions of some games."""
        return decisions(self.seen.objects[games], self.seen.actors[games], self.seen.receivers[games])

    def discounted(self, discount: float) -> NDArray[np.float64]:
        """Return the sum of ``discount**k`` over the cycles k = 0, 1, ... since the decision before, (G,)."""
        elapsed = self.seen.elapsed.astype(np.float64)
        if discount == 1.0:
            return elapsed
        powers: NDArray[np.float64] = discount**elapsed
        return (1.0 - powers) / (1.0 - discount)


@kernel
def play_games(
    games: Games, works: Work, setup: Setup, actions: NDArray[np.int64], seen: Seen, cycles: int
) -> int:
    """Play every game on to its next decision or its end, see `Batch.play`, or by a number of cycles.

    ``works`` is the work space of all games: each array with one more axis in front. Returns the largest
    number of episodes that a game which began has passed over.
    """
    most = 0
    for g in range(len(actions)):
        if actions[g] == GO_ON and seen.actors[g] != UNFINISHED:
            continue
        work = _own_work(works, g)
        actor = _play(games, g, setup, actions[g], work, seen, cycles)
        if actor == UNFINISHED:
            seen.actors[g] = UNFINISHED
        else:
            _look(games, g, setup, actor, work, seen)
        if actions[g] < 0:
            most = max(most, seen.skipped[g])
    return most


@kernel
def _own_work(works: Work, g: int) -> Work:
    # What the players of a game see must wait there for the answer to a question.
    return Work(
        works.views[g],
        works.balls[g],
        works.facing[g],
        works.gaps[g],
        works.pursuits[g],
        works.grid[g],
        works.crowding[g],
    )


@kernel
def _play(games: Games, g: int, setup: Setup, action: int, work: Work, seen: Seen, cycles: int) -> int:
    if action == RESTART:
        place(games, g, setup)
    if action in (START, RESTART):
        seen.asked[g] = seen.skipped[g] = 0
    if action != GO_ON:
        seen.elapsed[g] = 0
    before = games.counters[g, TIME]
    actor = advance(games, g, setup, ASK, max(action, NO_ACTION), work, None, cycles)
    while actor == NOBODY and seen.asked[g] == 0 and seen.skipped[g] < MOST_REPLAYS:
        seen.skipped[g] += 1
        place(games, g, setup)
        actor = advance(games, g, setup, ASK, NO_ACTION, work, None, cycles)
    if seen.asked[g]:
        seen.elapsed[g] += games.counters[g, TIME] - before
    elif actor >= 0:
        seen.asked[g] = 1
    return actor


@kernel
def _look(games: Games, g: int, setup: Setup, actor: int, work: Work, seen: Seen) -> None:
    """Write to `seen` what the actor perceives, or at the end of an episode how things are."""
    players, ball = games.players[g], games.ball[g]
    if actor != NOBODY:
        players, ball = work.views[actor], work.balls[actor]
    elif games.counters[g, END] == CAPPED:
        actor = nearest_keeper(players, ball, setup.keepers)
    seen.actors[g] = actor
    describe(players, seen.objects[g])
    state_variables(players, ball, setup.keepers, seen.variables[g])
    if actor != NOBODY:
        by_distance(players, actor, 0, seen.receivers[g])
    for i in range(setup.keepers):
        seen.last_times[g, i] = int(games.memory[g, i, DECIDED]) - 1


def _repeated(arrays: Sequence[NDArray[Any]], times: int) -> list[NDArray[Any]]:
    return [np.repeat(array, times, axis=0) for array in arrays]


def _part(arrays: Sequence[NDArray[Any]], share: slice) -> list[NDArray[Any]]:
    return [array[share] for array in arrays]
