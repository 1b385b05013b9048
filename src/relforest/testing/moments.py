"""The clauses that hold at every moment of an episode; `worlds` explains what each clause means."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeGuard, final

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils.env_checker import data_equivalence
from numpy.typing import NDArray

from relforest.scenes import Scenes, Schema
from relforest.smdp import ActionType, Decision, check_decision
from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What a reset or a step returned, and the decision that followed."""

    observation: dict[str, Any]
    info: dict[str, Any]
    decision: Decision
    outcome: tuple[Any, Any, Any] | None = None  # reward, terminated, truncated; None after a reset

    @property
    def is_terminal(self) -> bool:
        """Whether nothing follows."""
        return self.outcome is not None and bool(self.outcome[1])

    @property
    def is_last(self) -> bool:
        """Whether the episode ended here."""
        return self.outcome is not None and bool(self.outcome[1] or self.outcome[2])


def violation(clause: str, message: str) -> AssertionError:
    """Return the error that says which clause is violated and how."""
    return AssertionError(f"{clause}: {message}")


def walk(env: gymnasium.Env[Any, Any], seed: int, steps: int) -> Iterator[Moment]:
    """Take random available actions, resetting at the end of each episode, then close the environment.

    Only the first reset is seeded. There is a moment for every reset and every step.
    """
    rng = np.random.default_rng(seed)
    moment = first_moment(env, seed)
    yield moment
    for _ in range(steps):
        if moment.is_last:
            moment = first_moment(env)
            yield moment
        position = rng.integers(len(moment.decision))
        moment = next_moment(env, moment.decision.indices[position])
        yield moment
    env.close()


def first_moment(env: gymnasium.Env[Any, Any], seed: int | None = None) -> Moment:
    """Reset an environment."""
    world: Any = env.unwrapped
    observation, info = env.reset(seed=seed)
    return Moment(observation, info, world.decision())


def next_moment(env: gymnasium.Env[Any, Any], action: object) -> Moment:
    """Take a step."""
    world: Any = env.unwrapped
    observation, reward, terminated, truncated, info = env.step(action)
    return Moment(observation, info, world.decision(), (reward, terminated, truncated))


def check_moment(
    moment: Moment, env: gymnasium.Env[Any, Any], schema: Schema, action_types: tuple[ActionType, ...]
) -> None:
    """Check all clauses at one moment; `env` is still in the state of the moment.

    Raises
    ------
    AssertionError
        If a clause is violated.
    """
    world: Any = env.unwrapped
    decision = moment.decision
    try:
        check_decision(decision, schema, action_types)
    except InputError as error:
        raise violation("decision", str(error)) from error
    if not same_decision(decision, world.decision()):
        raise violation("decision", "two calls of decision() in the same state differ")
    if not len(decision) and not moment.is_terminal:
        raise violation("decision", "a state that is not terminal must offer an action")
    _check_mask(moment.info.get("action_mask"), decision, env.action_space)
    if callable(getattr(world, "action_masks", None)):
        _check_masks(world.action_masks(), moment.info["action_mask"])
    _check_scene(moment.info.get("scene"), decision, schema)
    _check_observation(moment.observation, env.observation_space, decision, schema)
    if moment.outcome is None:
        _check_before(moment.info)
    else:
        _check_step(*moment.outcome, info=moment.info, discount=world.discount)


def check_remaining(moment: Moment, before: Moment | None) -> None:
    """Check the number of remaining actions against that of the moment before.

    Raises
    ------
    AssertionError
        If it does not fall by one, or is 0 although the episode goes on.
    """
    found = moment.decision.remaining
    if found == 0 and not moment.is_last:
        raise violation("remaining", "no action remains, but the episode has not ended")
    if moment.outcome is None or before is None:
        return
    last = before.decision.remaining
    expected = None if last is None else 0 if moment.is_terminal else last - 1
    if found != expected:
        raise violation(
            "remaining", f"must be {expected} after an action in a state with {last}, got {found}"
        )


def same_moment(one: Moment, other: Moment) -> bool:
    """Return whether two moments are equal, apart from entries of ``info`` outside the conventions."""
    return (
        data_equivalence(one.observation, other.observation, exact=True)
        and one.outcome == other.outcome
        and all(one.info.get(name) == other.info.get(name) for name in ("duration", "discounted_reward"))
        and same_decision(one.decision, other.decision)
    )


