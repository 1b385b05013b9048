"""The Gymnasium face of the corridor: wiring only."""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping
from typing import Any, SupportsIndex, final

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range, one_of
from relforest.worlds.corridor.actions import ACTION_TYPES, DIRECTIONS
from relforest.worlds.corridor.dynamics import NOISE, STEP_LENGTH, next_location
from relforest.worlds.corridor.reward import WINDOW, reward
from relforest.worlds.corridor.scene import SCHEMA, decision, scene
from relforest.worlds.corridor.state import CorridorState, initial_state
from relforest.worlds.corridor.viewer import CorridorViewer

_Arrays = dict[str, NDArray[Any]]
_Info = dict[str, Any]


@final
class CorridorEnv(gymnasium.Env[dict[str, Any], np.int64]):
    """An agent in a corridor of length 1 that is paid for ending its steps close to either edge.

    Observation: ``location`` (1, 1) float64 and ``mask`` (1,) int8, always 1, as the agent is always there.
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
        Steps per episode, at least 1.

    Raises
    ------
    InputError
        If an option lies outside its range, an action is neither 0 nor 1, or a reset option is unknown.
    gymnasium.error.ResetNeeded
        On any use before the first `reset`, and on a step after the end of an episode.

    References
    ----------
    Palmer (2015), section 7.3.1.

    Examples
    --------
    >>> env = gymnasium.make("relforest/Corridor-v0", render_mode="rgb_array")
    >>> observation, info = env.reset(seed=0, options={"x": 0.3})
    >>> observation, reward, terminated, truncated, info = env.step(0)
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012 - Gymnasium's type
    schema = SCHEMA
    action_types = ACTION_TYPES
    discount = 0.9

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        noise: float = NOISE,
        step_length: float = STEP_LENGTH,
        window: float = WINDOW,
        max_steps: int = 10,
    ) -> None:
        self.noise = in_range("noise", noise, 0.0, math.inf, open_high=True)
        self.step_length = in_range("step_length", step_length, 0.0, 1.0, open_low=True)
        self.window = in_range("window", window, 0.0, 0.5)
        self.max_steps = at_least("max_steps", max_steps, 1)
        if render_mode is not None:
            one_of("render_mode", render_mode, self.metadata["render_modes"])
        self.render_mode = render_mode
        location = spaces.Box(0.0, 1.0, (1, 1), np.float64)
        self.observation_space = spaces.Dict({"location": location, "mask": spaces.MultiBinary(1)})
        self.action_space = spaces.Discrete(len(ACTION_TYPES))
        self._state: CorridorState | None = None
        self._viewer: CorridorViewer | None = None

    @property
    def state(self) -> CorridorState:
        """The present state, an immutable value."""
        if self._state is None:
            raise ResetNeeded("the corridor has no state yet: call reset() first")
        return self._state

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[_Arrays, _Info]:
        """Begin an episode at a uniform location, or at ``options["x"]``."""
        super().reset(seed=seed)
        options = options or {}
        if not options.keys() <= {"x"}:
            raise InputError(f"reset options of the corridor are 'x' (0 to 1) only, got {dict(options)!r}")
        start = in_range("x", options["x"], 0.0, 1.0) if options else None
        self._state = initial_state(self.np_random) if start is None else CorridorState(start)
        return self._observe(self._state)

    def step(self, action: SupportsIndex) -> tuple[_Arrays, float, bool, bool, _Info]:
        """Take one step to the left (0) or to the right (1)."""
        if self.state.steps >= self.max_steps:
            raise ResetNeeded(f"the episode ended after {self.max_steps} steps: call reset() first")
        disturbance = self.np_random.normal(0.0, self.noise)
        x = next_location(self.state.x, _direction(action), disturbance, step_length=self.step_length)
        self._state = CorridorState(float(x), self.state.steps + 1)
        observation, info = self._observe(self._state)
        info["duration"] = 1.0
        paid = reward(self._state.x, window=self.window)
        return observation, paid, False, self._state.steps >= self.max_steps, info

    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""
        return decision(self.state)

    def render(self) -> NDArray[np.uint8]:
        """Return a picture of the present state, (height, width, 3) uint8 RGB."""
        if self.render_mode is None:
            raise InputError('nothing to render with: make the environment with render_mode="rgb_array"')
        if self._viewer is None:
            self._viewer = CorridorViewer(window=self.window, max_steps=self.max_steps)
        return self._viewer.draw(self.state)

    def _observe(self, state: CorridorState) -> tuple[_Arrays, _Info]:
        # New arrays every time: callers may keep and change what they are given.
        observation = {"location": np.array([[state.x]]), "mask": np.ones(1, dtype=np.int8)}
        return observation, {"scene": scene(state), "action_mask": np.ones(len(ACTION_TYPES), dtype=np.int8)}


def _direction(action: SupportsIndex) -> float:
    try:
        return DIRECTIONS[range(len(DIRECTIONS)).index(operator.index(action))]
    except (TypeError, ValueError):
        raise InputError(f"action must be 0 (left) or 1 (right), got {action!r}") from None
