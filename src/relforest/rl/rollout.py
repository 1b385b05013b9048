"""The loop between a policy and a world: episodes in, experience out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final, Protocol, SupportsFloat, final

import numpy as np

from relforest.rl.experience import BoolArray, Experience
from relforest.rl.policy import LockstepPolicy, Policy
from relforest.runs.learner import Row
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import Decisions, Lockstep, LockstepWorld, Outcomes, RefiningWorld, World
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import part, report
from relforest.support.rng import generator, stream
from relforest.support.threads import in_threads

_RESET, _CHOICES = 0, 1

MOST_TOGETHER: Final = 1000
"""Episodes that are played together, if the world offers it."""


class Environment(Protocol):
    """The part of a Gymnasium environment that learners use; its ``unwrapped`` is a `World`."""

    @property
    def unwrapped(self) -> object:
        """The innermost environment."""
        ...

    def reset(self, *, seed: int | None = None) -> tuple[object, dict[str, Any]]:
        """Begin an episode."""
        ...

    def step(self, action: int, /) -> tuple[object, SupportsFloat, bool, bool, dict[str, Any]]:
        """Take an action of the flat ``Discrete`` space."""
        ...


def world_of(env: Environment) -> World:
    """Return the world inside an environment.

    Raises
    ------
    InputError
        If ``env.unwrapped`` does not implement `relforest.smdp.World`.
    """
    world = env.unwrapped
    if not isinstance(world, World):
        raise InputError(
            f"SMRF-RPI cannot learn {type(world).__name__}: a world needs schema, action_types, "
            "discount and decision(), see relforest.smdp.World"
        )
    return world


def rollout(
    env: Environment, policy: Policy, episodes: int, seed: np.random.SeedSequence, n_jobs: int = 1
) -> Experience:
    """Play episodes and return everything that happened.

    Parameters
    ----------
    env : Environment
        A Gymnasium environment whose ``unwrapped`` is a `World`; wrappers are fine.
    policy : Policy
        Chooses the actions.
    episodes : int
        How many, at least 1.
    seed : numpy.random.SeedSequence
        Episode ``i`` uses two streams named by ``i``, one for the world and one for the policy.
    n_jobs : int
        Threads for episodes that are played together.

    Notes
    -----
    Episodes are played together if the world and the policy offer it (`LockstepWorld`, `LockstepPolicy`) and
    no wrapper but those of ``gymnasium.make`` is around the world. The result is the same.

    Raises
    ------
    InputError
        If the world breaks the conventions of `relforest.smdp`; the message says which.

    References
    ----------
    Palmer (2015), section 6.3 (gathering experience).
    """
    world, episodes = world_of(env), at_least("episodes", episodes, 1)
    report("episodes", 0, episodes)
    log = _Log(type(world).__name__, np.zeros((2, episodes)))
    begin = world.lockstep if isinstance(world, LockstepWorld) and _is_bare(env) else None
    if begin is None or not isinstance(policy, LockstepPolicy):
        for number in range(episodes):
            _, info = env.reset(seed=reset_seed(seed, number))
            log.before[:, number] = [info.get(f"{name}_before", 0.0) for name in ("reward", "duration")]
            _play(env, policy, choices(seed, number), number, log)
            log.add_ended(1)
        return log.experience()

    def play(first: int, end: int, stop: BoolArray) -> None:
        numbers = range(first, end)
        games = begin([reset_seed(seed, number) for number in numbers])
        _play_together(games, policy, [choices(seed, number) for number in numbers], first, log, stop)

    in_threads(play, episodes, n_jobs, size=min(MOST_TOGETHER, -(-episodes // n_jobs)))
    return log.experience()


def tested(
    env: Environment,
    policy: Policy,
    episodes: int,
    seed: np.random.SeedSequence,
    batches: Sequence[Experience],
    size: tuple[int, int],
    n_jobs: int,
) -> Row:
    """Play test episodes and return the metrics of an iteration, see `relforest.runs.Learner.evaluate`.

    `batches` are the training experience so far, `size` the numbers of trees and leaves of the policy.
    """
    with part("testing"):
        rewards = rollout(env, policy, episodes, seed, n_jobs).episode_rewards
    trained = float(batches[-1].episode_rewards.mean()) if batches else None
    trees, leaves = size
    return {
        "test_reward": float(rewards.mean()), "train_reward": trained, "trees": trees, "leaves": leaves,
    }  # fmt: skip


def reset_seed(seed: np.random.SeedSequence, number: int) -> int:
    """Return the seed of the world in an episode of `rollout`."""
    # Worlds written in other languages may accept only 32 bits.
    return int(stream(seed, number, _RESET).generate_state(1)[0])


def choices(seed: np.random.SeedSequence, number: int) -> np.random.Generator:
    """Return the numbers that a policy draws from in an episode of `rollout`."""
    return generator(stream(seed, number, _CHOICES))


def _is_bare(env: Environment) -> bool:
    """Return whether no wrapper changes what happens in the world, or needs to see it."""
    if env is env.unwrapped:
        return True
    from gymnasium.wrappers import OrderEnforcing, PassiveEnvChecker  # noqa: PLC0415 - loaded, as there is a wrapper

    inner: Any = env
    while type(inner) in (OrderEnforcing, PassiveEnvChecker):
        inner = inner.env
    return inner is env.unwrapped


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Log:
    """What happened in a world, in the order of time."""

    world: str
    before: FloatArray
    """Rewards and durations before the first decision of each episode, (2, e)."""
    states: list[tuple[IntArray, Decisions]] = field(default_factory=list)
    """The numbers of some episodes, and a state of each."""
    steps: list[tuple[IntArray, IntArray, Outcomes]] = field(default_factory=list)
    """Their numbers, the positions of the actions, and what they brought."""
    ended: list[int] = field(default_factory=list)
    """Numbers of episodes that ended together."""

    def add_states(self, numbers: IntArray, decisions: Decisions) -> None:
        self.states.append((numbers, decisions))

    def add_ended(self, count: int) -> None:
        self.ended.append(count)
        report("episodes", sum(self.ended), self.before.shape[1])

    def stuck(self) -> InputError:
        return InputError(f"{self.world} offers no action in a state that does not end the episode")

    def add_steps(self, numbers: IntArray, positions: IntArray, outcomes: Outcomes) -> None:
        """Note what happened in steps, after a check of their durations."""
        durations = outcomes.durations
        is_right = (durations >= 0.0) & (durations < np.inf)
        if not is_right.all():
            raise InputError(
                f'{self.world} must report a finite info["duration"] of at least 0 after a step, '
                f"got {durations[~is_right].tolist()[0]}"
            )
        self.steps.append((numbers, positions, outcomes))

    def experience(self) -> Experience:
        numbers, decisions = zip(*self.states, strict=True)
        owners, positions, outcomes = zip(*self.steps, strict=True)
        return experience_of(
            Decisions.joined(decisions),
            np.concatenate(numbers),
            np.concatenate(owners),
            np.concatenate(positions),
            Outcomes(*map(np.concatenate, zip(*outcomes, strict=True))),
            self.before,
        )


def _play(env: Environment, policy: Policy, rng: np.random.Generator, number: int, log: _Log) -> None:
    """Play the episode that has begun."""
    world = world_of(env)
    is_refined, decisions, ended = isinstance(world, RefiningWorld), [world.decision()], False
    positions: list[int] = []
    steps: list[tuple[float, float, float, bool, bool]] = []
    while not ended:
        if not len(decisions[-1]):
            raise log.stuck()
        positions.append(policy.choose(decisions[-1], rng))
        if is_refined:
            decisions[-1] = world.decision()
        action = int(decisions[-1].indices[positions[-1]])
        _, reward, terminal, truncated, info = env.step(action)
        decisions.append(world.decision())
        discounted, duration = info.get("discounted_reward", reward), info.get("duration", np.nan)
        ended = bool(terminal or truncated)
        steps.append((float(reward), float(discounted), float(duration), bool(terminal), bool(truncated)))
    log.add_states(np.full(len(decisions), number), Decisions.of(decisions))
    log.add_steps(
        np.full(len(steps), number),
        np.array(positions),
        Outcomes(*map(np.array, zip(*steps, strict=True))),
    )


def _play_together(
    games: Lockstep,
    policy: LockstepPolicy,
    rngs: Sequence[np.random.Generator],
    first: int,
    log: _Log,
    stop: BoolArray,
) -> None:
    """Play episodes to their ends, or until ``stop[0]`` becomes true; they are numbered from `first`."""
    running = np.arange(len(rngs))
    log.before[:, first + running] = games.before
    decisions = games.decisions(running)
    log.add_states(first + running, decisions)
    while len(running) and not stop[0]:
        if not decisions.n_actions.all():
            raise log.stuck()
        positions = policy.choose_all(decisions, [rngs[i] for i in running.tolist()])
        outcomes = games.step(running, decisions.indices[decisions.candidates[:-1] + positions])
        log.add_steps(first + running, positions, outcomes)
        decisions = games.decisions(running)
        log.add_states(first + running, decisions)
        ended = outcomes.terminal | outcomes.truncated
        if ended.any():
            running, decisions = running[~ended], decisions.take(np.flatnonzero(~ended))
            log.add_ended(int(ended.sum()))


def experience_of(
    states: Decisions,
    episodes: IntArray,
    owners: IntArray,
    positions: IntArray,
    outcomes: Outcomes,
    before: FloatArray,
) -> Experience:
    """Return what happened in columns, sorted by episode.

    Parameters
    ----------
    states : Decisions
        Of all episodes, those of the same one in the order of time: one more than it has steps.
    episodes : (s,) int64
        The episode of each state; episodes are numbered from 0.
    owners, positions : (n,) int64
        The episode of each step, and the position of the action that was taken.
    outcomes : Outcomes
        What the steps brought.
    before : (2, e) float64
        Reward and duration of each episode before its first decision.
    """
    order = np.argsort(owners, kind="stable")
    totals = before.copy()
    np.add.at(totals[0], owners, outcomes.rewards)
    np.add.at(totals[1], owners, outcomes.durations)
    states = states.take(np.argsort(episodes, kind="stable"))
    owners = owners[order]
    # Each episode has one more state than steps.
    places = np.arange(len(owners)) + owners
    return Experience(
        matrix=states.matrix,
        objects=states.objects,
        private=states.private,
        remaining=states.remaining,
        candidates=states.candidates,
        types=states.types,
        arguments=states.arguments,
        states=places,
        next_states=places + 1,
        actions=states.candidates[places] + positions[order],
        rewards=outcomes.discounted[order],
        durations=outcomes.durations[order],
        terminal=outcomes.terminal[order],
        truncated=outcomes.truncated[order],
        episode_rewards=totals[0],
        episode_durations=totals[1],
    )
