"""How a world is practised and tested, where that differs from random play in one environment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

from relforest.rl.configuration import environment_options
from relforest.rl.policy import ActionValues, Policy, RandomPolicy, exploring
from relforest.rl.refinement import BeamSearch, Search, SearchingPolicy
from relforest.rl.rollout import Environment, world_of
from relforest.smdp import RefiningWorld

_RANDOM = RandomPolicy()
_BEAM = BeamSearch()


@final
@dataclass(frozen=True, slots=True, eq=False)
class Practice:
    """What a task says of the way it is learned.

    Parameters
    ----------
    training : gymnasium.Env, optional
        Where training episodes are played. Default: where tests are.
    explorer : Policy
        Acts in training wherever an agent would otherwise act at random. One that looks at its world, and not
        only at decisions, is of no use where episodes are played together (`relforest.smdp.LockstepWorld`).
    beginner : Policy
        Acts in tests as long as nothing is known.
    search : Search, optional
        How to look for more actions, in worlds that offer it (`relforest.smdp.RefiningWorld`). None: never.

    References
    ----------
    Palmer (2015), section 7.4.3.
    """

    training: Environment | None = None
    explorer: Policy = _RANDOM
    beginner: Policy = _RANDOM
    search: Search | None = _BEAM

    def trainee(self, env: Environment, value: ActionValues | None, epsilon: float) -> Policy:
        """Return the policy for training episodes in an environment."""
        return self._searching(env, value, exploring(value, epsilon, self.explorer))

    def tested(self, env: Environment, value: ActionValues | None) -> Policy:
        """Return the policy for test episodes in an environment."""
        return self._searching(env, value, exploring(value, 0.0, self.beginner))

    def to_dict(self, env: Environment) -> dict[str, Any]:
        """Return what differs from random play in `env`, as plain JSON values; nothing if nothing does."""
        out: dict[str, Any] = {}
        if self.training is not None:
            out["training"] = environment_options(self.training)
        policies = {"explorer": self.explorer, "beginner": self.beginner}
        out |= {name: type(each).__name__ for name, each in policies.items() if each != _RANDOM}
        if self.search is not None and isinstance(world_of(env), RefiningWorld):
            out["search"] = self.search.to_dict()
        return {"practice": out} if out else {}

    def _searching(self, env: Environment, value: ActionValues | None, policy: Policy) -> Policy:
        world = world_of(env)
        if value is None or self.search is None or not isinstance(world, RefiningWorld):
            return policy
        return SearchingPolicy(policy, value, world, self.search)


ANYHOW: Final = Practice()
"""Random play until something is known, in one environment, with a beam search where it is possible."""
