"""Continues a game until a keeper must decide."""

from __future__ import annotations

from typing import Final

import numpy as np

from relforest.support.jit import kernel
from relforest.worlds.keepaway.decisions.policies import hand_coded
from relforest.worlds.keepaway.decisions.variables import state_variables
from relforest.worlds.keepaway.play.events import Tally, count_events
from relforest.worlds.keepaway.players.memory import continues_pass
from relforest.worlds.keepaway.players.roles import command_keeper, command_taker
from relforest.worlds.keepaway.players.views import Work, in_reach, observe
from relforest.worlds.keepaway.server.layout import END, NEXT, PLAYING, Games, Setup
from relforest.worlds.keepaway.server.physics import execute
from relforest.worlds.keepaway.server.randomness import below
from relforest.worlds.keepaway.server.referee import judge

RANDOM: Final = 0
HOLD: Final = 1
HAND: Final = 2
ASK: Final = 3

NO_ACTION: Final = -1
NOBODY: Final = -1
UNFINISHED: Final = -2

FOREVER: Final = 2**62


@kernel
def advance(
    games: Games,
    g: int,
    setup: Setup,
    policy: int,
    action: int,
    work: Work,
    tally: Tally | None = None,
    cycles: int = FOREVER,
) -> int:
    """Continue game ``g`` until a keeper must decide or the episode is over.

    Parameters
    ----------
    games : Games
        Changed in place.
    g : int
        Number of the game.
    setup : Setup
        What the games have in common.
    policy : int
        What decides for keepers: RANDOM, HOLD or HAND, or ASK to return at each decision.
    action : int
        The answer to the last question: 0 = hold, i = pass to the i-th nearest teammate; -1 = none. It is
        ignored if no keeper was asked, and the question is repeated if the answer is missing.
    work : Work
        Must be the one that served when the question was asked, not used for another game since.
    tally : Tally, optional
        Counts events.
    cycles : int
        How many cycles to play at most.

    Returns
    -------
    int
        The keeper that must decide, or -1 if the episode is over; ``games.counters[g, END]`` then says how,
        the state is the last one, and `place` begins the next episode. -2 if ``cycles`` have passed.
    """
    answer = action
    for _ in range(cycles):
        if games.counters[g, END] != PLAYING:
            break
        actor = choose_commands(games, g, setup, policy, answer, work)
        if actor != NOBODY:
            return actor
        answer = NO_ACTION
        # Without a tally, the compiler leaves this out.
        if tally is not None:
            count_events(games, g, setup, tally)
        execute(games, g, setup)
        judge(games, g, setup)
    return UNFINISHED if games.counters[g, END] == PLAYING else NOBODY


@kernel
def choose_commands(games: Games, g: int, setup: Setup, policy: int, action: int, work: Work) -> int:
    """Let all players choose their commands for one cycle, in the order of their numbers.

    Returns the keeper that must decide first, or -1 when all commands are chosen. The
    parameters are those of `advance`.
    """
    counters, n_players = games.counters, setup.keepers + setup.takers
    answer = action
    if counters[g, NEXT] == 0:
        observe(games, g, setup, work)
        counters[g, NEXT] = 1
        answer = NO_ACTION
    for i in range(counters[g, NEXT] - 1, n_players):
        if i >= setup.keepers:
            command_taker(games, g, i, setup, work)
        elif in_reach(work, i) and not continues_pass(games, g, i):
            if policy != ASK:
                answer = _decision(games, g, i, setup, policy, work)
            if answer == NO_ACTION:
                counters[g, NEXT] = i + 1
                return i
            command_keeper(games, g, i, answer, setup, work)
            answer = NO_ACTION
        else:
            command_keeper(games, g, i, NO_ACTION, setup, work)
    counters[g, NEXT] = 0
    return NOBODY


@kernel
def _decision(games: Games, g: int, i: int, setup: Setup, policy: int, work: Work) -> int:
    if policy == RANDOM:
        return below(games.streams, g, setup.keepers)
    if policy == HAND:
        variables = np.empty(4 * setup.keepers + 2 * setup.takers - 3)
        state_variables(work.views[i], work.balls[i], setup.keepers, variables)
        return hand_coded(variables, setup.keepers, setup.takers)
    return 0
