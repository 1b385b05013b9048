"""Blocks on the table over the course of an episode, which begins with a drop."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.worlds.arguments import checked_generator
from relforest.worlds.blocks.blocks import Block
from relforest.worlds.blocks.engine import TABLE_HALF_WIDTH, Engine
from relforest.worlds.blocks.grasp import springs
from relforest.worlds.blocks.state import BlocksState, Cast

STEPS_PER_SECOND: Final = 100
"""Steps in a second on the clock of the tasks."""

MAX_STAGE_STEPS: Final = 500
"""Steps after which every stage of an option ends, including the wait for rest."""

DROP_X: Final = (-30.0, 30.0)
DROP_Y: Final = (math.sqrt(50.0), 40.0)
"""Range of the centres of the blocks when an episode begins."""

FIRST_WAIT: Final = 10
"""Steps after a drop before the first test for rest."""


@final
class BlocksSimulation:
    """Blocks on a table.

    Parameters
    ----------
    rng : numpy.random.Generator
        Consumed by drops and options; the attribute ``rng`` may be replaced between them.
    table_half_width : float
        The table reaches from minus to plus this x.

    Attributes
    ----------
    watch : callable or None
        If set, it is called at the start of an episode and every ``frame_every`` steps.

    Notes
    -----
    A block that is entirely below y = -5 has fallen off the table and is removed permanently; the simulation
    continues without it. An episode depends only on ``rng`` and on the calls since the last `drop`.
    """

    def __init__(self, rng: np.random.Generator, *, table_half_width: float = TABLE_HALF_WIDTH) -> None:
        self.rng = checked_generator(rng)
        self.watch: Callable[[], None] | None = None
        self._frame_every = 4
        self._table_half_width = table_half_width
        self._engine = Engine(table_half_width=table_half_width)
        self._dropped: tuple[Block, ...] = ()
        self._cast = Cast.of(())
        self._keys: dict[int, int] = {}
        self._next_id = 0
        self._steps = 0

    @property
    def frame_every(self) -> int:
        """Steps between two calls of `watch`, at least 1; may be set."""
        return self._frame_every

    @frame_every.setter
    def frame_every(self, steps: int) -> None:
        self._frame_every = at_least("frame_every", steps, 1)

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The blocks that are left, in the order in which they were dropped."""
        return tuple(self._dropped[key] for key in self._engine.keys)

    @property
    def next_id(self) -> int:
        """The smallest id that has not been used."""
        return self._next_id

    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, 3): x, y and angle (radians, not wrapped) of each of `blocks`."""
        return self._engine.poses()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(n, 4): smallest and largest x, smallest and largest y of each of `blocks`, as rotated."""
        return self._engine.bounds()

    @property
    def contacts(self) -> frozenset[tuple[int, int]]:
        """The ids of blocks that touch each other, the smaller first."""
        pairs = ((self._dropped[a].id, self._dropped[b].id) for a, b in self._engine.contacts())
        return frozenset((min(a, b), max(a, b)) for a, b in pairs)

    @property
    def state(self) -> BlocksState:
        """The blocks at present."""
        if len(self._cast.ids) != len(self._engine.keys):
            self._cast = Cast.of(self.blocks)
        return self._cast.state(self.poses, self.contacts)

    @property
    def steps(self) -> int:
        """Steps since the drop."""
        return self._steps

    @property
    def time(self) -> float:
        """Seconds since the drop, on the clock of the tasks."""
        return self._steps / STEPS_PER_SECOND

    @property
    def held(self) -> int | None:
        """The id of the block that is held, or None."""
        key = self._engine.held
        return None if key is None else self._dropped[key].id

    @property
    def tool(self) -> tuple[float, float] | None:
        """X and y of the point where a block is held, or was held last; None before the first grasp."""
        return self._engine.tool

    def __contains__(self, block_id: int) -> bool:
        return block_id in self._keys and self._keys[block_id] in self._engine.keys

    def index(self, block_id: int) -> int:
        """Return the position of a block in `blocks` and in the arrays.

        Raises
        ------
        InputError
            If the block does not exist: it fell off the table, or was never there.
        """
        if block_id not in self:
            present = [block.id for block in self.blocks]
            raise InputError(f"block {block_id!r} is not on the table; these blocks are: {present}")
        return self._engine.keys.index(self._keys[block_id])

    def pose(self, block_id: int) -> tuple[float, float, float]:
        """Return x, y and angle of one block.

        Raises
        ------
        InputError
            If the block does not exist.
        """
        self.index(block_id)
        return self._engine.pose(self._keys[block_id])

    @property
    def at_rest(self) -> bool:
        """Whether all blocks are at rest, as defined in `wait_for_rest`."""
        return self._engine.is_resting()

    def drop(self, blocks: Sequence[Block], *, turned: bool = False) -> int:
        """Begin an episode: clear the table, drop blocks at random places, and wait until they rest.

        Return the steps until rest, 10 to 500.

        Parameters
        ----------
        blocks : sequence of Block
            Their ids must not have been used before. They may overlap at first: the physics pushes them
            apart.
        turned : bool
            Whether to draw random angles, as for the arch task, instead of 0.

        Raises
        ------
        InputError
            If an id has been used before.
        """
        self.place(blocks, [self._draw_pose(turned=turned) for _ in blocks])
        self.step(FIRST_WAIT)
        return FIRST_WAIT + self.wait_for_rest(MAX_STAGE_STEPS - FIRST_WAIT)

    def place(self, blocks: Sequence[Block], poses: Sequence[tuple[float, float, float]]) -> None:
        """Clear the table and place blocks at given poses, at rest; time begins at 0.

        Parameters
        ----------
        blocks : sequence of Block
            Their ids must not have been used before.
        poses : sequence of tuple of float
            x, y and angle of each; the top of the table is at y = 0.

        Raises
        ------
        InputError
            If an id has been used before, the number of poses differs from that of blocks, or a pose is not
            three finite numbers.
        """
        dropped = tuple(blocks)
        ids = [block.id for block in dropped]
        if len(set(ids)) < len(ids) or any(block_id < self._next_id for block_id in ids):
            raise InputError(f"ids of blocks must be new and different (at least {self._next_id}), got {ids}")
        if len(poses) != len(dropped):
            raise InputError(f"poses must have one row for each of {len(dropped)} blocks, got {len(poses)}")
        if any(len(pose) != 3 for pose in poses):
            raise InputError(f"a pose is x, y and angle, got {poses!r}")
        engine = Engine(table_half_width=self._table_half_width)
        keys = [
            engine.add_box(block.half_extents, (pose[0], pose[1]), pose[2])
            for block, pose in zip(dropped, poses, strict=True)
        ]
        self._engine, self._dropped, self._cast = engine, dropped, Cast.of(dropped)
        self._keys = dict(zip(ids, keys, strict=True))
        self._next_id = max([self._next_id - 1, *ids]) + 1
        self._steps = 0
        self._show()

    def step(self, n: int = 1) -> None:
        """Let n steps pass."""

        def pass_by(steps: int) -> tuple[int, bool]:
            self._engine.step(steps)
            return steps, False

        self._pass(at_least("n", n, 0), pass_by)

    def wait_for_rest(self, max_steps: int = MAX_STAGE_STEPS) -> int:
        """Advance until all blocks are at rest, or by ``max_steps``; return the number of steps taken.

        Blocks are at rest when they are slower than 0.005 units and 0.0314 rad per second of the physics,
        which the author's simulator reports as 0.01 and 0.01.
        """
        return self._pass(at_least("max_steps", max_steps, 0), self._engine.settle)[0]

    def grab(self, block_id: int, point: tuple[float, float]) -> None:
        """Hold a block at a point in its own coordinates, releasing any other block.

        Raises
        ------
        InputError
            If the block does not exist.
        """
        half_extents = self.blocks[self.index(block_id)].half_extents
        self._engine.grab(self._keys[block_id], springs(point, half_extents))

    def let_go(self) -> None:
        """Release the block that is held, if any."""
        self._engine.let_go()

    def carry(self, goal: tuple[float, float], max_steps: int = MAX_STAGE_STEPS) -> tuple[int, bool]:
        """Pull the held block until its centre rests at a goal (x, y), or give up after ``max_steps``.

        Return the steps taken, and whether the block arrived in time or nothing is held.
        """
        return self._pass(at_least("max_steps", max_steps, 0), lambda steps: self._engine.carry(goal, steps))

    def _draw_pose(self, *, turned: bool) -> tuple[float, float, float]:
        x, y = self.rng.uniform(*DROP_X), self.rng.uniform(*DROP_Y)
        return x, y, self.rng.uniform(-math.pi, math.pi) if turned else 0.0

    def _pass(self, max_steps: int, advance: Callable[[int], tuple[int, bool]]) -> tuple[int, bool]:
        """Advance by at most ``max_steps``, in parts if watched; ``advance`` returns whether it has ended."""
        taken = 0
        ended = False
        while not ended and taken < max_steps:
            steps = max_steps - taken
            if self.watch is not None:
                steps = min(steps, self._frame_every - self._steps % self._frame_every)
            passed, ended = advance(steps)
            taken += passed
            self._steps += passed
            if passed and self._steps % self._frame_every == 0:
                self._show()
        return taken, ended

    def _show(self) -> None:
        if self.watch is not None:
            self.watch()
