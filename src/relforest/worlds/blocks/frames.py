"""What there is to see of the blocks world, from the side: the table, the blocks in their colors, the robot.

A frame marks the block that an option takes, a dashed one the block that it is put on, and a dashed line
where a block is moved to. A ring is where the robot holds a block. What a score is based on is green.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from relforest.playing.frames import Stage, Thing
from relforest.playing.shapes import Chip, Circle, Line, Polygon, Shape, Text, Words, box
from relforest.support.errors import InputError
from relforest.worlds.blocks.arch import find_arch
from relforest.worlds.blocks.command import Command
from relforest.worlds.blocks.engine import TABLE_HALF_WIDTH
from relforest.worlds.blocks.stacks import stacks
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import MOVE, Task

COLORS: Final = {
    "wood": ("#d6c8b2", "#4a4238"),
    "edge": ("#9a8668", "#857660"),
    "level": ("#e2e0d8", "#2b2f31"),
}
SCORE_NAMES: Final = {
    "high-towers": "mean height",
    "color-grouping": "color score",
    "arch": "area of the arch",
}
"""Name of a task -> what its score is."""

_LEGENDS: Final = {
    "high-towers": "The green line is at the mean height of all blocks.",
    "color-grouping": "A green line under a stack tells what it scores: from \N{MINUS SIGN}1 to 1 for each "
    "block but one.",
    "arch": "The green area is what an arch scores.",
}
_SIGNS: Final = (
    "The frame is around the block that an option takes, the dashed frame around the one that it is put on; "
    "a dashed line shows where a block is to be moved. A ring means that the block is held. Times are those "
    "of the tasks, in which the physics run twice as fast. "
)
# Half the width that is always in view: blocks are dropped up to 30 from the middle and reach 9 farther.
_SIDE: Final = 40.0
_REACH: Final = 9.0
_HIGH: Final = 46.0
_LOW: Final = -4.0
_PIN: Final = 0.11
_WIDE: Final = 2 * TABLE_HALF_WIDTH
_GRIP: Final[tuple[Shape, ...]] = (
    Circle((0.0, 0.0), 1.2, edge="#ffffff", width=0.55),
    Circle((0.0, 0.0), 1.2, edge="choice", width=0.3),
)
_MEAN: Final[tuple[Shape, ...]] = (Line(((-_WIDE, 0.0), (_WIDE, 0.0)), "mark", _PIN),)


def table_stage(task: Task | None = None) -> Stage:
    """Return the stage of a task, or of blocks without one.

    All blocks are in view: a picture shows at least 40 units to both sides of the middle of the table, and
    more, at a smaller scale, while a block is farther away or higher than there is room for.
    """
    levels = [
        shape
        for height in range(10, 160, 10)
        for shape in (
            Line(((-_WIDE, height), (_WIDE, height)), "level", _PIN),
            Text(str(height), (1 - _SIDE, height + 0.9), 1.1, "grey", side=-1.0),
        )
    ]
    table = Polygon(box(-TABLE_HALF_WIDTH, TABLE_HALF_WIDTH, -3.0, 0.0), "wood")
    edge = Line(((-TABLE_HALF_WIDTH, -_PIN), (TABLE_HALF_WIDTH, -_PIN)), "edge", 2 * _PIN)
    return Stage(
        (-_SIDE, _SIDE, _LOW, _HIGH),
        (*levels, table, edge),
        COLORS,
        widest=(-_WIDE, _WIDE, _LOW, 4 * _SIDE),
        room=_REACH,
        rate=25.0,
        score_name=SCORE_NAMES[task.name] if task else "",
        legend=_SIGNS + _LEGENDS[task.name] if task else "",
    )


def block_things(
    half_extents: ArrayLike,
    poses: ArrayLike,
    colors: ArrayLike,
    ids: Sequence[int] | None = None,
    *,
    command: Command | None = None,
) -> tuple[Thing, ...]:
    """Return blocks as things on the stage.

    Half extents (n, 2) are in the block's own frame, poses (n, 3) centre x and y and angle in radians, and
    colors (n, 3) red, green and blue from 0 to 1. Ids are written on the blocks, and those of the command are
    framed.

    Raises
    ------
    InputError
        If an array has the wrong shape or numbers that are not finite.
    """
    parts = _tables(half_extents, poses, colors)
    if ids is not None and len(ids) != len(parts[0]):
        raise InputError(f"ids must name all {len(parts[0])} blocks, got {len(ids)}")
    names = range(len(parts[0])) if ids is None else ids
    framed = _blocks_of(command)
    things = []
    for name, half, pose, color in zip(names, *(part.tolist() for part in parts), strict=True):
        place = framed.index(name) if name in framed else -1
        shapes = _block(tuple(half), _hex(tuple(color)), "" if ids is None else str(name), place)
        things.append(Thing(f"block {name}", shapes, *pose))
    return tuple(things)


def grip(tool: tuple[float, float]) -> Thing:
    """Return the ring where a block is held."""
    return Thing("grip", _GRIP, *tool)


def mean_line(height: float) -> Thing:
    """Return the line at the mean height of the blocks."""
    return Thing("mean", _MEAN, 0.0, height)


def marks_of(state: BlocksState, task: Task) -> tuple[Shape, ...]:
    """Return what the score of a task is based on: stacks of two or more blocks, or the best arch."""
    if task.name == "color-grouping":
        return tuple(shape for mark in _stacks_of(state, task) for shape in mark)
    arch = find_arch(state) if task.name == "arch" else None
    if arch is None:
        return ()
    opening = box(arch.low_x, arch.high_x, arch.low_y, arch.high_y)
    middle = ((arch.low_x + arch.high_x) / 2, (arch.low_y + arch.high_y) / 2)
    return Polygon(opening, "#1f7a5c50", "mark", 1.5 * _PIN), Text(
        f"{arch.score:.1f}", middle, 1.5, "ink", bold=True
    )


def target_of(command: Command) -> tuple[Shape, ...]:
    """Return the line where a block is moved to, if that is what the option does."""
    if command.name != MOVE.name:
        return ()
    x = float(command.arguments[1])
    return (Line(((x, 0.0), (x, _HIGH - 4)), "choice", 1.5 * _PIN, dashed=True),)


def option_words(command: Command, colors: Mapping[int, Sequence[float]]) -> Words:
    """Return an option in words, such as "put 3 on 1", with the blocks, id -> color, in their colors."""
    words: list[str | Chip] = [command.name]
    for argument, block in enumerate(_blocks_of(command)):
        words += [" on " if argument else " ", block_chip(block, colors[block])]
    if command.name == MOVE.name:
        words.append(f" to {command.arguments[1]:.1f}".replace("-", "\N{MINUS SIGN}"))
    return tuple(words)


def block_chip(block: int, color: Sequence[float]) -> Chip:
    """Return the name of a block on its color."""
    return Chip(str(block), _hex(tuple(color)))


def _blocks_of(command: Command | None) -> tuple[int, ...]:
    if command is None:
        return ()
    blocks = command.arguments[:1] if command.name == MOVE.name else command.arguments
    return tuple(int(block) for block in blocks)


def _stacks_of(state: BlocksState, task: Task) -> list[tuple[Shape, ...]]:
    bounds = state.bounds
    groups = stacks(state.poses[:, 0], bounds) if len(state) else np.zeros(0, dtype=np.int64)
    marks: list[tuple[Shape, ...]] = []
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
        score = f"{task.score(stack):.2f}".replace("-", "\N{MINUS SIGN}")
        line = Line(((left, -0.8), (right, -0.8)), "mark", 3 * _PIN)
        marks.append((line, Text(score, ((left + right) / 2, -2.2), 1.4, "mark", bold=True)))
    return marks


def _tables(*arrays: ArrayLike) -> list[NDArray[np.float64]]:
    tables: list[NDArray[np.float64]] = []
    for name, columns, values in zip(("half_extents", "poses", "colors"), (2, 3, 3), arrays, strict=True):
        table = np.asarray(values, dtype=np.float64)
        if table.size == 0:
            table = table.reshape(0, columns)
        shape = (len(tables[0]) if tables else len(table), columns)
        if table.shape != shape or not np.isfinite(table).all():
            raise InputError(f"{name} must contain finite numbers in shape {shape}, got {table.shape}")
        tables.append(table)
    return tables


@lru_cache(maxsize=1024)
def _block(half: tuple[float, float], color: str, label: str, place: int) -> tuple[Shape, ...]:
    """Return a block with its label; ``place`` is its position among the arguments of an option, or -1."""
    wide, high = half
    body = Polygon(box(-wide, wide, -high, high), color, _rim(color), 2 * _PIN)
    grown = box(-wide - 0.4, wide + 0.4, -high - 0.4, high + 0.4)
    frame = (Polygon(grown, edge="choice", width=0.25, dashed=place > 0),) if place >= 0 else ()
    # As large as fits at any angle; where that is too small to be read, its outline sets it off.
    size = min(1.7, 1.1 * min(wide, high))
    words = (Text(label, (0.0, 0.0), size, _over(color), color, bold=True),) if label else ()
    return (body, *frame, *words)


@lru_cache(maxsize=1024)
def _hex(color: tuple[float, ...]) -> str:
    return "#" + "".join(f"{round(255 * min(max(part, 0.0), 1.0)):02x}" for part in color)


def _parts(color: str) -> list[float]:
    return [int(color[at : at + 2], 16) / 255 for at in (1, 3, 5)]


def _light(color: str) -> float:
    return float(np.dot((0.299, 0.587, 0.114), _parts(color)))


def _over(color: str) -> str:
    return "#262626" if _light(color) > 0.5 else "#ffffff"


def _rim(color: str) -> str:
    """Return a darker shade, or a lighter one of what is nearly black."""
    return _hex(tuple(0.55 * part + (0.2 if _light(color) < 0.25 else 0.0) for part in _parts(color)))
