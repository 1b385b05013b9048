"""Policies that were learned in run folders, ready to play games that are recorded."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import gymnasium
import numpy as np
from numpy.typing import NDArray

from relforest.experiments.keepaway_team import Team
from relforest.experiments.sarsa import is_run_of_sarsa, trained_team
from relforest.rl.peers import TileCoding
from relforest.rl.rpi import SMRFRPI
from relforest.rl.value import ValueFunction
from relforest.runs.store import CHECKPOINT
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds import environment_id
from relforest.worlds.keepaway.recorder import Decider
from relforest.worlds.keepaway.scene import decision, describe, objects
from relforest.worlds.keepaway.variables import by_distance, n_variables, state_variables

_WORLD: Final = "keepaway"


@final
@dataclass(frozen=True, slots=True, eq=False)
class TeamDecider:
    """Every keeper has its own Sarsa agent."""

    team: Team

    def decide(
        self,
        players: NDArray[np.float64],
        ball: NDArray[np.float64],
        actor: int,
        rng: np.random.Generator,
    ) -> tuple[int, NDArray[np.float64]]:
        """Return a best action and the values of all."""
        keepers, agent = len(self.team), self.team[actor]
        variables = np.empty(n_variables(keepers, len(players) - keepers))
        state_variables(players, ball, keepers, variables)
        return agent.greedy(variables, rng), agent.values(variables)


@final
@dataclass(frozen=True, slots=True, eq=False)
class AgentDecider:
    """All keepers follow what SMRF-RPI has learned, whatever their number."""

    value: ValueFunction
    keepers: int

    def decide(
        self,
        players: NDArray[np.float64],
        ball: NDArray[np.float64],  # noqa: ARG002 - the holder has it
        actor: int,
        rng: np.random.Generator,
    ) -> tuple[int, NDArray[np.float64]]:
        """Return a best action and the values of all."""
        values = self.value.values(scene_decision(players, self.keepers, actor))
        best = np.flatnonzero(values == values.max())
        return int(best[0] if len(best) == 1 else rng.choice(best)), values


def scene_decision(players: NDArray[np.float64], keepers: int, actor: int) -> Decision:
    """Return what a relational learner sees when a keeper must decide among players (n, 5)."""
    receivers = np.empty(keepers - 1, dtype=np.int64)
    by_distance(players, actor, 0, receivers)
    matrix = objects(keepers, len(players) - keepers)
    describe(players, matrix)
    return decision(matrix, actor, receivers)


def learned_policy(folder: Path, keepers: int, takers: int) -> Decider:
    """Return the policy of a run folder of ``relforest learn keepaway``.

    Parameters
    ----------
    folder : path
        Of a single run.
    keepers, takers : int
        How many will play. Sarsa plays only with the numbers it was learned with, SMRF-RPI with any.

    Raises
    ------
    InputError
        If the folder does not contain such a run, or Sarsa was learned with other numbers of players.
    ModelFormatError
        If a file in it is damaged.
    """
    has_run = (folder / CHECKPOINT).exists()
    if has_run and is_run_of_sarsa(folder):
        team = trained_team(folder)
        if len(team) != keepers:
            raise InputError(
                f"{folder} contains a team of {len(team)} keepers, not {keepers}: choose --keepers"
            )
        there, here = team[0].features, n_variables(keepers, takers)
        if isinstance(there, TileCoding) and there.n_variables != here:
            learned = takers + (there.n_variables - here) // 2
            raise InputError(f"{folder} was learned against {learned} takers, not {takers}: choose --takers")
        return TeamDecider(team)
    if has_run:
        env = gymnasium.make(environment_id(_WORLD), disable_env_checker=True)
        return AgentDecider(SMRFRPI.load(folder, env).value_, keepers)
    if (folder / "run-00").is_dir():
        raise InputError(
            f"{folder} contains several runs: give the folder of one, such as {folder / 'run-00'}"
        )
    raise InputError(f"{folder} is not a run of keepaway: give the folder of 'relforest learn keepaway'")
