"""The loop between a policy and a world: episodes in, experience out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Final, Protocol, SupportsFloat, final

import numpy as np

from relforest.rl.experience import Experience
from relforest.rl.policy import LockstepPolicy, Policy, choose_all
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decisions, Lockstep, LockstepWorld, Outcomes, World
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import report
from relforest.support.rng import generator, stream

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


def rollout(env: Environment, policy: Policy, episodes: int, seed: np.random.SeedSequence) -> Experience:
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
    begin, most = _beginning(env, world, policy)
    log = _Log(type(world).__name__, episodes)
    for first in range(0, episodes, most):
        numbers = range(first, min(first + most, episodes))
        # Worlds written in other languages may accept only 32 bits.
        seeds = [int(stream(seed, number, _RESET).generate_state(1)[0]) for number in numbers]
        rngs = [generator(stream(seed, number, _CHOICES)) for number in numbers]
        _play(begin(seeds), policy, rngs, first, log)
    return log.experience()


def _beginning(
    env: Environment, world: World, policy: Policy
) -> tuple[Callable[[Sequence[int]], Lockstep], int]:
    """Return what begins an episode for each seed, and how many at most."""
    if isinstance(world, LockstepWorld) and isinstance(policy, LockstepPolicy) and _is_bare(env):
        begin = world.lockstep
        if begin is not None:
            return begin, MOST_TOGETHER
    return partial(_Alone, env, world), 1


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
class _Alone:
    """An episode of an environment that plays one after the other, as a lockstep of its own."""

    def __init__(self, env: Environment, world: World, seeds: Sequence[int]) -> None:
        self._env, self._world = env, world
        env.reset(seed=seeds[0])

    def decisions(self, episodes: IntArray) -> Decisions:  # noqa: ARG002 - there is one
        return Decisions.of(self._world.decision())

    def step(self, episodes: IntArray, actions: IntArray) -> Outcomes:  # noqa: ARG002
        _, reward, terminal, truncated, info = self._env.step(int(actions[0]))
        return Outcomes(
            np.array([float(reward)]),
            np.array([float(info.get("discounted_reward", reward))]),
            np.array([float(info.get("duration", np.nan))]),
            np.array([bool(terminal)]),
            np.array([bool(truncated)]),
        )


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Log:
    """What happened in a world, in the order of time."""

    world: str
    episodes: int
    states: list[tuple[IntArray, Decisions]] = field(default_factory=list)
    """The numbers of some episodes, and a state of each."""
    steps: list[tuple[IntArray, IntArray, Outcomes]] = field(default_factory=list)
    """Their numbers, the positions of the actions, and what they brought."""

    def add_states(self, numbers: IntArray, decisions: Decisions) -> None:
        self.states.append((numbers, decisions))

    def add_steps(self, numbers: IntArray, positions: IntArray, outcomes: Outcomes) -> None:
        """Note a step after a check of its durations."""
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
        )


def _play(
    games: Lockstep, policy: Policy, rngs: Sequence[np.random.Generator], first: int, log: _Log
) -> None:
    """Play episodes to their ends; they are numbered from `first`."""
    report("episodes", first, log.episodes)
    running = np.arange(len(rngs))
    decisions = games.decisions(running)
    log.add_states(first + running, decisions)
    while len(running):
        if not decisions.n_actions.all():
            raise InputError(f"{log.world} offers no action in a state that does not end the episode")
        positions = choose_all(policy, decisions, [rngs[i] for i in running.tolist()])
        outcomes = games.step(running, decisions.indices[decisions.candidates[:-1] + positions])
        log.add_steps(first + running, positions, outcomes)
        decisions = games.decisions(running)
        log.add_states(first + running, decisions)
        ended = outcomes.terminal | outcomes.truncated
        if ended.any():
            running, decisions = running[~ended], decisions.take(np.flatnonzero(~ended))
            report("episodes", first + len(rngs) - len(running), log.episodes)


def experience_of(
    states: Decisions, episodes: IntArray, owners: IntArray, positions: IntArray, outcomes: Outcomes
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
    """
    order = np.argsort(owners, kind="stable")
    totals = np.zeros((2, int(episodes.max(initial=-1)) + 1))
    np.add.at(totals[0], owners, outcomes.rewards)
    np.add.at(totals[1], owners, outcomes.durations)
    states = states.take(np.argsort(episodes, kind="stable"))
    owners = owners[order]
    # Each episode has one more state than steps.
    before = np.arange(len(owners)) + owners
    return Experience(
        matrix=states.matrix,
        objects=states.objects,
        private=states.private,
        remaining=states.remaining,
        candidates=states.candidates,
        types=states.types,
        arguments=states.arguments,
        states=before,
        next_states=before + 1,
        actions=states.candidates[before] + positions[order],
        rewards=outcomes.discounted[order],
        durations=outcomes.durations[order],
        terminal=outcomes.terminal[order],
        truncated=outcomes.truncated[order],
        episode_rewards=totals[0],
        episode_durations=totals[1],
    )
