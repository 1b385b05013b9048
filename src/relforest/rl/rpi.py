"""SMRF-RPI for users: an agent that learns in a world, in memory or in a run folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from relforest.rl.configuration import check_world, restore_run
from relforest.rl.experience import Experience
from relforest.rl.learner import Knowledge, RPILearner
from relforest.rl.practice import ANYHOW, Practice
from relforest.rl.rollout import Environment, rollout, world_of
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction
from relforest.runs.learner import Row, Run, Seconds, advance
from relforest.runs.store import CHECKPOINT, RunStore, read_checkpoint, read_run
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError, RunFolderError
from relforest.support.locks import FolderLock
from relforest.support.notebook import drawn
from relforest.support.options import at_least
from relforest.support.parallel import checked_jobs, one_blas_thread
from relforest.support.progress import printed_to_stderr
from relforest.support.rng import RandomState, seed_sequence

OnIteration = Callable[[Row, Seconds], None]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """Episodes played with a learned policy, without exploration.

    Parameters
    ----------
    rewards : (e,) float64
        Undiscounted total reward of each episode.
    durations : (e,) float64
        Duration of each episode in the world's unit of time.
    """

    rewards: FloatArray
    durations: FloatArray

    _repr_html_ = drawn


@final
class SMRFRPI:
    """Relational policy learning with SMRF trees as features.

    Parameters
    ----------
    env : gymnasium.Env
        Its ``unwrapped`` implements `relforest.smdp.World`.
    settings : RPISettings, optional
        Default: those of the source.
    random_state : int, SeedSequence, Generator or None
        Seed of the whole run. None takes fresh entropy, or the seed of the run in `checkpoint`.
    n_jobs : int
        Candidate trees learned at the same time, in threads; -1 = all cores. The result does not depend on
        it.
    checkpoint : path, optional
        A run folder. Every iteration is written to it, and an interrupted run is resumed from it, with the
        same result.
    practice : Practice, optional
        How the world is practised and tested. Default: random play until something is known, in `env`, with a
        search where the world offers it.
    verbose : bool
        Print the stage of the work to standard error, at most one line a second. `relforest.listening` passes
        the same reports to a function.

    Raises
    ------
    InputError
        If the environment is not a world, or an option is out of its range.

    References
    ----------
    Palmer (2015), chapter 6, Algorithm 6.1.

    Examples
    --------
    >>> import gymnasium
    >>> import relforest
    >>> agent = relforest.SMRFRPI(gymnasium.make("relforest/Corridor-v0"), random_state=0)
    >>> evaluation = agent.learn(iterations=1, episodes=20).evaluate(agent.env, episodes=10, seed=1)
    """

    def __init__(
        self,
        env: Environment,
        *,
        settings: RPISettings | None = None,
        random_state: RandomState = None,
        n_jobs: int = 1,
        checkpoint: str | os.PathLike[str] | None = None,
        practice: Practice | None = None,
        verbose: bool = False,
    ) -> None:
        if not isinstance(verbose, bool):
            raise InputError(f"verbose must be True or False, got {verbose!r}")
        if settings is not None and not isinstance(settings, RPISettings):
            raise InputError(f"settings must be RPISettings(...), got {settings!r}")
        if practice is not None and not isinstance(practice, Practice):
            raise InputError(f"practice must be Practice(...), got {practice!r}")
        checked_jobs(n_jobs)
        world_of(env)
        self.env = env
        self.settings = settings or RPISettings()
        self.n_jobs = n_jobs
        self.verbose = verbose
        self._seed = seed_sequence(random_state)
        self._adopts_seed = random_state is None
        self._folder = None if checkpoint is None else Path(checkpoint)
        self._learner = RPILearner(env, self.settings, self._seed, 0, 0, n_jobs, practice or ANYHOW)
        self._run: Run[Knowledge] | None = None

    @property
    def value_(self) -> ValueFunction:
        """The action-value function learned so far."""
        return self._state.value

    @property
    def metrics_(self) -> list[Row]:
        """A row per iteration, with the keys `relforest.runs.METRIC_NAMES`; row 0 = before learning."""
        return [] if self._run is None else [dict(row) for row in self._run.metrics]

    @property
    def experience_(self) -> tuple[Experience, ...]:
        """The batches of training experience, one per iteration."""
        return self._state.batches

    @property
    def _state(self) -> Knowledge:
        return self._learner.start() if self._run is None else self._run.state

    def learn(
        self,
        iterations: int,
        episodes: int,
        *,
        test_episodes: int | None = None,
        on_iteration: OnIteration | None = None,
    ) -> SMRFRPI:
        """Learn until the agent has completed a number of iterations.

        Parameters
        ----------
        iterations : int
            Total number of iterations, at least 1: ``learn(2, 500)`` and then ``learn(5, 500)`` is the same
            as ``learn(5, 500)``, and a call that asks for no more than the agent already had changes nothing.
        episodes : int
            Episodes of training experience per iteration: uniformly random actions in the first iteration,
            epsilon-greedy ones later.
        test_episodes : int, optional
            Greedy episodes after each iteration, for `metrics_` only. Default: as many as `episodes`.
        on_iteration : callable, optional
            Called as ``on_iteration(row, seconds)`` after each iteration, including the 0th, once it is on
            disk.

        Returns
        -------
        SMRFRPI
            Itself.

        Raises
        ------
        InputError
            If a count is less than 1.
        RunFolderError
            If the run folder is in use, contains a run of another configuration, or is damaged.
        ModelFormatError
            If a file in the run folder is damaged.
        """
        iterations = at_least("iterations", iterations, 1)
        episodes = at_least("episodes", episodes, 1)
        test_episodes = episodes if test_episodes is None else at_least("test_episodes", test_episodes, 1)
        self._learner = replace(self._learner, episodes=episodes, test_episodes=test_episodes)
        with printed_to_stderr(self.verbose), one_blas_thread():
            if self._folder is None:
                self._advance(iterations, None, on_iteration)
                return self
            with FolderLock(self._folder):
                if self._adopts_seed and (self._folder / CHECKPOINT).exists():
                    self._seed = restore_run(read_checkpoint(self._folder).configuration, self._folder)[0]
                    self._learner = replace(self._learner, seed=self._seed)
                store = RunStore(self._folder, self._learner)
                self._run = store.resume()
                self._advance(iterations, store, on_iteration)
        return self

    def evaluate(self, env: Environment, episodes: int = 100, seed: RandomState = None) -> Evaluation:
        """Play greedy episodes; the numbers of objects may differ from those in training.

        Parameters
        ----------
        env : gymnasium.Env
            A world with the same attributes and action types.
        episodes : int
            How many, at least 1.
        seed : int, SeedSequence, Generator or None
            None takes fresh entropy.

        Raises
        ------
        InputError
            If the world has other attributes or action types.
        """
        check_world(self.value_.schema, self.value_.action_types, env)
        with printed_to_stderr(self.verbose), one_blas_thread():
            policy = self._learner.practice.tested(env, self.value_)
            played = rollout(env, policy, episodes, seed_sequence(seed))
        return Evaluation(played.episode_rewards, played.episode_durations)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write everything learned to a run folder, for `load` or for continuing in it.

        Parameters
        ----------
        path : path
            A new or empty folder, or one with an earlier stage of this run.

        Raises
        ------
        InputError
            If nothing has been learned yet.
        RunFolderError
            If the folder is in use, or contains another run, a later stage of this one or foreign files.
        """
        if self._run is None:
            raise InputError("nothing has been learned yet: call learn first")
        store = RunStore(path, self._learner)
        # Before the lock too, because taking it makes a file.
        _ = store.holds_run
        with FolderLock(path):
            found = store.resume()
            if found is not None and found.iteration > self._run.iteration:
                raise RunFolderError(
                    f"{path} contains this run at iteration {found.iteration}, later than the agent's "
                    f"{self._run.iteration}; choose another folder"
                )
            store.write(self._run)

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], env: Environment, *, practice: Practice | None = None
    ) -> SMRFRPI:
        """Read an agent from a run folder, even of a running or an interrupted run.

        Parameters
        ----------
        path : path
            A folder written by `save` or by learning with ``checkpoint``.
        env : gymnasium.Env
            A world with the same attributes and action types; the numbers of objects may differ.
        practice : Practice, optional
            How it goes on being practised.

        Returns
        -------
        SMRFRPI
            With the settings and the seed of the run. It continues in memory; to continue in the folder, make
            an agent with ``checkpoint=path`` instead.

        Raises
        ------
        ModelFormatError
            If a file is missing or malformed.
        InputError
            If the world has other attributes or action types.
        """
        folder, checkpoint = Path(path), read_checkpoint(path)
        seed, settings, episodes = restore_run(checkpoint.configuration, folder)
        agent = cls(env, settings=settings, random_state=seed, practice=practice)
        agent._learner = replace(agent._learner, episodes=episodes[0], test_episodes=episodes[1])
        agent._run = read_run(agent._learner, checkpoint, folder)
        return agent

    def _advance(
        self, iterations: int, store: RunStore[Knowledge] | None, on_iteration: OnIteration | None
    ) -> None:
        while self._run is None or self._run.iteration < iterations:
            run, seconds = advance(self._learner, self._run)
            if store is not None:
                store.write(run, seconds)
            self._run = run
            if on_iteration is not None:
                on_iteration(dict(run.metrics[-1]), seconds)
