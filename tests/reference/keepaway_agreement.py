"""Games of the compiled keepaway players, with their twin beside them in every cycle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reference import keepaway as twin
from reference import keepaway_sight as remembered
from relforest.worlds.keepaway.play.advance import HAND, NO_ACTION, NOBODY, choose_commands
from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.players import memory as columns
from relforest.worlds.keepaway.players.views import new_work
from relforest.worlds.keepaway.server.layout import BODY, END, PLAYING, TIME, Games, Setup
from relforest.worlds.keepaway.server.physics import execute
from relforest.worlds.keepaway.server.referee import judge, place

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.worlds.keepaway.players.views import Work

TOLERANCE = 1e-7
"""Metres, metres per cycle or degrees: rounding, amplified by the formulas, stays far below."""

_COLUMNS = {
    remembered.EXPECTED_VX: columns.NEXT_X,
    remembered.EXPECTED_VY: columns.NEXT_Y,
    remembered.OLD_X: columns.POINT_X,
    remembered.OLD_Y: columns.POINT_Y,
    remembered.OLD_TIME: columns.CHASED,
    remembered.LAST_ACTION: columns.LAST_ACTION,
    remembered.LAST_TIME: columns.DECIDED,
}


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """What a cycle begins with: players (n, 5), ball (4,) and memories (n, N_MEMORY) of one game."""

    time: int
    players: NDArray[np.float64]
    ball: NDArray[np.float64]
    memory: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Decisions of keepers (n,) and the commands (n, 3) of both in one cycle, and all on what they differ."""

    state: State
    actions: NDArray[np.int64]
    commands: NDArray[np.int64]
    twin_commands: NDArray[np.int64]
    differs: tuple[str, ...]

    @property
    def n_differing(self) -> int:
        return int(np.any(self.commands != self.twin_commands, axis=1).sum())

    def __str__(self) -> str:
        """Return what is needed to look into it."""
        who = np.flatnonzero(np.any(self.commands != self.twin_commands, axis=1)).tolist()
        commands = f"players {who}: {self.commands[who].tolist()}, twin {self.twin_commands[who].tolist()}"
        state = self.state
        return f"{self.differs} at {state.time}: {commands}\n{state.players}\n{state.ball}\n{state.memory}"


def compare_games(
    setup: Setup, policy: int, *, cycles: int, seed: int = 0, every: int = 1
) -> list[Comparison]:
    """Play one episode after the other, and ask the twin in every ``every``-th of the cycles.

    The twin starts each cycle from the state and the memories of the game, and keepers decide the same.
    """
    games, work = new_games(setup, [np.random.SeedSequence(seed)]), new_work(setup)
    compared = []
    for cycle in range(cycles * every):
        state = _state(games)
        assert choose_commands(games, 0, setup, policy, NO_ACTION, work) == NOBODY
        if cycle % every == 0:
            compared.append(_compare(games, work, setup, state, policy))
        execute(games, 0, setup)
        judge(games, 0, setup)
        if games.counters[0, END] != PLAYING:
            place(games, 0, setup)
    return compared


def compare_states(setup: Setup, policy: int, *, states: int, seed: int = 0) -> list[Comparison]:
    """Ask both in random states, where players do what they hardly ever do in games."""
    games, work = new_games(setup, [np.random.SeedSequence(seed)]), new_work(setup)
    rng = np.random.default_rng(seed)
    compared = []
    for _ in range(states):
        _scatter(games, setup, rng)
        state = _state(games)
        assert choose_commands(games, 0, setup, policy, NO_ACTION, work) == NOBODY
        compared.append(_compare(games, work, setup, state, policy))
    return compared


def ask_twin(
    setup: Setup, state: State, actions: NDArray[np.int64]
) -> tuple[twin.Cycle, NDArray[np.float64]]:
    """Return what the twin does in a cycle and then remembers; keepers decide ``actions``."""
    memory = _twin_memory(state.memory)
    sizes = (setup.keepers, setup.takers, setup.length, setup.width, setup.perception)
    return twin.play_cycle(state.players, state.ball, sizes, memory, state.time, actions), memory


