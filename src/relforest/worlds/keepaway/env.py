"""The Gymnasium environment of keepaway."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, final

import numpy as np

from relforest.playing.frames import Frame, Stage
from relforest.playing.shapes import Words
from relforest.smdp import Decision, Lockstep
from relforest.support.rng import seed_sequence
from relforest.worlds.arguments import RENDER_MODES
from relforest.worlds.environment import Arrays, Info, Policies, Step, WorldEnv
from relforest.worlds.keepaway.decisions.policies import HandCodedPolicy, HoldPolicy, RandomPolicy
from relforest.worlds.keepaway.decisions.scene import ACTION_TYPES, NOBODY, SCHEMA
from relforest.worlds.keepaway.frames import game_frame, game_stage, player_chip
from relforest.worlds.keepaway.play.batch import DISCOUNT, END_NAMES, Batch
from relforest.worlds.keepaway.play.lockstep import LockstepGames
from relforest.worlds.keepaway.server.layout import CAPPED, OUT, PLAYING, SECOND, TAKEN
from relforest.worlds.keepaway.server.options import KeepawayOptions
from relforest.worlds.keepaway.spaces import action_space, observation_space
from relforest.worlds.viewing import viewable


@final
class KeepawayEnv(WorldEnv):
    """Keepers pass a ball among themselves for as long as they can; takers try to get it.

    One step is one decision of whichever keeper has the ball within reach: 0 = hold, i = pass to its i-th
    nearest teammate. The step lasts until a keeper must decide again, which may be in the same cycle if two
    keepers can reach the ball; all other players, and a keeper in the middle of a pass, follow the scripts of
    the benchmark. An episode begins with its first decision. It terminates when the ball is out or taken, and
    is truncated after ``max_cycles``. Without a seed, `reset` keeps the body directions of the players.

    Observation: the players as the deciding keeper perceives them, keepers first: ``location`` (n, 2) in
    metres, ``orientation`` (n, 1) in radians, ``color`` (n, 3) and ``mask`` (n,), all 1. At the end of an
    episode it shows their true state. Reward: the elapsed cycles of 0.1 s.

    In addition to the entries that `relforest.smdp` requires, ``info`` contains

    - ``actor``: the keeper that must decide, -1 after a terminal state. After a truncation, this is the
      keeper nearest to the ball, so that the value of its actions can be used.
    - ``time``: cycles since the episode began. The ``time`` of the first decision, after a reset also in
      ``duration_before`` and ``reward_before``, plus all rewards is the length of the episode. ``actor`` and
      ``time`` identify each keeper's own experience.
    - ``last_times`` (keepers,): when each keeper last had the ball in this episode, before this moment; -1 =
      not yet. This may be later than its last decision: a cycle in which it finished a pass counts too, as
      for the benchmark's learners, which receive the reward ``time - last_times[actor]``.
    - ``variables``: the state variables of the benchmark, see `decisions.variables`.
    - ``without_decision``, after a reset: the number of episodes that were skipped because they ended before
      any keeper had the ball.
    - ``end``, at the end: ``"out"``, ``"taken"`` or ``"capped"``.

    Parameters
    ----------
    render_mode : {"rgb_array"}, optional
        Whether `render` returns pictures.
    keepers, takers, size, perception, stuck_ball, max_cycles
        The rules of the game, see `KeepawayOptions`.

    Raises
    ------
    InputError
        If an option is out of range, an action does not exist, a seed is invalid, or a reset has options.
    gymnasium.error.ResetNeeded
        On any use before the first `reset`, and on a step after the end of an episode.

    References
    ----------
    Stone, Kuhlmann, Taylor, and Liu (2006), "Keepaway soccer: from machine learning testbed to benchmark".
    Palmer (2015), section 7.5.1.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("relforest/Keepaway-v0", keepers=4, takers=3, size=25.0)
    >>> observation, info = env.reset(seed=0)
    >>> observation, reward, terminated, truncated, info = env.step(0)
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 10}  # noqa: RUF012 - Gymnasium's type
    schema = SCHEMA
    action_types = ACTION_TYPES
    discount = DISCOUNT
    unit = "cycle"
    action_meaning = "0: hold, i: pass to the i-th nearest teammate"

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        keepers: int = 3,
        takers: int = 2,
        size: float | tuple[float, float] = 20.0,
        perception: str = "quantised",
        stuck_ball: int = 0,
        max_cycles: int = 0,
    ) -> None:
        super().__init__(render_mode)
        self.setup = KeepawayOptions(keepers, takers, size, perception, stuck_ball, max_cycles).setup()
        self.observation_space = observation_space(self.setup)
        self.action_space = action_space(self.setup)
        self._batch = Batch(self.setup, 1)
        # When which keeper passed to whom, or held.
        self._choice = (0, NOBODY, NOBODY)

    @property
    def batch(self) -> Batch:
        """The game, as a batch of one."""
        self._check_begun()
        return self._batch

    def decision(self) -> Decision:
        """Return the players and the available ground actions of the present state."""
        return self.batch.decision(0)

    @property
    def lockstep(self) -> Callable[[Sequence[int]], Lockstep] | None:
        """What begins an episode for each of several seeds; None if somebody watches this one."""
        return partial(LockstepGames, self.setup, self.discount) if self._watching is None else None

    @property
    def policies(self) -> Policies:
        """The benchmark's policies."""
        return {"hand": HandCodedPolicy(), "hold": HoldPolicy(), "random": RandomPolicy()}

    @property
    def stage(self) -> Stage:
        """The field."""
        return game_stage(self.setup)

    def say(self, position: int) -> Words:
        """Return an action in words, such as "1 passes to 2"."""
        action, keepers = self.decision().action(position), self.setup.keepers
        actor, *receiver = (player_chip(player, keepers) for player in action.arguments)
        return (actor, " passes to ", *receiver) if receiver else (actor, " holds")

    def named(self, position: int) -> tuple[str, Words]:
        """Return the key of the thing that an object is, and its name: the number of a player."""
        return f"player {position}", (player_chip(position, self.setup.keepers),)

    def _begin(self, seed: int | None, options: Mapping[str, Any]) -> tuple[Arrays, Info]:  # noqa: ARG002 - the hook's
        self._choice = (0, NOBODY, NOBODY)
        if seed is None and self._begun:
            self._batch.begin([None], self._watching)
        else:
            self._batch.begin([seed_sequence(self.np_random if seed is None else seed)], self._watching)
        info = self._info()
        info["without_decision"] = int(self._batch.seen.skipped[0])
        info["duration_before"] = info["reward_before"] = float(info["time"])
        return self._observation(), info

    def _act(self, action: int) -> Step:
        batch = self._batch
        receiver = int(batch.seen.receivers[0, action - 1]) if action else NOBODY
        self._choice = (int(batch.times[0]), int(batch.seen.actors[0]), receiver)
        batch.play(np.array([action]), self._watching)
        end, elapsed, info = int(batch.ends[0]), float(batch.seen.elapsed[0]), self._info()
        info["duration"], info["discounted_reward"] = elapsed, float(batch.discounted(self.discount)[0])
        if end != PLAYING:
            info["end"] = END_NAMES[end]
        return self._observation(), elapsed, end in (OUT, TAKEN), end == CAPPED, info

    def _ended(self) -> int | None:
        return None if self._batch.ends[0] == PLAYING else int(self._batch.times[0])

    def _frame(self) -> Frame:
        time, actor, receiver = self._choice
        # A pass is shown for half a second: by then the ball is on its way.
        lately = self._batch.times[0] - time <= (1 if receiver == NOBODY else SECOND // 2)
        return game_frame(self._batch, 0, (actor, receiver) if lately else None)

    def _observation(self) -> Arrays:
        return {name: array[0] for name, array in self._batch.observation().items()}

    def _info(self) -> Info:
        info: Info = {name: array[0] for name, array in self._batch.info().items()}
        info["actor"], info["time"] = int(info["actor"]), int(info["time"])
        return info | {"scene": self._batch.scenes()}


make_keepaway = viewable(KeepawayEnv)
"""The entry point for ``gymnasium.make``."""
