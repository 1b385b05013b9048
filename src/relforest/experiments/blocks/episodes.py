"""Episodes of hand-made policies: what they earn, how long options take, and how often they succeed.

An option succeeds if, when it has ended,

- *put*: the block overlaps its destination horizontally, its centre is higher, and both are still there;
- *rotate*: the block, lying before, is upright, or the other way round;
- *move*: the centre of the block is less than 2 from the target.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from relforest.experiments.blocks import settings
from relforest.support.rng import generator, stream
from relforest.worlds.blocks.command import Command
from relforest.worlds.blocks.env import BlocksEnv, arch_env, color_grouping_env, high_towers_env
from relforest.worlds.blocks.overlap import overlapping
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.blocks.state import BlocksState, is_upright
from relforest.worlds.blocks.tasks import DONE, ISOLATE, PUT, ROTATE

Measures = Iterator[tuple[str, float]]

_WORLD, _POLICY = 0, 1
_NEAR: Final = 2.0

# Condition -> the policy's own name.
_NAMES: Final[Mapping[str, str]] = {
    settings.RANDOM_RGB: settings.RANDOM,
    settings.MANUAL_RGB: settings.MANUAL,
}


def world(part: str, condition: str) -> BlocksEnv:
    """Return the environment in which a policy plays: TOWERS, GROUPS or ARCHES."""
    if part == settings.TOWERS:
        return high_towers_env()
    if part == settings.GROUPS:
        return color_grouping_env(distance="rgb" if condition in _NAMES else "ciede2000")
    return arch_env(sampler="test" if condition == settings.RANDOM else "training")


def seeds_of(seed: np.random.SeedSequence) -> tuple[int, np.random.Generator]:
    """Return the seed of the world in an episode, and the numbers that a policy draws from."""
    return int(generator(stream(seed, _WORLD)).integers(2**31)), generator(stream(seed, _POLICY))


def play(env: BlocksEnv, condition: str, seed: int, rng: np.random.Generator) -> Measures:
    """Play an episode and yield what was measured, by name.

    The condition is the policy; the seed is that of the world, and `rng` is for the policy.
    """
    policy = make_policy(_NAMES.get(condition, condition), env)
    env.reset(seed=seed)
    yield "score_before", env.moment.score
    total, is_over = 0.0, False
    # A policy that has reached what it wanted stops: not every task has an action that does nothing.
    while not is_over and not policy.is_finished(env.decision()):
        position, before = policy.choose(env.decision(), rng), env.state
        command = env.command(position)
        _, reward, terminated, truncated, info = env.step(env.decision().indices[position])
        total, is_over = total + reward, terminated or truncated
        yield from _option(command, before, env.state, info["duration"])
    yield "episode_steps", float(env.simulation.steps)
    if env.task.pays == "done":
        # An arch counts when it stands, even if there was no action left to say so.
        total = env.moment.score
        yield "stands", float(total > 0)
    yield "total", total


def _option(command: Command, before: BlocksState, after: BlocksState, duration: float) -> Measures:
    name, arguments = command.name, command.arguments
    if name == DONE.name:
        return
    was, now = (_place(state, arguments[0]) for state in (before, after))
    if name == ISOLATE.name:
        is_covered = was is not None and bool(overlapping(before.bounds.tolist(), was))
        yield f"isolate_{'covered' if is_covered else 'free'}_duration", duration
        return
    yield f"{name}_duration", duration
    if was is None or now is None:
        succeeds = False
    elif name == PUT.name:
        goal = _place(after, arguments[1])
        succeeds = goal is not None and _is_over(after, now, goal)
    elif name == ROTATE.name:
        succeeds = _stands(after, now) != _stands(before, was)
    else:
        succeeds = abs(after.poses[now, 0] - arguments[1]) < _NEAR
    yield f"{name}_success", float(succeeds)


def _place(state: BlocksState, block_id: float) -> int | None:
    """Return the position of a block in a state; None if it is gone."""
    found = np.flatnonzero(state.ids == block_id)
    return int(found[0]) if len(found) else None


def _is_over(state: BlocksState, upper: int, lower: int) -> bool:
    left, right = state.bounds[:, 0], state.bounds[:, 1]
    is_higher = state.poses[upper, 1] > state.poses[lower, 1]
    return bool(is_higher and left[upper] <= right[lower] and left[lower] <= right[upper])


def _stands(state: BlocksState, block: int) -> bool:
    return bool(is_upright(state.orientations)[block])
