"""The base of the Gymnasium environments of all worlds: reset, step, masks and rendering."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, ClassVar, SupportsIndex

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from relforest.playing.frames import Frame, Stage
from relforest.playing.recorder import Policy
from relforest.playing.shapes import Words
from relforest.smdp import ActionType, Decision
from relforest.support.errors import InputError
from relforest.worlds.arguments import (
    Check,
    checked_action,
    checked_render_mode,
    checked_reset_options,
    checked_seed,
)

Arrays = dict[str, NDArray[Any]]
Info = dict[str, Any]
Step = tuple[Arrays, float, bool, bool, Info]
Policies = Mapping[str, Policy]


class WorldEnv(gymnasium.Env[dict[str, Any], np.int64], ABC):
    """An environment that checks all arguments before it changes anything.

    A world implements how an episode begins (`_begin`), what an action does (`_act`), when the episode has
    ended (`_ended`), and how it looks (`stage` and `_frame`), which gives pictures and pages.

    Parameters
    ----------
    render_mode : {"rgb_array"}, optional
        Whether `render` returns pictures.

    Raises
    ------
    InputError
        If an option, an action, a seed or a reset option is invalid.
    gymnasium.error.ResetNeeded
        On any use before the first `reset`, and on a step after the end of an episode.
    """

    observation_space: spaces.Dict
    action_space: spaces.Discrete
    action_types: tuple[ActionType, ...]
    unit: ClassVar[str]
    """The unit of the length of an episode."""
    action_meaning: ClassVar[str] = ""
    """What the numbers of the actions mean."""
    reset_options: ClassVar[Mapping[str, Check]] = MappingProxyType({})
    """Name of each option of `reset` -> function that checks its value and returns it."""

    def __init__(self, render_mode: str | None) -> None:
        self.render_mode = checked_render_mode(render_mode)
        self._begun = False
        self._see: Callable[[Frame], None] | None = None

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Arrays, Info]:
        """Begin an episode, with the `reset_options` that are given.

        The same seed, at least 0, gives the same episodes. Without one, the random numbers continue.
        """
        chosen, seed = checked_reset_options(options, self.reset_options), checked_seed(seed)
        super().reset(seed=seed)
        result = self._begin(seed, chosen)
        self._begun = True
        self._show()
        return result

    def step(self, action: SupportsIndex) -> Step:
        """Take an action of the flat space: a Python or NumPy integer."""
        self.check_running()
        result = self._act(checked_action(action, int(self.action_space.n), self.action_meaning))
        self._show()
        return result

    @abstractmethod
    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which actions are available, (n_actions,), in the form that masking learners expect.

        The mask agrees with ``info["action_mask"]``. Wrappers do not forward this method: use
        ``env.get_wrapper_attr("action_masks")()``.
        """
        masks = np.zeros(int(self.action_space.n), dtype=np.bool_)
        masks[self.decision().indices] = True
        return masks

    def render(self) -> NDArray[np.uint8]:
        """Return a picture of the present state, (height, width, 3) uint8 RGB."""
        if self.render_mode is None:
            raise InputError('render() needs a render mode: make the world with render_mode="rgb_array"')
        self._check_begun()
        from relforest.playing.painter import paint  # noqa: PLC0415 - most uses need no pictures

        return paint(self.stage, self._frame())

    def watch(self, see: Callable[[Frame], None] | None) -> None:
        """From now on pass ``see`` a frame whenever something may have moved; None: stop."""
        self._see = see

    def say(self, position: int) -> Words:
        """Return an available action in words: its name and its objects."""
        action = self.decision().action(position)
        return (" ".join((self.action_types[action.type].name, *map(str, action.arguments))),)

    def _show(self) -> None:
        if self._see is not None:
            self._see(self._frame())

    @property
    def _watching(self) -> Callable[[], None] | None:
        """What a world calls while time passes, if somebody watches."""
        return None if self._see is None else self._show

    def _check_begun(self) -> None:
        if not self._begun:
            raise ResetNeeded("no episode has begun: call reset() first")

    def check_running(self) -> None:
        """Raise `ResetNeeded` if no episode is under way."""
        self._check_begun()
        length = self._ended()
        if length is not None:
            counted = f"{length} {self.unit}{'' if length == 1 else 's'}"
            raise ResetNeeded(f"the episode ended after {counted}: call reset() first")

    @abstractmethod
    def _begin(self, seed: int | None, options: Mapping[str, Any]) -> tuple[Arrays, Info]:
        """Begin an episode and return what `reset` returns; ``np_random`` has been seeded."""

    @abstractmethod
    def _act(self, action: int) -> Step:
        """Take an action of the space while an episode runs."""

    @abstractmethod
    def _ended(self) -> int | None:
        """Return the length of the episode in `unit` if it has ended, otherwise None."""

    @property
    @abstractmethod
    def policies(self) -> Policies:
        """The policies that come with this world, by name; some look at the environment itself."""

    @property
    @abstractmethod
    def stage(self) -> Stage:
        """What all frames of this world have in common."""

    @abstractmethod
    def _frame(self) -> Frame:
        """Return what there is to see at present."""
