"""SMRF-RPI: an agent that repeatedly gathers experience and learns trees and a policy from it.

This is the experience loop of Palmer (2015), Algorithm 6.1; `relforest.rl.rounds` is the loop inside it.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, final

from relforest.rl.checkpoint import TIMINGS, Progress, Row, RunFolder
from relforest.rl.configuration import check_configuration, check_world, describe_run, restore_run
from relforest.rl.experience import Experience
from relforest.rl.policy import EpsilonGreedyPolicy, GreedyPolicy, Policy, RandomPolicy
from relforest.rl.policy_file import check_policy, slugs, tree_name
from relforest.rl.rollout import Environment, rollout, world_of
from relforest.rl.rounds import improve
from relforest.rl.samples import draw_samples
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction, action_schemas
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError, RunFolderError
from relforest.support.files import append_line
from relforest.support.locks import FolderLock
from relforest.support.options import at_least
from relforest.support.parallel import checked_jobs, one_blas_thread
from relforest.support.progress import part, printed_to_stderr, report
from relforest.support.rng import RandomState, seed_sequence, stream

_TRAINING, _TESTING, _SAMPLING, _LEARNING = 0, 1, 2, 3

Timings = dict[str, float]
OnIteration = Callable[[Row, Timings], None]


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
        verbose: bool = False,
    ) -> None:
        if not isinstance(verbose, bool):
            raise InputError(f"verbose must be True or False, got {verbose!r}")
        if settings is not None and not isinstance(settings, RPISettings):
            raise InputError(f"settings must be RPISettings(...), got {settings!r}")
        checked_jobs(n_jobs)
        world = world_of(env)
        self.env = env
        self.settings = settings or RPISettings()
        self.n_jobs = n_jobs
        self.verbose = verbose
        self._seed = seed_sequence(random_state)
        self._adopts_seed = random_state is None
        self._folder = None if checkpoint is None else RunFolder(checkpoint)
        value = ValueFunction.zero(world.schema, world.action_types, self.settings.features)
        self._progress = Progress(value, ((),) * len(world.action_types), (), ())
        self._configuration: dict[str, Any] | None = None

    @property
    def value_(self) -> ValueFunction:
        """The action-value function learned so far."""
        return self._progress.value

    @property
    def metrics_(self) -> list[Row]:
        """A row per iteration, with the keys `checkpoint.METRIC_NAMES`; row 0 = before learning."""
        return [dict(row) for row in self._progress.metrics]

    @property
    def experience_(self) -> tuple[Experience, ...]:
        """The batches of training experience, one per iteration."""
        return self._progress.batches

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
        with printed_to_stderr(self.verbose), one_blas_thread():
            if self._folder is None:
                self._configuration = describe_run(
                    self.env, self.settings, self._seed, (episodes, test_episodes)
                )
                self._advance(iterations, episodes, test_episodes, on_iteration)
                return self
            with FolderLock(self._folder.path):
                self._resume(self._folder, episodes, test_episodes)
                self._advance(iterations, episodes, test_episodes, on_iteration)
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
        check_world(self._progress.value, env)
        with printed_to_stderr(self.verbose), one_blas_thread():
            played = rollout(env, GreedyPolicy(self._progress.value), episodes, seed_sequence(seed))
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
        if self._configuration is None:
            raise InputError("nothing has been learned yet: call learn first")
        target = RunFolder(path)
        # Before the lock too, because taking it makes a file.
        _ = target.holds_run
        with FolderLock(path):
            if target.holds_run:
                found, configuration = target.read()
                check_configuration(configuration, self._configuration, target.path)
                if found.iteration > self._progress.iteration:
                    raise RunFolderError(
                        f"{path} contains this run at iteration {found.iteration}, later than the agent's "
                        f"{self._progress.iteration}; choose another folder"
                    )
            target.write(self._progress, self._configuration)
            target.repair(self._progress)

    @classmethod
    def load(cls, path: str | os.PathLike[str], env: Environment) -> SMRFRPI:
        """Read an agent from a run folder, even of a running or an interrupted run.

        Parameters
        ----------
        path : path
            A folder written by `save` or by learning with ``checkpoint``.
        env : gymnasium.Env
            A world with the same attributes and action types; the numbers of objects may differ.

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
        stored = RunFolder(path)
        progress, configuration = stored.read()
        check_policy(path)
        check_world(progress.value, env)
        seed, settings = restore_run(configuration, stored.path)
        agent = cls(env, settings=settings, random_state=seed)
        agent._progress, agent._configuration = progress, configuration
        return agent

    def _resume(self, folder: RunFolder, episodes: int, test_episodes: int) -> None:
        """Load the run folder, after checking that it contains the same run."""
        if not folder.holds_run:
            self._configuration = describe_run(self.env, self.settings, self._seed, (episodes, test_episodes))
            return
        progress, configuration = folder.read()
        if self._adopts_seed:
            self._seed = restore_run(configuration, folder.path)[0]
        self._configuration = describe_run(self.env, self.settings, self._seed, (episodes, test_episodes))
        check_configuration(configuration, self._configuration, folder.path)
        check_world(progress.value, self.env)
        folder.repair(progress)
        self._progress = progress

    def _advance(
        self, iterations: int, episodes: int, test_episodes: int, on_iteration: OnIteration | None
    ) -> None:
        while self._progress.iteration < iterations:
            number = self._progress.iteration + 1
            begin = perf_counter()
            with part(f"iteration {number}"):
                progress = self._progress if number == 0 else self._iterate(number, episodes)
                learned = perf_counter()
                progress = self._measure(progress, number, test_episodes)
            tested = perf_counter()
            if self._folder is not None and self._configuration is not None:
                self._folder.write(progress, self._configuration)
            self._progress = progress
            seconds = {
                "learning": learned - begin,
                "testing": tested - learned,
                "writing": perf_counter() - tested,
            }
            if self._folder is not None:
                pairs = ", ".join(f'"{name}": {time:.6f}' for name, time in seconds.items())
                append_line(self._folder.path / TIMINGS, f'{{"iteration": {number}, {pairs}}}')
            if on_iteration is not None:
                on_iteration(dict(progress.metrics[-1]), seconds)

    def _iterate(self, number: int, episodes: int) -> Progress:
        """Gain training experience and learn from it."""
        before, settings, seed = self._progress, self.settings, stream(self._seed, number)
        world = world_of(self.env)
        policy: Policy = RandomPolicy()
        if number > 1:
            policy = EpsilonGreedyPolicy(GreedyPolicy(before.value), settings.epsilon)
        with part("training"):
            batches = (*before.batches, rollout(self.env, policy, episodes, stream(seed, _TRAINING)))
        report("collecting samples")
        samples = draw_samples(
            batches,
            action_schemas(world.schema, world.action_types),
            discount=world.discount,
            max_samples=settings.max_samples,
            bootstrap_on_truncation=settings.bootstrap_on_truncation,
            seed=stream(seed, _SAMPLING),
        )
        value = improve(
            before.value, samples, settings=settings, seed=stream(seed, _LEARNING), n_jobs=self.n_jobs
        )
        names = tuple(
            (*old, *(tree_name(number, slug, i + 1) for i in range(len(trees) - len(old))))
            for old, slug, trees in zip(
                before.tree_names, slugs(world.action_types), value.forests, strict=True
            )
        )
        return replace(before, value=value, tree_names=names, batches=batches)

    def _measure(self, progress: Progress, number: int, test_episodes: int) -> Progress:
        """Append the row of an iteration, measured by test episodes."""
        seed = stream(self._seed, number, _TESTING)
        with part("testing"):
            tested = rollout(self.env, GreedyPolicy(progress.value), test_episodes, seed)
        trained = progress.batches[-1].episode_rewards if number > 0 else None
        row = {
            "iteration": number,
            "test_reward": float(tested.episode_rewards.mean()),
            "train_reward": None if trained is None else float(trained.mean()),
            "trees": progress.value.n_trees,
            "leaves": progress.value.n_leaves,
        }
        return replace(progress, metrics=(*progress.metrics, row))
