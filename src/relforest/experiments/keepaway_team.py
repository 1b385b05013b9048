"""A team of Sarsa agents plays keepaway, each keeper with its own agent and its own clock."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from relforest.rl.baselines import SarsaLambda, SarsaSettings, TileCoding, make_team
from relforest.rl.baselines.tile_coding import TileKind
from relforest.rl.frozen import ForestFeatures
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import report
from relforest.support.rng import RandomState, seed_sequence, stream
from relforest.worlds.keepaway.decisions.scene import decision, describe, objects
from relforest.worlds.keepaway.decisions.variables import (
    by_distance,
    n_variables,
    state_variables,
    tile_widths,
)
from relforest.worlds.keepaway.play.advance import ASK, NO_ACTION, NOBODY, advance
from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.players.memory import DECIDED
from relforest.worlds.keepaway.players.views import Work, new_work
from relforest.worlds.keepaway.server.layout import CAPPED, END, TIME, Games, Setup
from relforest.worlds.keepaway.server.options import KeepawayOptions
from relforest.worlds.keepaway.server.referee import place

Team: TypeAlias = Sequence[SarsaLambda[Any]]
"""Agents that see state variables or, with `ForestFeatures`, the decision."""


def benchmark_team(
    options: KeepawayOptions,
    settings: SarsaSettings | None = None,
    *,
    kind: TileKind = "tiles",
    shared: bool = False,
    random_state: RandomState = None,
) -> Team:
    """Return one untrained agent per keeper, with the tile coding of the benchmark or with bells.

    Bells stand a quarter of the benchmark's tile apart and have that as their standard deviation, so that a
    value is learned for about the same surroundings as with tiles.

    With `shared`, all learn from everyone's experience (Palmer (2015), section 7.5.2).

    References
    ----------
    Stone, Sutton and Kuhlmann (2005), "Reinforcement learning for RoboCup soccer keepaway".
    """
    widths = tile_widths(options.keepers, options.takers)
    if kind == "bells":
        coding = TileCoding([2.0 * width for width in widths], options.keepers, tilings=8, kind=kind)
    else:
        coding = TileCoding(widths, options.keepers)
    return make_team(coding, options.keepers, settings, shared=shared, random_state=random_state)


def scene_decision(players: NDArray[np.float64], keepers: int, actor: int) -> Decision:
    """Return what a relational learner sees when a keeper must decide among players (n, 5)."""
    receivers = np.empty(keepers - 1, dtype=np.int64)
    by_distance(players, actor, 0, receivers)
    matrix = objects(keepers, len(players) - keepers)
    describe(players, matrix)
    return decision(matrix, actor, receivers)


def renewed(team: Team, random_state: RandomState = None, *, learn: bool) -> Team:
    """Return agents with copies of the weights, shared as before, and new traces and random streams.

    Those that do not `learn` always take a best action.
    """
    seed, weights = seed_sequence(random_state), {id(agent.weights): agent.weights.copy() for agent in team}
    return [
        SarsaLambda(
            agent.features,
            agent.settings,
            weights=weights[id(agent.weights)],
            learn=learn,
            random_state=stream(seed, number),
        )
        for number, agent in enumerate(team)
    ]


def play_episodes_with(
    team: Team, options: KeepawayOptions, episodes: int, seed: np.random.SeedSequence
) -> NDArray[np.int64]:
    """Let the agents play; those that learn do so online.

    As in the benchmark, an agent's reward is the number of cycles since it last had the ball in reach, and
    nothing is discounted. The cycles in which it merely finishes a pass are therefore not credited.

    There is one agent per keeper, with a random stream of its own; the seed is that of the games.

    Return durations in cycles, (episodes,).

    Raises
    ------
    InputError
        If there is not one agent per keeper, or a number is out of range.
    """
    if len(team) != options.keepers:
        raise InputError(f"{options.keepers} keepers need as many agents, got {len(team)}")
    setup = options.setup()
    games, work = new_games(setup, [seed]), new_work(setup)
    durations = np.empty(at_least("episodes", episodes, 1), dtype=np.int64)
    for episode in range(episodes):
        report("episodes", episode, episodes)
        if episode > 0:
            place(games, 0, setup)
        _play_episode(team, games, setup, work)
        durations[episode] = games.counters[0, TIME]
    return durations


def _play_episode(team: Team, games: Games, setup: Setup, work: Work) -> None:
    clock, memory = games.counters[0], games.memory[0]
    variables = np.empty(n_variables(setup.keepers, setup.takers))
    is_relational = isinstance(team[0].features, ForestFeatures)
    seen: Decision | NDArray[np.float64] = variables
    has_decided = [False] * setup.keepers
    action = NO_ACTION
    while (actor := advance(games, 0, setup, ASK, action, work)) != NOBODY:
        if is_relational:
            seen = scene_decision(work.views[actor], setup.keepers, actor)
        else:
            state_variables(work.views[actor], work.balls[actor], setup.keepers, variables)
        if has_decided[actor]:
            elapsed = float(clock[TIME] + 1 - memory[actor, DECIDED])
            action = team[actor].step(elapsed, elapsed, seen)
        else:
            action = team[actor].start(seen)
            has_decided[actor] = True
    for agent, decided, row in zip(team, has_decided, memory, strict=False):
        if decided:
            elapsed = float(clock[TIME] + 1 - row[DECIDED])
            if clock[END] == CAPPED:
                # Cut short, not over: what would follow is worth what the last state seen promises.
                agent.step(elapsed, elapsed, seen)
            else:
                agent.end(elapsed)
