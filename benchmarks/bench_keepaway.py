"""Keepaway: game cycles a second, and agreement of the compiled players with their plain twin."""

from __future__ import annotations

import time
from collections.abc import Sequence
from itertools import product

import numpy as np
from clock import median_seconds
from peers import keepaway, keepaway_agreement
from table import Cell, Table

from relforest.worlds.keepaway import KeepawayOptions, play_episodes
from relforest.worlds.keepaway.play.advance import HAND, HOLD, RANDOM

GAMES = ((3, 2, 20.0), (4, 3, 25.0), (5, 4, 30.0), (6, 5, 35.0))
"""Keepers, takers, and the side of the field in metres."""

POLICIES = {"random": RANDOM, "hold": HOLD, "hand": HAND}
CYCLES = 30_000
TWIN_CYCLES = 400
REPEATS = 3

COMPARED: tuple[tuple[int, int, float | tuple[float, float]], ...] = (
    (3, 2, 20.0),
    (4, 3, 25.0),
    (6, 5, (35.0, 25.0)),
)
COMPARED_CYCLES = 100_000
STATES = 2_000
EVERY = 3


def name_of(keepers: int, takers: int) -> str:
    """Return what a game is called, such as ``3v2``."""
    return f"{keepers}v{takers}"


def cycles_a_second(policy: str, options: KeepawayOptions) -> float:
    """Return the median speed of whole games in one thread: server, players, decisions and counting."""
    first = play_episodes(policy, options, 64, seed=0)
    episodes = 64 * max(1, round(CYCLES / int(first.durations.sum())))
    speeds = []
    for seed in range(REPEATS):
        before = time.process_time()
        cycles = int(play_episodes(policy, options, episodes, seed=seed).durations.sum())
        speeds.append(cycles / (time.process_time() - before))
    return float(np.median(speeds))


def twin_cycles_a_second(policy: str, options: KeepawayOptions) -> float:
    """Return the speed of the twin's players alone, in states of such games."""
    setup = options.setup()
    compared = keepaway_agreement.compare_games(setup, POLICIES[policy], cycles=TWIN_CYCLES, every=EVERY)

    def play(comparisons: Sequence[keepaway_agreement.Comparison]) -> None:
        for comparison in comparisons:
            keepaway_agreement.ask_twin(setup, comparison.state, comparison.actions)

    return TWIN_CYCLES / median_seconds(play, [compared] * REPEATS)


def measure_speed(keepers: int, takers: int, size: float, policy: str) -> tuple[Cell, ...]:
    """Time games with the compiled players and with their twin."""
    options = KeepawayOptions(keepers=keepers, takers=takers, size=size)
    compiled = cycles_a_second(policy, options)
    plain = twin_cycles_a_second(policy, options)
    return name_of(keepers, takers), size, policy, compiled / 1e3, plain / 1e3, compiled / plain


def measure_agreement() -> tuple[tuple[Cell, ...], ...]:
    """Count the commands on which both differ, in sampled cycles of games and in random states."""
    cases = tuple(product(COMPARED, ("quantised", "exact", "fullstate"), POLICIES))
    rows: list[tuple[Cell, ...]] = []
    for (keepers, takers, size), perception, policy in cases:
        options = KeepawayOptions(
            keepers=keepers, takers=takers, size=size, perception=perception, stuck_ball=100
        )
        cycles = -(-COMPARED_CYCLES // len(cases))
        setup, code = options.setup(), POLICIES[policy]
        sampled = keepaway_agreement.compare_games(setup, code, cycles=cycles, every=EVERY, seed=1)
        states = keepaway_agreement.compare_states(setup, code, states=STATES, seed=1)
        counts = (*counts_of(sampled), *counts_of(states))
        rows.append((name_of(keepers, takers), perception, policy, *counts))
    sums = np.array([row[3:] for row in rows], dtype=np.int64).sum(axis=0)
    rows.append(("all", "", "", *(int(count) for count in sums)))
    return tuple(rows)


def counts_of(compared: Sequence[keepaway_agreement.Comparison]) -> tuple[int, int, int, int]:
    """Return the numbers of cycles, commands, commands that differ, and cycles that do in anything."""
    commands = sum(len(comparison.commands) for comparison in compared)
    differing = sum(comparison.n_differing for comparison in compared)
    return len(compared), commands, differing, sum(bool(comparison.differs) for comparison in compared)


def run() -> tuple[Table, Table]:
    """Measure speed and agreement."""
    speeds = tuple(measure_speed(*game, policy) for game, policy in product(GAMES, ("random", "hand")))
    columns = ("game", "side m", "policy", "k cycles/s", "twin k cycles/s", "times faster")
    aim = (
        "Aim: at least 30 k cycles/s of 3v2 and 15 k of 4v3. Whole games in one thread, server and counting\n"
        f"included. The twin ({keepaway.__name__}) is compiled too, but has only the players' programs."
    )
    compared = (
        "game",
        "perception",
        "policy",
        "cycles",
        "commands",
        "commands differ",
        "cycles differ",
        "states",
        "their commands",
        "differ",
        "states differ",
    )
    agreement_aim = (
        f"Aim: none differ. Every {EVERY}rd cycle of games, and random states that games hardly reach.\n"
        "A cycle differs if a view, a command, a memory or a decision of the hand-coded policy does."
    )
    return (
        Table("keepaway", aim, columns, speeds),
        Table("keepaway-agreement", agreement_aim, compared, measure_agreement()),
    )


if __name__ == "__main__":
    for table in run():
        table.report()