def is_finite(value: object) -> TypeGuard[float]:
    """Return whether a value is a finite real number and not a bool."""
    return isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)


def same_decision(one: Decision, other: Decision) -> bool:
    """Return whether two decisions are equal."""
    return (
        np.array_equal(one.objects, other.objects, equal_nan=True)
        and (one.n_private, one.remaining) == (other.n_private, other.remaining)
        and all(
            np.array_equal(getattr(one, name), getattr(other, name))
            for name in ("types", "arguments", "indices")
        )
    )


def _check_mask(mask: object, decision: Decision, space: gymnasium.Space[Any]) -> None:
    size = space.n if isinstance(space, spaces.Discrete) else 0
    if not isinstance(mask, np.ndarray) or mask.dtype != np.int8 or mask.shape != (size,):
        raise violation(
            "action_mask", f'info["action_mask"] must be an int8 array of shape ({size},), got {mask!r}'
        )
    expected = np.isin(np.arange(size), decision.indices)
    if not np.array_equal(mask, expected) or expected.sum() < len(decision):
        raise violation(
            "action_mask",
            f"must be 1 only at the indices of decision(), {decision.indices.tolist()}, got {mask.tolist()}",
        )


def _check_masks(masks: object, mask: NDArray[np.int8]) -> None:
    if not isinstance(masks, np.ndarray) or masks.dtype != np.bool_ or not np.array_equal(masks, mask):
        raise violation(
            "action_mask",
            f'action_masks() must be {mask.astype(np.bool_)!r} like info["action_mask"], got {masks!r}',
        )


def _check_scene(scene: object, decision: Decision, schema: Schema) -> None:
    if not isinstance(scene, Scenes) or len(scene) != 1:
        raise violation("scene", f'info["scene"] must be Scenes of length 1, got {scene!r}')
    if scene.schema != schema:
        raise violation("scene", f"its schema must be the schema of the world, {schema}, got {scene.schema}")
    shared = decision.objects[: decision.n_shared]
    if not np.array_equal(scene.matrix[scene.objects(0)], shared, equal_nan=True):
        raise violation("scene", "its objects must be the shared objects of decision(), in the same order")


def _check_observation(
    observation: dict[str, Any], space: gymnasium.Space[Any], decision: Decision, schema: Schema
) -> None:
    if not space.contains(observation):
        raise violation("observation", f"{observation!r} is not in the observation space {space}")
    present = np.asarray(observation["mask"]).astype(np.bool_)
    if present.sum() != decision.n_objects:
        raise violation(
            "observation", f"the mask marks {present.sum()} objects, but decision() has {decision.n_objects}"
        )
    for attribute in schema.attributes:
        values = np.asarray(observation[attribute.name])
        objects = decision.objects[:, schema.columns(attribute.name)]
        if not (np.isnan(objects) | (values[present] == objects.astype(values.dtype))).all():
            raise violation(
                "observation", f"{attribute.name!r} must hold the objects of decision(), in the same order"
            )
        if values[~present].any():
            raise violation("observation", f"{attribute.name!r} must be 0 in slots without an object")


def _check_before(info: dict[str, Any]) -> None:
    for name in ("duration_before", "reward_before"):
        found = info.get(name, 0.0)
        if not is_finite(found) or (name == "duration_before" and found < 0):
            raise violation("before", f'info["{name}"] after a reset must be a finite number, got {found!r}')


def _check_step(
    reward: object, terminated: object, truncated: object, *, info: dict[str, Any], discount: float
) -> None:
    for name, flag in (("terminated", terminated), ("truncated", truncated)):
        if not isinstance(flag, (bool, np.bool_)):
            raise violation("step", f"{name} must be a bool, got {flag!r}")
    if not is_finite(reward):
        raise violation("step", f"the reward must be a finite number, got {reward!r}")
    duration = info.get("duration")
    if not is_finite(duration) or duration < 0:
        raise violation("step", f'info["duration"] must be a finite number of at least 0, got {duration!r}')
    discounted = info.get("discounted_reward", reward)
    if not is_finite(discounted):
        raise violation("step", f'info["discounted_reward"] must be a finite number, got {discounted!r}')
    if discount == 1 and not math.isclose(discounted, reward, rel_tol=1e-9, abs_tol=1e-12):
        raise violation(
            "step",
            f'info["discounted_reward"] is {discounted} and the reward {reward}, but the discount is 1',
        )
