"""The PettingZoo environment of keepaway: every keeper is an agent. It needs the extra ``pettingzoo``."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any, Final, SupportsIndex, Unpack, final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.arguments import checked_action, checked_reset_options
from relforest.worlds.keepaway.decisions.scene import NOBODY
from relforest.worlds.keepaway.env import KeepawayEnv, make_keepaway
from relforest.worlds.keepaway.server.options import Rules

try:
    from pettingzoo import ParallelEnv
except ImportError as error:
    raise ImportError(
        "the multi-agent version of keepaway needs PettingZoo: pip install 'relforest[pettingzoo]'"
    ) from error

_Observation = dict[str, Any]
_Observations = dict[str, _Observation]
_Infos = dict[str, dict[str, Any]]

_MEANING: Final = f"{KeepawayEnv.action_meaning}; the last one: wait"


@final
class KeepawayParallelEnv(ParallelEnv[str, _Observation, int]):  # type: ignore[misc]  # it ships no types
    """Keepaway with the keepers as agents, ``"keeper_0"``, ``"keeper_1"``, ...; takers belong to the world.

    A step lasts from one decision to the next, as in `KeepawayEnv`, and one keeper decides at a time.
    Its actions are those of `KeepawayEnv`: 0 = hold, i = pass to its i-th nearest teammate. All others can
    only wait, which is the last action, number ``keepers``; it may be omitted.

    Each agent observes ``"observation"``, the players as the deciding keeper perceives them, and
    ``"action_mask"``, its available actions. Keepers are a team: the reward of each is the number of elapsed
    cycles, so a keeper's total reward between two of its decisions is the time between them. All ``infos``
    are those of `KeepawayEnv`.

    Parameters
    ----------
    render_mode : {"rgb_array", "human"}, optional
        ``"rgb_array"``: `render` returns pictures; ``"human"``: every state is shown in a window.
    **rules
        The rules of the game: keepers, takers, size, perception, stuck_ball and max_cycles, see
        `KeepawayOptions`.

    Raises
    ------
    InputError
        If an option is out of range, an action is unavailable, such as a pass by a keeper without the ball,
        the action of the deciding keeper is missing, or an agent does not exist.
    gymnasium.error.ResetNeeded
        On any use before the first `reset`, and on a step after the end of an episode.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - PettingZoo's type
        "name": "relforest/Keepaway-v0",
        "render_modes": KeepawayEnv.metadata["render_modes"],
        "render_fps": KeepawayEnv.metadata["render_fps"],
        "is_parallelizable": True,
    }

    def __init__(self, render_mode: str | None = None, **rules: Unpack[Rules]) -> None:
        self._env = make_keepaway(render_mode, **rules)
        self._game: KeepawayEnv = self._env.unwrapped  # type: ignore[assignment]
        self.render_mode, keepers = render_mode, self._game.setup.keepers
        self.possible_agents = [f"keeper_{i}" for i in range(keepers)]
        self.agents: list[str] = []
        self.wait = keepers
        """The action of all keepers but the deciding one."""
        observed = {
            "observation": self._game.observation_space,
            "action_mask": spaces.MultiBinary(keepers + 1),
        }
        self.observation_spaces = {agent: spaces.Dict(observed) for agent in self.possible_agents}
        self.action_spaces = {agent: spaces.Discrete(keepers + 1) for agent in self.possible_agents}

    def observation_space(self, agent: str) -> spaces.Dict:
        """Return the space of what an agent observes."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Discrete:
        """Return the space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[_Observations, _Infos]:
        """Begin an episode. Unknown options are ignored, as PettingZoo requires."""
        checked_reset_options(options, None)
        observation, info = self._env.reset(seed=seed)
        self.agents = list(self.possible_agents)
        return self._observations(observation, info["actor"]), self._infos(info)

    def step(
        self, actions: Mapping[str, SupportsIndex]
    ) -> tuple[_Observations, dict[str, float], dict[str, bool], dict[str, bool], _Infos]:
        """Let the deciding keeper act and the others wait, until a keeper must decide again."""
        self._game.check_running()
        observation, reward, terminated, truncated, info = self._env.step(self._chosen(actions))
        # A keeper stands in as the actor after a truncation, but has nothing to decide any more.
        actor = NOBODY if truncated else info["actor"]
        observations, agents = self._observations(observation, actor), self.agents
        if terminated or truncated:
            self.agents = []
        return (
            observations,
            dict.fromkeys(agents, float(reward)),
            dict.fromkeys(agents, terminated),
            dict.fromkeys(agents, truncated),
            self._infos(info),
        )

    def render(self) -> Any:  # noqa: ANN401 - what the render mode says
        """Return a picture of the present state, (height, width, 3) uint8 RGB; None with a window."""
        return self._env.render()

    def close(self) -> None:
        """Close the window, if one is open."""
        self._env.close()

    def state(self) -> NDArray[np.float64]:
        """Return the true state: x, y, vx, vy, body of every player, then x, y, vx, vy of the ball."""
        games = self._game.batch.games
        return np.concatenate([games.players[0].ravel(), games.ball[0]])

    def _chosen(self, actions: Mapping[str, SupportsIndex]) -> int:
        """Return what the deciding keeper does, or raise `InputError`."""
        if not isinstance(actions, Mapping):
            raise InputError(f"actions must be a mapping from agents to actions, got {actions!r}")
        if not actions.keys() <= set(self.possible_agents):
            raise InputError(f"actions must belong to {', '.join(self.possible_agents)}, got {list(actions)}")
        actor = int(self._game.batch.seen.actors[0])
        chosen = self.wait
        for i, agent in enumerate(self.possible_agents):
            action = checked_action(
                actions.get(agent, self.wait), self.wait + 1, _MEANING, f"the action of {agent}"
            )
            if i == actor:
                chosen = action
            elif action != self.wait:
                raise InputError(
                    f"{agent} can only wait ({self.wait}) while keeper_{actor} decides, got {action}"
                )
        if chosen == self.wait:
            raise InputError(f"keeper_{actor} must decide: pass its action, from 0 to {self.wait - 1}")
        return chosen

    def _observations(self, observation: _Observation, actor: int) -> _Observations:
        masks = np.zeros((self.wait, self.wait + 1), dtype=np.int8)
        masks[:, self.wait] = 1
        if actor != NOBODY:
            masks[actor] = 1 - masks[actor]
        return {
            agent: {"observation": copy.deepcopy(observation), "action_mask": mask}
            for agent, mask in zip(self.possible_agents, masks, strict=True)
        }

    def _infos(self, info: dict[str, Any]) -> _Infos:
        return {agent: dict(info) for agent in self.possible_agents}
