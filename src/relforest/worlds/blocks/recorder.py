"""Play episodes and record every move of the blocks and the effect of every option."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from gymnasium.utils import seeding
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.options import between
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence, stream
from relforest.worlds.blocks.arch import find_arch
from relforest.worlds.blocks.command import Command
from relforest.worlds.blocks.env import BlocksEnv
from relforest.worlds.blocks.policies import Policy
from relforest.worlds.blocks.recording import NOBODY, Mark, OptionRecord, Recording
from relforest.worlds.blocks.simulation import BlocksSimulation, Frame
from relforest.worlds.blocks.stacks import stacks
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import MOVE, Task

MOST_EPISODES: Final = 1000
"""Episodes in one call."""

MOST_MOVES: Final = 200_000
"""Blocks times actions times episodes. An action takes about 5 kB per block, so this is 1 GB."""


def record_episodes(
    env: BlocksEnv, policy: Policy, episodes: int = 1, seed: RandomState = 0
) -> tuple[Recording, ...]:
    """Play a blocks task and record everything.

    Parameters
    ----------
    env : BlocksEnv
    policy : Policy
        See `relforest.worlds.blocks.policies.make_policy` for policies by name. An episode also ends when the
        policy has finished.
    episodes : int
        Number of episodes, 1 to 1000.
    seed : int, numpy.random.SeedSequence or Generator
        The same seed gives the same episodes. Each episode has two random streams, one for the world and one
        for the policy, as in `relforest.rl.rollout`.

    Returns
    -------
    tuple of Recording

    Raises
    ------
    InputError
        If ``env`` or ``policy`` has the wrong type, ``episodes`` is out of range, or episodes x actions x
        blocks exceeds `MOST_MOVES`.
    """
    if not isinstance(env, BlocksEnv):
        raise InputError(f"env must be a task of the blocks world itself, got {env!r}: pass env.unwrapped")
    if not isinstance(policy, Policy):
        raise InputError(
            f'policy must have choose() and is_finished(), got {policy!r}: use make_policy("random", env)'
        )
    episodes, root = between("episodes", episodes, 1, MOST_EPISODES), seed_sequence(seed)
    size = episodes * env.max_actions * env.n_blocks
    if size > MOST_MOVES:
        raise InputError(
            f"episodes x max_actions x n_blocks must be at most {MOST_MOVES} to fit into memory, got "
            f"{episodes} x {env.max_actions} x {env.n_blocks}: choose fewer"
        )
    recordings = []
    for episode in range(episodes):
        report("playing episodes", episode, episodes)
        rng = generator(stream(root, episode, 1))
        recordings.append(_record(env, policy, int(stream(root, episode, 0).generate_state(1)[0]), rng))
    return tuple(recordings)


def marks_of(state: BlocksState, task: Task) -> tuple[Mark, ...]:
    """Return what the score of a task is based on: stacks of two or more blocks, or the best arch."""
    if task.name == "color-grouping":
        return tuple(_stack_marks(state, task))
    arch = find_arch(state) if task.name == "arch" else None
    if arch is None:
        return ()
    return (Mark(arch.low_x, arch.high_x, arch.low_y, arch.high_y, arch.score),)


def _record(env: BlocksEnv, policy: Policy, seed: int, rng: np.random.Generator) -> Recording:
    env.reset(seed=seed)
    simulation, start = env.simulation, env.state
    frames = _drop(env, seed)
    simulation.frames = frames
    marks = [marks_of(start, env.task)]
    options: list[OptionRecord] = []
    first_score = env.moment.score
    over = not len(env.decision())
    while not over and not policy.is_finished(env.decision()):
        position = policy.choose(env.decision(), rng)
        command, begin = env.command(position), simulation.time
        _, reward, terminated, truncated, _ = env.step(env.decision().indices[position])
        options.append(_option(command, begin, simulation.time, float(reward), env.moment.score))
        marks.append(marks_of(env.state, env.task))
        over = terminated or truncated
    simulation.frames = None
    held = simulation.held
    frames.append(Frame(simulation.time, simulation.poses, tuple(env.state.ids.tolist()), held))
    return Recording(
        task=env.task.name,
        ids=start.ids,
        half_extents=start.half_extents,
        colors=start.colors,
        times=np.array([frame.time for frame in frames]),
        poses=_poses(frames, start.ids),
        held=np.array([NOBODY if frame.held is None else frame.held for frame in frames], dtype=np.int64),
        options=tuple(options),
        first_score=first_score,
        marks=tuple(marks),
    )


def _drop(env: BlocksEnv, seed: int) -> list[Frame]:
    """Return how the blocks fell when the environment was reset with a seed.

    After a reset the blocks have already come to rest, so they are dropped once more with the same random
    numbers.
    """
    rng, _ = seeding.np_random(seed)
    simulation = BlocksSimulation(rng)
    frames: list[Frame] = []
    simulation.frames = frames
    simulation.drop(env.task.blocks(rng, env.n_blocks, simulation.next_id), turned=env.task.turned)
    return frames


def _option(command: Command, begin: float, end: float, reward: float, score: float) -> OptionRecord:
    moves = command.name == MOVE.name
    blocks = command.arguments[:1] if moves else command.arguments
    return OptionRecord(
        name=command.name,
        blocks=tuple(int(block) for block in blocks),
        target=float(command.arguments[1]) if moves else None,
        begin=begin,
        end=end,
        reward=reward,
        score=score,
    )


def _poses(frames: Sequence[Frame], ids: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the poses of blocks over time, (t, n, 3); NaN after a block was lost."""
    columns = {block: column for column, block in enumerate(ids.tolist())}
    poses = np.full((len(frames), len(ids), 3), np.nan)
    for row, frame in zip(poses, frames, strict=True):
        row[[columns[block] for block in frame.ids]] = frame.poses
    return poses


def _stack_marks(state: BlocksState, task: Task) -> list[Mark]:
    bounds = state.bounds
    groups = stacks(state.poses[:, 0], bounds) if len(state) else np.zeros(0, dtype=np.int64)
    marks = []
    for group in np.unique(groups):
        members = groups == group
        if members.sum() < 2:
            continue
        stack = BlocksState(
            state.ids[members],
            state.half_extents[members],
            state.colors[members],
            state.poses[members],
            state.touching[np.ix_(members, members)],
        )
        left, right = float(bounds[members, 0].min()), float(bounds[members, 1].max())
        marks.append(Mark(left, right, 0.0, 0.0, task.score(stack)))
    return marks