def _scatter(games: Games, setup: Setup, rng: np.random.Generator) -> None:
    """Put everybody anywhere, but two near the ball, some facing in round directions, some fast."""
    players, ball, memory = games.players[0], games.ball[0], games.memory[0]
    half = np.array([setup.length, setup.width]) / 2.0
    n_players = len(players)
    now = 5
    games.counters[0, TIME] = now
    ball[:2] = players[0, :2] = rng.uniform(-half, half)
    ball[2:] = _vector(rng, 0.0, 2.8) * (rng.random() < 0.8)
    while _overlap(players, ball):
        players[:, :2] = rng.uniform(-half, half, size=(n_players, 2))
        for j in rng.choice(n_players, size=2, replace=False):
            players[j, :2] = ball[:2] + _vector(rng, 0.385, 2.5)
    for j in range(n_players):
        players[j, 2:4] = _vector(rng, 0.0, 0.45)
    players[:, BODY] = rng.uniform(-180.0, 180.0, size=n_players)
    if rng.random() < 0.5:
        players[:, BODY] = 15.0 * np.round(players[:, BODY] / 15.0)
    memory[:] = 0.0
    memory[:, columns.SEEN] = now
    memory[:, columns.NEXT_X : columns.NEXT_Y + 1] = ball[2:] * rng.normal(1.0, 0.05)
    memory[setup.keepers :, columns.NEXT_X : columns.NEXT_Y + 1] *= -1.0
    memory[:, columns.CHASED] = now - rng.integers(3)
    path = ball[:2] + ball[2:] * rng.uniform(0.0, 10.0) + rng.normal(scale=0.3, size=2)
    memory[:, columns.POINT_X : columns.POINT_Y + 1] = path
    memory[setup.keepers :, columns.POINT_X : columns.POINT_Y + 1] *= -1.0
    memory[: setup.keepers, columns.DECIDED] = now - rng.integers(2)
    memory[: setup.keepers, columns.LAST_ACTION] = rng.integers(setup.keepers)


def _overlap(players: NDArray[np.float64], ball: NDArray[np.float64]) -> bool:
    things = np.vstack([players[:, :2], ball[:2]])
    gaps = np.linalg.norm(things[:, np.newaxis] - things, axis=2)[np.triu_indices(len(things), 1)]
    return bool(np.any(gaps < 0.385))


def _vector(rng: np.random.Generator, shortest: float, longest: float) -> NDArray[np.float64]:
    angle = rng.uniform(-np.pi, np.pi)
    vector: NDArray[np.float64] = rng.uniform(shortest, longest) * np.array([np.cos(angle), np.sin(angle)])
    return vector


def _state(games: Games) -> State:
    now = int(games.counters[0, TIME])
    return State(now, games.players[0].copy(), games.ball[0].copy(), games.memory[0].copy())


def _twin_memory(memory: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return memories of the players as the twin keeps them, (n, twin's columns)."""
    known = np.zeros((len(memory), remembered.N_MEMORY))
    known[:, list(_COLUMNS)] = memory[:, list(_COLUMNS.values())]
    known[:, remembered.LAST_TIME] -= 1
    return known


def _compare(games: Games, work: Work, setup: Setup, state: State, policy: int) -> Comparison:
    """Compare the present cycle, whose commands are chosen."""
    decided = games.memory[0, :, columns.DECIDED] == state.time + 1
    actions = np.where(decided, games.memory[0, :, columns.LAST_ACTION], NO_ACTION).astype(np.int64)
    answer, memory = ask_twin(setup, state, actions)
    views = work.views - answer.views
    views[:, :, BODY] = (views[:, :, BODY] + 180.0) % 360.0 - 180.0
    hand_coded = np.where(answer.hand_coded >= 0, answer.hand_coded, actions)
    differences = {
        "views": views,
        "balls": work.balls - answer.balls,
        "commands": games.commands[0] - answer.commands,
        "memories": _twin_memory(games.memory[0]) - memory,
        "decisions": (hand_coded - actions) * (policy == HAND),
    }
    differs = tuple(name for name, values in differences.items() if not np.all(np.abs(values) <= TOLERANCE))
    return Comparison(state, actions, games.commands[0].copy(), answer.commands, differs)
