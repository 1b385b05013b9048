"""The conventions of `relforest.smdp` as a check that users can run on their own worlds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any, Final

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env

from relforest.rl.experience import Experience
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.scenes import Schema
from relforest.smdp import ActionType, LockstepWorld, RefiningWorld, World
from relforest.support.errors import InputError
from relforest.support.options import at_least, between
from relforest.support.progress import report
from relforest.testing.moments import (
    Moment,
    check_moment,
    check_remaining,
    first_moment,
    is_finite,
    next_moment,
    same_decision,
    same_moment,
    violation,
    walk,
)
from relforest.testing.refining import ask

MOST_STEPS: Final = 100_000
"""All moments are kept in memory, to be compared with a second run."""

MakeEnv = Callable[[], gymnasium.Env[Any, Any]]


def check_world(make_env: MakeEnv, *, seed: int = 0, steps: int = 50) -> None:
    """Check that the learners of this library can use an environment as a world.

    Parameters
    ----------
    make_env : callable
        Makes a new environment, wrapped or not, such as ``lambda: gymnasium.make("relforest/Corridor-v0")``.
    seed : int
        Seed of the environment and of the random actions.
    steps : int
        Number of steps to take, 1 to 100 000, resetting at the end of each episode.

    Raises
    ------
    InputError
        If ``make_env`` does not return a Gymnasium environment, or an option is out of range.
    AssertionError
        If a clause is violated; the message begins with the name of the clause.

    Notes
    -----
    The clauses, in the order of checking:

    - ``gymnasium``: Gymnasium's own ``check_env`` passes. It ignores the mask, so a step must accept
      unavailable actions (and may then do nothing).
    - ``world``: ``env.unwrapped`` implements `World`, the schema has no parameters, action types have
      different names, and the discount is above 0 and at most 1.
    - ``spaces``: actions are ``Discrete`` from 0; observations are a ``Dict`` of one array (slots, dim) per
      attribute of the schema, a ``mask`` (slots,), and nothing else.
    - ``decision``: it fits the schema and the action types, calling it twice gives the same result, and every
      state that is not terminal offers an action.
    - ``action_mask``: int8, 1 exactly at the indices of the decision; the method ``action_masks``, if the
      world has one, returns the same as bool.
    - ``scene``: `Scenes` of length 1 with the schema of the world and the shared objects of the decision, in
      the same order.
    - ``observation``: it is in the observation space; slots in the mask hold all objects in order, including
      private ones, and the others hold 0. The world chooses what represents an undefined value.
    - ``step``: flags are bool, the reward is finite, ``duration`` is finite and not negative,
      ``discounted_reward`` is finite if present, and equals the reward if the discount is 1.
    - ``remaining``: within an episode, `Decision.remaining` falls by one with every action; it is 0 in a
      terminal state, and only at the end. A task without a limit has None in all states.
    - ``before``: after a reset, ``duration_before`` and ``reward_before`` are finite if present, and the time
      is not negative.
    - ``determinism``: the same seed and the same actions give the same trajectory.
    - ``action``: a Python integer, a NumPy integer and a zero-dimensional NumPy array, which learners all
      use, have the same effect.
    - ``lockstep``: in a `LockstepWorld`, three episodes with random actions are the same together and alone.
    - ``refine``: a `RefiningWorld` only appends, as `check_refined` says, and the decision stays as it should
      be; it offers no place twice, ends, answers an empty question with nothing new, accepts the new actions,
      forgets them with the next step, and the same questions give the same answers.

    Examples
    --------
    >>> check_world(lambda: gymnasium.make("relforest/Corridor-v0"))
    """
    steps, seed = between("steps", steps, 1, MOST_STEPS), at_least("seed", seed, 0)
    _check_gymnasium(_make(make_env))
    env = _make(make_env)
    schema, action_types = _check_attributes(env)
    _check_spaces(env, schema)
    moments: list[Moment] = []
    for moment in walk(env, seed, steps):
        check_moment(moment, env, schema, action_types)
        check_remaining(moment, moments[-1] if moments else None)
        moments.append(moment)
        report("checking a world", len(moments))
    for number, again in enumerate(walk(_make(make_env), seed, steps)):
        if not same_moment(moments[number], again):
            raise violation("determinism", f"two runs with seed {seed} differ at moment {number}")
    _check_integers(make_env, seed)
    _check_lockstep(make_env, seed)
    if isinstance(env.unwrapped, RefiningWorld):
        answers = [ask(_make(make_env), seed) for _ in range(2)]
        if not all(map(same_decision, *answers)):
            raise violation("refine", f"two runs with seed {seed} differ after the same questions")


def _check_integers(make_env: MakeEnv, seed: int) -> None:
    moments: list[Moment] = []
    for integer in (np.int64, int, np.array):
        env = _make(make_env)
        action = integer(first_moment(env, seed).decision.indices[0])
        try:
            moments.append(next_moment(env, action))
        except Exception as error:
            raise violation("action", f"step() must accept the action {action!r}: {error}") from error
        env.close()
        if not same_moment(moments[0], moments[-1]):
            raise violation("action", f"{action!r} must have the same effect as the integer {int(action)}")


def _check_lockstep(make_env: MakeEnv, seed: int) -> None:
    env = _make(make_env).unwrapped
    if not isinstance(env, LockstepWorld) or env.lockstep is None:
        return
    # Around a wrapper, which might have to see every step, episodes are played alone.
    together, alone = (
        rollout(each, RandomPolicy(), 3, np.random.SeedSequence(seed))
        for each in (env, gymnasium.Wrapper(_make(make_env).unwrapped))
    )
    for name in (entry.name for entry in fields(Experience)):
        if not np.array_equal(getattr(together, name), getattr(alone, name), equal_nan=True):
            raise violation("lockstep", f"{name} of episodes that are played together and alone differ")


def _make(make_env: MakeEnv) -> gymnasium.Env[Any, Any]:
    if not callable(make_env):
        raise InputError(f"make_env must be a function that returns an environment, got {make_env!r}")
    env = make_env()
    if not isinstance(env, gymnasium.Env):
        raise InputError(f"make_env must return a gymnasium.Env, but returned {env!r}")
    return env


def _check_gymnasium(env: gymnasium.Env[Any, Any]) -> None:
    world = env.unwrapped
    try:
        check_env(world, skip_render_check=world.spec is None)
    except Exception as error:
        raise violation("gymnasium", f"check_env fails: {error}") from error
    env.close()


def _check_attributes(env: gymnasium.Env[Any, Any]) -> tuple[Schema, tuple[ActionType, ...]]:
    world = env.unwrapped
    if not isinstance(world, World):
        raise violation("world", "env.unwrapped must have schema, action_types, discount and decision()")
    schema, action_types, discount = world.schema, world.action_types, world.discount
    if not isinstance(schema, Schema) or schema.parameters:
        raise violation("world", f"schema must be a Schema without parameters, got {schema!r}")
    typed = isinstance(action_types, tuple) and all(isinstance(entry, ActionType) for entry in action_types)
    if not typed or not action_types:
        raise violation("world", f"action_types must be a tuple of ActionType, got {action_types!r}")
    names = [action_type.name for action_type in action_types]
    if len(set(names)) < len(names):
        raise violation("world", f"action types must have different names, got {names}")
    if not is_finite(discount) or not 0 < discount <= 1:
        raise violation("world", f"discount must be above 0 and at most 1, got {discount!r}")
    return schema, action_types


def _check_spaces(env: gymnasium.Env[Any, Any], schema: Schema) -> None:
    actions, observations = env.action_space, env.observation_space
    if not isinstance(actions, spaces.Discrete) or actions.start != 0:
        raise violation("spaces", f"the action space must be Discrete and start at 0, got {actions}")
    if not isinstance(observations, spaces.Dict):
        raise violation("spaces", f"the observation space must be a Dict, got {observations}")
    expected = {*schema.names, "mask"}
    if set(observations) != expected:
        raise violation("spaces", f"observations must contain {sorted(expected)}, got {sorted(observations)}")
    mask = observations["mask"].shape
    if mask is None or len(mask) != 1:
        raise violation("spaces", f"the mask must have the shape (slots,), got {mask}")
    for attribute in schema.attributes:
        shape = observations[attribute.name].shape
        if shape != (mask[0], attribute.dim):
            raise violation(
                "spaces", f"{attribute.name!r} must have the shape {(mask[0], attribute.dim)}, got {shape}"
            )
