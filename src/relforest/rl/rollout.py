"""The loop between a policy and a world: episodes in, experience out."""

from __future__ import annotations

from typing import Any, Protocol, SupportsFloat

import numpy as np

from relforest.rl.experience import Experience
from relforest.rl.policy import Policy
from relforest.rl.recorder import Recorder
from relforest.smdp import World
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import report
from relforest.support.rng import generator, stream

_RESET, _CHOICES = 0, 1


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
    env: Environment, policy: Policy, episodes: int, seed: np.random.SeedSequence, *, first: int = 0
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
    first : int
        Number of the first episode: 250 episodes and then 250 with ``first=250`` are the same as 500 at once.

    Raises
    ------
    InputError
        If the world breaks the conventions of `relforest.smdp`; the message says which.

    References
    ----------
    Palmer (2015), section 6.3 (gathering experience).
    """
    world = world_of(env)
    recorder = Recorder(world.schema.width, max((kind.arity for kind in world.action_types), default=0))
    first = at_least("first", first, 0)
    for episode in range(first, first + at_least("episodes", episodes, 1)):
        report("episodes", episode - first, episodes)
        # Worlds written in other languages may accept only 32 bits.
        env.reset(seed=int(stream(seed, episode, _RESET).generate_state(1)[0]))
        _play(env, world, policy, generator(stream(seed, episode, _CHOICES)), recorder)
    return recorder.finish()


def _play(
    env: Environment, world: World, policy: Policy, rng: np.random.Generator, recorder: Recorder
) -> None:
    decision, total, elapsed, ended = world.decision(), 0.0, 0.0, False
    state = recorder.state(decision)
    while not ended:
        if not len(decision):
            raise InputError(
                f"{type(world).__name__} offers no action in a state that does not end the episode"
            )
        position = policy.choose(decision, rng)
        _, reward, terminal, truncated, info = env.step(int(decision.indices[position]))
        duration = _duration(info, world)
        decision = world.decision()
        after = recorder.state(decision)
        discounted = float(info.get("discounted_reward", reward))
        recorder.transition(state, position, discounted, duration, (bool(terminal), bool(truncated)))
        total, elapsed, ended, state = total + float(reward), elapsed + duration, terminal or truncated, after
    recorder.episode(total, elapsed)


def _duration(info: dict[str, Any], world: World) -> float:
    duration = float(info.get("duration", np.nan))
    if not 0.0 <= duration < np.inf:
        raise InputError(
            f'{type(world).__name__} must report a finite info["duration"] of at least 0 after a step, '
            f"got {duration}"
        )
    return duration
