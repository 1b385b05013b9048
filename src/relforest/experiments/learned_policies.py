"""Policies that were learned in run folders, ready to play."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.keepaway_team import Team
from relforest.experiments.methods import METHODS, Method
from relforest.experiments.sarsa import trained_team
from relforest.experiments.vectors import vector_value
from relforest.playing.reasons import Explanation
from relforest.rl.baselines import SarsaLambda, TileCoding
from relforest.rl.configuration import check_world
from relforest.rl.explaining import explanation
from relforest.rl.fitted.value import QValue
from relforest.rl.frozen import ForestFeatures
from relforest.rl.policy import GreedyPolicy
from relforest.rl.practice import ANYHOW, Practice
from relforest.rl.refinement import Search
from relforest.rl.saved_policy import AnyValue, read_policy
from relforest.runs.store import CHECKPOINT, read_checkpoint
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision, Decisions
from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.variables import n_variables
from relforest.worlds.keepaway.env import KeepawayEnv

if TYPE_CHECKING:
    import gymnasium


@final
@dataclass(frozen=True, slots=True, eq=False)
class TeamPolicy:
    """Every keeper has its own Sarsa agent, which sees the state variables or the decision."""

    team: Team
    world: KeepawayEnv

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of a best action; there is one for each keeper, in their order."""
        agent, seen = self._asked(decision)
        return agent.greedy(seen, rng)

    def values(self, decision: Decision) -> NDArray[np.float64]:
        """Return the values of all actions, (n_actions,)."""
        agent, seen = self._asked(decision)
        return agent.values(seen)

    def _asked(self, decision: Decision) -> tuple[SarsaLambda[Any], Decision | NDArray[np.float64]]:
        """Return the agent that must decide, and what it sees."""
        seen = self.world.batch.seen
        agent = self.team[int(seen.actors[0])]
        return agent, decision if isinstance(agent.features, ForestFeatures) else seen.variables[0].copy()


@final
@dataclass(frozen=True, slots=True, eq=False)
class AgentPolicy:
    """What a relational learner has learned, whatever the number of objects.

    Where a world offers it, the policy searches for more actions before it chooses, unless `search` is None.
    """

    value: AnyValue
    env: gymnasium.Env[Any, Any]
    search: Search | None = ANYHOW.search

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a position of the highest value; consumes one integer from `rng` only to break a tie."""
        return Practice(search=self.search).tested(self.env, self.value).choose(decision, rng)

    def choose_all(self, decisions: Decisions, rngs: Sequence[np.random.Generator]) -> IntArray:
        """Return the choice for each decision, (n_decisions,)."""
        return GreedyPolicy(self.value).choose_all(decisions, rngs)

    def values(self, decision: Decision) -> NDArray[np.float64]:
        """Return the values of all actions, (n_actions,)."""
        return self.value.values(decision)

    def explain(self, decision: Decision, position: int) -> Explanation | None:
        """Return what speaks for an action and against it, see `relforest.rl.explaining.explanation`."""
        return explanation(self.value, decision, position)

    def with_questions(self, n: int) -> AgentPolicy:
        """Return the policy that asks the `n` questions that matter most for choosing.

        Raises
        ------
        InputError
            If `n` is negative, or the policy is no sum of questions.
        """
        if not isinstance(self.value, QValue):
            raise InputError("questions can only be left out of policies of smrf-q")
        return replace(self, value=self.value.with_questions(n))


LearnedPolicy: TypeAlias = TeamPolicy | AgentPolicy | GreedyPolicy


def trained_run(world: str) -> Path:
    """Return the folder of a run of smrf-q in this world that comes with the library, without experience."""
    return Path(__file__).with_name("trained") / world


def learned_policy(folder: Path, env: gymnasium.Env[Any, Any]) -> LearnedPolicy:
    """Return the policy of a run folder of ``relforest learn``.

    The run is a single one. Relational policies play any world with the attributes and action types that they
    were learned with; the others play keepaway, with as many players as they were learned with.

    Raises
    ------
    InputError
        If the folder does not contain a run, or its policy does not fit the world.
    ModelFormatError
        If a file in it is damaged.
    """
    policy: LearnedPolicy = resolve_name(method_of(folder).policy)(folder, env)
    return policy


def method_of(folder: Path) -> Method:
    """Return how the agent of a run folder learns.

    Raises
    ------
    InputError
        If the folder does not contain a run.
    ModelFormatError
        If its checkpoint is damaged.
    """
    if (folder / CHECKPOINT).exists():
        document = read_checkpoint(folder).document
        return next((each for each in METHODS.values() if each.mark in document), METHODS["smrf-rpi"])
    if (folder / "run-00").is_dir():
        raise InputError(
            f"{folder} contains several runs: give the folder of one, such as {folder / 'run-00'}"
        )
    raise InputError(f"{folder} is not a run: give a folder of 'relforest learn'")


def agent_policy(folder: Path, env: gymnasium.Env[Any, Any]) -> AgentPolicy:
    """Return what a relational learner has learned; see `learned_policy`."""
    value = read_policy(folder)
    check_world(value.schema, value.action_types, env)
    return AgentPolicy(value, env)


def vector_policy(folder: Path, env: gymnasium.Env[Any, Any]) -> GreedyPolicy:
    """Return what fitted Q on vectors has learned; see `learned_policy`."""
    return GreedyPolicy(vector_value(folder, env)[1])


def team_policy(folder: Path, env: gymnasium.Env[Any, Any]) -> TeamPolicy:
    """Return what Sarsa has learned; see `learned_policy`."""
    team, world = trained_team(folder), env.unwrapped
    if not isinstance(world, KeepawayEnv):
        raise InputError(f"{folder} was learned by Sarsa, which plays keepaway only: play keepaway")
    keepers, takers = world.setup.keepers, world.setup.takers
    if len(team) != keepers:
        raise InputError(f"{folder} contains a team of {len(team)} keepers, not {keepers}: choose --keepers")
    there, here = team[0].features, n_variables(keepers, takers)
    if isinstance(there, TileCoding) and there.n_variables != here:
        learned = takers + (there.n_variables - here) // 2
        raise InputError(f"{folder} was learned against {learned} takers, not {takers}: choose --takers")
    return TeamPolicy(team, world)
