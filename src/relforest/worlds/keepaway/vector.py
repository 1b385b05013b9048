"""The vectorised Gymnasium environment of keepaway: many games, one kernel call per step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, Unpack, final

import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from relforest.playing.painter import paint
from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.support.options import at_least, between
from relforest.support.rng import seed_sequence
from relforest.worlds.arguments import RENDER_MODES, checked_render_mode, checked_reset_options, checked_seed
from relforest.worlds.keepaway.decisions.scene import ACTION_TYPES, SCHEMA
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.frames import game_frame, game_stage
from relforest.worlds.keepaway.play.batch import DISCOUNT, END_NAMES, RESTART, Batch
from relforest.worlds.keepaway.server.layout import CAPPED, PLAYING
from relforest.worlds.keepaway.server.options import KeepawayOptions, Rules
from relforest.worlds.keepaway.spaces import action_space, observation_space

_Arrays = dict[str, NDArray[Any]]
_Infos = dict[str, Any]

MOST_GAMES: Final = 8192
"""The largest teams then need 2 GB of memory."""

MOST_THREADS: Final = 256
"""More than the cores of most machines."""


@final
class KeepawayVectorEnv(VectorEnv[dict[str, Any], NDArray[np.int64], NDArray[Any]]):
    """Many independent games of keepaway; each plays what `KeepawayEnv` would play with the same seed.

    Observations, rewards and flags are those of `KeepawayEnv`, stacked. ``infos`` contains the same entries
    as arrays of length ``num_envs``, each with a mask, prefixed with ``_``, of the games that have it. Scenes
    are left out: `scenes` returns those of all games at once. After the end of its episode, a game begins
    another one in the next step, ignoring its action, with a reward of 0 (``AutoresetMode.NEXT_STEP``). The
    games are divided between `n_threads` threads.

    Parameters
    ----------
    num_envs : int
        Number of games, 1 to 8192.
    n_threads : int
        Number of threads, 1 to 256; it does not affect the results.
    render_mode : {"rgb_array"}, optional
        Whether `render` returns pictures.
    **rules
        The rules of all games: keepers, takers, size, perception, stuck_ball and max_cycles, see
        `KeepawayOptions`.

    Raises
    ------
    InputError
        If an option is out of range, actions are not ``num_envs`` integers from 0 to keepers - 1, or a reset
        has invalid seeds or any options.
    gymnasium.error.ResetNeeded
        On a step before the first `reset`.

    Examples
    --------
    >>> import gymnasium
    >>> envs = gymnasium.make_vec("relforest/Keepaway-v0", num_envs=64, keepers=4, takers=3, size=25.0)
    >>> observations, infos = envs.reset(seed=0)
    >>> observations, rewards, terminations, truncations, infos = envs.step(np.zeros(64, dtype=np.int64))
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - Gymnasium's type
        "autoreset_mode": AutoresetMode.NEXT_STEP,
        "render_modes": list(RENDER_MODES),
        "render_fps": KeepawayEnv.metadata["render_fps"],
    }
    schema = SCHEMA
    action_types = ACTION_TYPES
    discount = DISCOUNT
    single_observation_space: spaces.Dict
    single_action_space: spaces.Discrete

    def __init__(
        self,
        num_envs: int = 1,
        *,
        n_threads: int = 1,
        render_mode: str | None = None,
        **rules: Unpack[Rules],
    ) -> None:
        self.setup = KeepawayOptions(**rules).setup()
        self.num_envs = between("num_envs", num_envs, 1, MOST_GAMES)
        self.render_mode = checked_render_mode(render_mode)
        threads = between("n_threads", n_threads, 1, MOST_THREADS)
        self.single_observation_space = observation_space(self.setup)
        self.single_action_space = action_space(self.setup)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._batch = Batch(self.setup, self.num_envs, threads)
        self._begun = False

    @property
    def batch(self) -> Batch:
        """The games."""
        if not self._begun:
            raise ResetNeeded("no episode has begun: call reset() first")
        return self._batch

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[_Arrays, _Infos]:
        """Begin an episode in every game.

        Parameters
        ----------
        seed : int or sequence of (int or None), optional
            One seed per game; an integer s gives game i the seed s + i. A game without a seed continues with
            its next episode.
        """
        checked_reset_options(options, {})
        seeds = self._seeds(seed)
        super().reset(seed=seeds[0] if isinstance(seed, (int, np.integer)) else None)
        self._batch.begin([self._seed_sequence(entry) for entry in seeds])
        self._begun = True
        infos = self._infos()
        self._add_beginnings(infos, np.ones(self.num_envs, dtype=np.bool_))
        return self._batch.observation(), infos

    def step(self, actions: ArrayLike) -> tuple[_Arrays, NDArray[Any], NDArray[Any], NDArray[Any], _Infos]:
        """Let the deciding keeper of each game hold (0) or pass to its i-th nearest teammate (i)."""
        batch = self.batch
        again = batch.ends != PLAYING
        batch.play(np.where(again, RESTART, self._checked(actions)))
        ends, rewards = batch.ends.copy(), batch.seen.elapsed.astype(np.float64)
        ended, truncated = ends != PLAYING, ends == CAPPED
        infos = self._infos()
        _add(infos, "duration", rewards.copy(), ~again)
        _add(infos, "discounted_reward", batch.discounted(self.discount), ~again)
        self._add_beginnings(infos, again)
        names = np.array([END_NAMES.get(end) for end in ends.tolist()], dtype=object)
        _add(infos, "end", names, ended)
        return batch.observation(), rewards, ended & ~truncated, truncated, infos

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which actions are available in each game, (num_envs, keepers), for learners that mask."""
        masks: NDArray[np.bool_] = self.batch.info()["action_mask"].astype(np.bool_)
        return masks

    def render(self) -> tuple[NDArray[np.uint8], ...]:
        """Return a picture of each game, (height, width, 3) uint8 RGB."""
        if self.render_mode is None:
            raise InputError('render() needs a render mode: make the games with render_mode="rgb_array"')
        stage = game_stage(self.setup)
        return tuple(paint(stage, game_frame(self.batch, g)) for g in range(self.num_envs))

    def close_extras(self) -> None:
        """Stop the threads."""
        self._batch.close()

    def scenes(self) -> Scenes:
        """Return the present scene of every game, as `Scenes` of length ``num_envs``."""
        return self.batch.scenes()

    def _infos(self) -> _Infos:
        infos: _Infos = {}
        for name, values in self._batch.info().items():
            _add(infos, name, values, np.ones(self.num_envs, dtype=np.bool_))
        return infos

    def _add_beginnings(self, infos: _Infos, begun: NDArray[np.bool_]) -> None:
        """Add what happened before the first decision of the games that have just begun."""
        _add(infos, "without_decision", np.where(begun, self._batch.seen.skipped, 0), begun)
        for name in ("duration_before", "reward_before"):
            _add(infos, name, np.where(begun, self._batch.times, 0.0), begun.copy())

    def _seeds(self, seed: object) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, np.ndarray):
            seed = seed.tolist()
        if isinstance(seed, Sequence) and not isinstance(seed, (str, bytes)):
            if len(seed) != self.num_envs:
                raise InputError(
                    f"seed must hold one seed for each of {self.num_envs} games, got {len(seed)}"
                )
            return [checked_seed(entry) for entry in seed]
        first = at_least("seed", seed, 0)
        return [first + i for i in range(self.num_envs)]

    def _seed_sequence(self, seed: int | None) -> np.random.SeedSequence | None:
        if seed is None:
            # Games that have not begun need a stream of their own.
            return None if self._begun else seed_sequence(self.np_random)
        return seed_sequence(seed)

    def _checked(self, actions: ArrayLike) -> NDArray[np.int64]:
        try:
            array, most = np.asarray(actions), self.setup.keepers - 1
        except ValueError as error:
            raise InputError(f"actions must be {self.num_envs} integers, one per game: {error}") from None
        if array.shape != (self.num_envs,) or array.dtype.kind not in "iu":
            raise InputError(
                f"actions must be integers of shape ({self.num_envs},), one per game, got {array.dtype} "
                f"of shape {array.shape}"
            )
        wrong = np.flatnonzero((array < 0) | (array > most))
        if len(wrong):
            raise InputError(
                f"actions must be from 0 (hold) to {most} (pass to the farthest teammate), got "
                f"{array[wrong[0]]} for game {wrong[0]}"
            )
        return array.astype(np.int64)


def _add(infos: _Infos, name: str, values: NDArray[Any], mask: NDArray[np.bool_]) -> None:
    """Add an entry if any game has it, as Gymnasium does."""
    if mask.any():
        infos[name], infos[f"_{name}"] = values, mask
