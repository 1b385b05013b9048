"""The loop between a policy and a world: episodes in, experience out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, SupportsFloat, TypeAlias

import numpy as np

from relforest.rl.experience import NO_LIMIT, Experience
from relforest.rl.policy import Policy
from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision, World
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import report
from relforest.support.rng import generator, stream

_RESET, _CHOICES = 0, 1

Step: TypeAlias = tuple[int, int, float, float, bool, bool]
"""State, position of the action, discounted reward, duration, terminal, truncated."""


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

    Raises
    ------
    InputError
        If the world breaks the conventions of `relforest.smdp`; the message says which.

    References
    ----------
    Palmer (2015), section 6.3 (gathering experience).
    """
    world = world_of(env)
    decisions: list[Decision] = []
    steps: list[Step] = []
    totals = []
    for episode in range(at_least("episodes", episodes, 1)):
        report("episodes", episode, episodes)
        # Worlds written in other languages may accept only 32 bits.
        _, info = env.reset(seed=int(stream(seed, episode, _RESET).generate_state(1)[0]))
        total, elapsed = _play(env, policy, generator(stream(seed, episode, _CHOICES)), decisions, steps)
        earlier, before = (float(info.get(f"{name}_before", 0.0)) for name in ("reward", "duration"))
        totals.append((earlier + total, before + elapsed))
    return experience_of(world, decisions, steps, totals)


def _play(
    env: Environment,
    policy: Policy,
    rng: np.random.Generator,
    decisions: list[Decision],
    steps: list[Step],
) -> tuple[float, float]:
    """Play an episode, note its states and transitions, and return its total reward and its duration."""
    world = world_of(env)
    decision, total, elapsed, ended = world.decision(), 0.0, 0.0, False
    decisions.append(decision)
    while not ended:
        if not len(decision):
            raise InputError(
                f"{type(world).__name__} offers no action in a state that does not end the episode"
            )
        state, position = len(decisions) - 1, policy.choose(decision, rng)
        _, reward, terminal, truncated, info = env.step(int(decision.indices[position]))
        duration = _duration(info, world)
        decision = world.decision()
        decisions.append(decision)
        discounted = float(info.get("discounted_reward", reward))
        steps.append((state, position, discounted, duration, bool(terminal), bool(truncated)))
        total, elapsed, ended = total + float(reward), elapsed + duration, terminal or truncated
    return total, elapsed


def experience_of(
    world: World,
    decisions: Sequence[Decision],
    steps: Sequence[Step],
    totals: Sequence[tuple[float, float]],
) -> Experience:
    """Return what happened in columns; the state after a step is the next one noted."""
    arity = max((action_type.arity for action_type in world.action_types), default=0)
    columns: list[tuple[Any, ...]] = list(zip(*steps, strict=True)) or [()] * 6
    states, positions, rewards, durations, terminal, truncated = columns
    candidates = _offsets([len(decision) for decision in decisions])
    before = np.array(states, dtype=np.int64)
    return Experience(
        matrix=np.concatenate(
            [np.empty((0, world.schema.width)), *(decision.objects for decision in decisions)]
        ),
        objects=_offsets([decision.n_objects for decision in decisions]),
        private=np.array([decision.n_private for decision in decisions], dtype=np.int64),
        remaining=np.array(
            [NO_LIMIT if decision.remaining is None else decision.remaining for decision in decisions],
            dtype=np.int64,
        ),
        candidates=candidates,
        types=np.concatenate([np.empty(0, np.int64), *(decision.types for decision in decisions)]),
        arguments=np.concatenate(
            [np.empty((0, arity), np.int64), *(decision.arguments for decision in decisions)]
        ),
        states=before,
        next_states=before + 1,
        actions=candidates[before] + np.array(positions, dtype=np.int64),
        rewards=np.array(rewards, dtype=np.float64),
        durations=np.array(durations, dtype=np.float64),
        terminal=np.array(terminal, dtype=np.bool_),
        truncated=np.array(truncated, dtype=np.bool_),
        episode_rewards=np.array([total for total, _ in totals], dtype=np.float64),
        episode_durations=np.array([elapsed for _, elapsed in totals], dtype=np.float64),
    )


def _offsets(counts: Sequence[int]) -> IntArray:
    return np.cumsum([0, *counts], dtype=np.int64)


def _duration(info: dict[str, Any], world: World) -> float:
    duration = float(info.get("duration", np.nan))
    if not 0.0 <= duration < np.inf:
        raise InputError(
            f'{type(world).__name__} must report a finite info["duration"] of at least 0 after a step, '
            f"got {duration}"
        )
    return duration
