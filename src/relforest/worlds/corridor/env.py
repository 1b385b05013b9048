"""The Gymnasium environment of the corridor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final, final

import numpy as np
from gymnasium import spaces

from relforest.playing.frames import Frame, Stage
from relforest.playing.shapes import Words
from relforest.smdp import Decision
from relforest.support.options import between, in_range
from relforest.worlds.arguments import RENDER_MODES
from relforest.worlds.corridor.dynamics import (
    ACTION_TYPES,
    DIRECTIONS,
    NOISE,
    STEP_LENGTH,
    WINDOW,
    next_location,
    reward,
)
from relforest.worlds.corridor.frames import corridor_frame, corridor_stage
from relforest.worlds.corridor.policies import OptimalPolicy, RandomPolicy
from relforest.worlds.corridor.scene import SCHEMA, decision, scene
from relforest.worlds.corridor.state import CorridorState, initial_state
from relforest.worlds.environment import Arrays, Info, Policies, Step, WorldEnv
from relforest.worlds.viewing import viewable

MOST_STEPS: Final = 1_000_000
"""Steps of the longest episode that is allowed."""


def _checked_start(x: object) -> float:
    return in_range("x", x, 0.0, 1.0)


@final
class CorridorEnv(WorldEnv):
    """An agent in a corridor of length 1 that is rewarded for ending its steps close to either edge.

    Observation: ``location`` (1, 1) float64 and ``mask`` (1,) int8, always 1, as the agent is always present.
    Actions: 0 = left, 1 = right, always available. Reward: 1 if the step ends in a window at an edge, else 0.
    An episode starts at a uniform location, or at ``reset(options={"x": 0.3})``; it never terminates and is
    truncated after ``max_steps`` steps, each of duration 1.

    Parameters
    ----------
    render_mode : {"rgb_array"}, optional
        Whether `render` returns pictures.
    noise : float
        Standard deviation of the displacement, in corridor lengths, at least 0.
    step_length : float
        Mean length of a step, in corridor lengths, above 0 and at most 1.
    window : float
        Width of each rewarded window, in corridor lengths, from 0 to 0.5.
    max_steps : int
        Steps per episode, 1 to 1 000 000.

    Raises
    ------
    InputError
        If an option is out of range, an action is neither 0 nor 1, or a seed or reset option is invalid.
    gymnasium.error.ResetNeeded
        On any use before the first `reset`, and on a step after the end of an episode.

    References
    ----------
    Palmer (2015), section 7.3.1.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("relforest/Corridor-v0", render_mode="rgb_array")
    >>> observation, info = env.reset(seed=0, options={"x": 0.3})
    >>> observation, reward, terminated, truncated, info = env.step(0)
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 4}  # noqa: RUF012 - Gymnasium's type
    schema = SCHEMA
    action_types = ACTION_TYPES
    discount = 0.9
    unit = "step"
    action_meaning = "0: left, 1: right"
    reset_options = MappingProxyType({"x": _checked_start})

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        noise: float = NOISE,
        step_length: float = STEP_LENGTH,
        window: float = WINDOW,
        max_steps: int = 10,
    ) -> None:
        super().__init__(render_mode)
        self.noise = in_range("noise", noise, 0.0, math.inf, open_high=True)
        self.step_length = in_range("step_length", step_length, 0.0, 1.0, open_low=True)
        self.window = in_range("window", window, 0.0, 0.5)
        self.max_steps = between("max_steps", max_steps, 1, MOST_STEPS)
        location = spaces.Box(0.0, 1.0, (1, 1), np.float64)
        self.observation_space = spaces.Dict({"location": location, "mask": spaces.MultiBinary(1)})
        self.action_space = spaces.Discrete(len(ACTION_TYPES))
        self._state = CorridorState(0.0)

    @property
    def state(self) -> CorridorState:
        """The present state, an immutable value."""
        self._check_begun()
        return self._state

    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""
        return decision(self.state)

    @property
    def policies(self) -> Policies:
        """The optimal policy and the random one."""
        return {"optimal": OptimalPolicy(), "random": RandomPolicy()}

    @property
    def stage(self) -> Stage:
        """The floor."""
        return corridor_stage(self.window)

    def named(self, position: int) -> tuple[str, Words]:  # noqa: ARG002 - there is only one
        """Return the key of the thing that an object is, and its name."""
        return "agent", ("the agent",)

    def _begin(self, seed: int | None, options: Mapping[str, Any]) -> tuple[Arrays, Info]:  # noqa: ARG002 - the hook's
        self._state = CorridorState(options["x"]) if options else initial_state(self.np_random)
        return self._observe(self._state)

    def _act(self, action: int) -> Step:
        disturbance = self.np_random.normal(0.0, self.noise)
        x = next_location(self._state.x, DIRECTIONS[action], disturbance, step_length=self.step_length)
        self._state = CorridorState(float(x), self._state.steps + 1)
        observation, info = self._observe(self._state)
        info["duration"] = 1.0
        paid = reward(self._state.x, window=self.window)
        return observation, paid, False, self._state.steps >= self.max_steps, info

    def _ended(self) -> int | None:
        return self._state.steps if self._state.steps >= self.max_steps else None

    def _frame(self) -> Frame:
        return corridor_frame(self._state, window=self.window, max_steps=self.max_steps)

    def _observe(self, state: CorridorState) -> tuple[Arrays, Info]:
        # New arrays every time: callers may keep and change what they are given.
        observation = {"location": np.array([[state.x]]), "mask": np.ones(1, dtype=np.int8)}
        return observation, {"scene": scene(state), "action_mask": np.ones(len(ACTION_TYPES), dtype=np.int8)}


make_corridor = viewable(CorridorEnv)
"""The entry point for ``gymnasium.make``."""
