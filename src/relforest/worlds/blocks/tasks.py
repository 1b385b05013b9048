"""The three multi-step tasks: their actions, scores and rewards.

References
----------
Palmer (2015), sections 7.4.1 to 7.4.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, Literal, final

import numpy as np

from relforest.smdp import ActionType
from relforest.support.errors import InputError
from relforest.support.options import in_range, one_of
from relforest.worlds.arguments import entries
from relforest.worlds.blocks.actions import TARGET
from relforest.worlds.blocks.arch import arch_score
from relforest.worlds.blocks.blocks import (
    ARCH_HALF_EXTENTS,
    LARGEST_HALF,
    SMALLEST_HALF,
    Block,
    arch_blocks,
    random_blocks,
)
from relforest.worlds.blocks.engine import HALF_SIDES
from relforest.worlds.blocks.samplers import Sampler, target_sampler
from relforest.worlds.blocks.scores import color_distance, grouping_score, mean_height
from relforest.worlds.blocks.state import BlocksState

MAX_ACTIONS: Final = 5
"""Actions of an episode. The source gives 5 for high towers and arches; for color grouping it only mentions
"the final action of the episode", which is interpreted as 5 too."""

MOST_ACTIONS: Final = 1000
"""Actions of the longest episode that is allowed: two simulated hours."""

MOST_BLOCKS: Final = 100
MOST_ARCH_BLOCKS: Final = 25
"""Blocks of the largest episodes that are allowed. More blocks push each other off the table, offer more than
10 000 actions, and take more than a fifth of a second per step."""

DISCOUNT: Final = 0.99
"""Discount factor per simulated second."""

PUT: Final = ActionType("put", ("block", "destination"))
ROTATE: Final = ActionType("rotate", ("block",))
ISOLATE: Final = ActionType("isolate", ("block",))
MOVE: Final = ActionType("move", ("block", TARGET))
DONE: Final = ActionType("done")

HIGH_TOWERS_ACTIONS: Final = (PUT, ROTATE)
COLOR_GROUPING_ACTIONS: Final = (PUT, ISOLATE)
ARCH_ACTIONS: Final = (ROTATE, MOVE, DONE)

SIDES: Final = (2.0 * SMALLEST_HALF, 2.0 * LARGEST_HALF)
"""Smallest and largest side of random blocks. Larger ones would begin inside the table."""

SMALLEST_SIDE: Final = 2.0 * HALF_SIDES[0]
"""The smallest side that can be set; the engine does not accept smaller ones."""

ARCH_SIZE: Final = (2.0 * ARCH_HALF_EXTENTS[0], 2.0 * ARCH_HALF_EXTENTS[1])
"""Width and height of the blocks of the arch task."""

BlockMaker = Callable[[np.random.Generator, int, int], tuple[Block, ...]]


@final
@dataclass(frozen=True, slots=True)
class Task:
    """A task, apart from its number of blocks."""

    name: str  # name on the command line
    action_types: tuple[ActionType, ...]
    exploration: tuple[float, ...]  # probability of each action type under the random policy
    blocks: BlockMaker  # draws the blocks of an episode, given a generator, their number and the first id
    turned: bool  # whether blocks are dropped at random angles
    score_name: str  # name of the score in ``info``
    score: Callable[[BlocksState], float]  # returns the score of a state
    pays: Literal["change", "done", "end"]
    """Whether the reward of every action is the change in the score (shaping), or only one is rewarded, with
    the score: done, or the last of the episode."""
    sampler: Sampler | None = None  # samples targets for moves
    most_blocks: int = MOST_BLOCKS  # the largest number of blocks

    def reward(self, action: str, before: float, after: float, *, is_last: bool) -> float:
        """Return the reward of an action, given the scores before and after it."""
        if self.pays == "change":
            return after - before
        return after if action == DONE.name or (self.pays == "end" and is_last) else 0.0


def high_towers(sides: tuple[float, float] = SIDES) -> Task:
    """Return the high towers task: the score is the mean height of the blocks.

    Parameters
    ----------
    sides : pair of float
        Smallest and largest side of a block, from 0.02 to 10.

    Raises
    ------
    InputError
        If ``sides`` is not such a pair.

    References
    ----------
    Palmer (2015), section 7.4.1.
    """
    return Task(
        name="high-towers",
        action_types=HIGH_TOWERS_ACTIONS,
        exploration=(0.75, 0.25),
        blocks=_random_blocks(sides),
        turned=False,
        score_name="mean_height",
        score=mean_height,
        pays="change",
    )


def color_grouping(distance: str = "ciede2000", sides: tuple[float, float] = SIDES) -> Task:
    """Return the task of stacking blocks of similar colors.

    Parameters
    ----------
    distance : {"ciede2000", "rgb"}
        How colors are compared.
    sides : pair of float
        Smallest and largest side of a block, from 0.02 to 10.

    Raises
    ------
    InputError
        If the distance is unknown, or ``sides`` is not such a pair.

    References
    ----------
    Palmer (2015), section 7.4.2.
    """
    compared = color_distance(distance)
    return Task(
        name="color-grouping",
        action_types=COLOR_GROUPING_ACTIONS,
        exploration=(0.75, 0.25),
        blocks=_random_blocks(sides),
        turned=False,
        score_name="grouping_score",
        score=partial(grouping_score, distance=compared),
        pays="change",
    )


def arch(
    sampler: str = "test", size: tuple[float, float] = ARCH_SIZE, pays: Literal["done", "end"] = "done"
) -> Task:
    """Return the task of building an arch, rewarded when it is declared done.

    Parameters
    ----------
    sampler : {"test", "training"}
        Which targets moves can have, see `relforest.worlds.blocks.samplers`.
    size : pair of float
        Width and height of all blocks, from 0.02 to 10.
    pays : {"done", "end"}
        Which action is rewarded: done, or the last of the episode, whichever it is. The source learns from
        the former and reports the latter.

    Raises
    ------
    InputError
        If a word is unknown, or ``size`` is not such a pair.

    References
    ----------
    Palmer (2015), section 7.4.3.
    """
    one_of("pays", pays, ("done", "end"))
    return Task(
        name="arch",
        action_types=ARCH_ACTIONS,
        exploration=(0.9 * 0.25, 0.9 * 0.75, 0.1),
        blocks=_equal_blocks(size),
        turned=True,
        score_name="arch_score",
        score=arch_score,
        pays=pays,
        sampler=target_sampler(sampler),
        most_blocks=MOST_ARCH_BLOCKS,
    )


def _random_blocks(sides: tuple[float, float]) -> BlockMaker:
    low, high = _lengths("sides", sides)
    if low > high:
        raise InputError(f"sides must be the smallest and the largest side, got {sides!r}")
    return partial(_make_random, low / 2.0, (high - low) / (SIDES[1] - SIDES[0]))


def _make_random(
    smallest: float, scale: float, rng: np.random.Generator, n: int, first_id: int
) -> tuple[Block, ...]:
    def resized(half: float) -> float:
        return smallest + (half - SMALLEST_HALF) * scale

    return tuple(
        replace(block, half_extents=(resized(block.half_extents[0]), resized(block.half_extents[1])))
        for block in random_blocks(rng, n, first_id=first_id)
    )


def _equal_blocks(size: tuple[float, float]) -> BlockMaker:
    width, height = _lengths("size", size)
    return partial(_make_equal, (width / 2.0, height / 2.0))


def _make_equal(
    half_extents: tuple[float, float], rng: np.random.Generator, n: int, first_id: int
) -> tuple[Block, ...]:
    return tuple(
        replace(block, half_extents=half_extents) for block in arch_blocks(rng, n, first_id=first_id)
    )


def _lengths(name: str, pair: object) -> tuple[float, float]:
    values = entries(pair)
    if len(values) != 2:
        raise InputError(f"{name} must be two lengths, got {pair!r}")
    first, second = (in_range(name, value, SMALLEST_SIDE, SIDES[1]) for value in values)
    return first, second
