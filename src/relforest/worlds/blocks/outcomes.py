"""One-step outcome tasks: a scene is set up, the physics runs, and the result is the scene's label.

A *trial* is one such scene with its label; trials with an undecided outcome are redrawn.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Scenes, Schema
from relforest.support.errors import InputError
from relforest.support.options import between
from relforest.support.progress import report
from relforest.worlds.arguments import checked_generator, entries
from relforest.worlds.blocks.blocks import arch_blocks
from relforest.worlds.blocks.scene import SCHEMA

MOST_SCENES: Final = 100_000
"""Scenes in one call, which takes minutes."""

MOST_BLOCKS: Final = 20
"""Weights or interferers in a scene; with many more, hardly any beam tips."""

_MOST_TRIALS: Final = 100


@final
@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One scene and its outcome."""

    objects: NDArray[np.float64]  # (n, width): the blocks as in `SCHEMA`, before physics runs
    arguments: tuple[int, ...]  # positions of the blocks bound to the arguments of the task
    outcome: bool | None  # the label; None if undecided


def checked_range(name: str, limits: Sequence[int], least: int) -> tuple[int, int]:
    """Return the smallest and the largest number of something, both included.

    Raises
    ------
    InputError
        If these are not two integers with ``least <= smallest <= largest <= MOST_BLOCKS``.
    """
    values = entries(limits)
    if len(values) != 2:
        raise InputError(f"{name} must be a pair (smallest, largest), got {limits!r}")
    smallest = between(f"the smallest of {name}", values[0], least, MOST_BLOCKS)
    return smallest, between(f"the largest of {name}", values[1], smallest, MOST_BLOCKS)


def random_colors(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Return (n, 3) colors, drawn like those of all blocks."""
    return np.array([block.color for block in arch_blocks(rng, n)])


def decided_scenes(
    rng: np.random.Generator,
    n: int,
    draw: Callable[[np.random.Generator], Trial],
    parameters: tuple[str, ...] = (),
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw trials until ``n`` are decided, and return their scenes and their labels, (n,).

    A call of `draw` makes one trial; `parameters` are the names of the arguments of the task.

    Raises
    ------
    InputError
        If ``n`` is out of range, ``rng`` is not a Generator, or hardly any trial is decided.
    """
    rng, n = checked_generator(rng), between("n", n, 1, MOST_SCENES)
    trials: list[Trial] = []
    labels: list[bool] = []
    for _ in range(_MOST_TRIALS * n):
        trial = draw(rng)
        if trial.outcome is not None:
            trials.append(trial)
            labels.append(trial.outcome)
            report("simulating scenes", len(trials), n)
        if len(trials) == n:
            return _batch(trials, parameters), np.array(labels)
    raise InputError(f"only {len(trials)} of {_MOST_TRIALS * n} scenes were decided: choose other numbers")


def _batch(trials: list[Trial], parameters: tuple[str, ...]) -> Scenes:
    counts = np.array([len(trial.objects) for trial in trials])
    starts = np.cumsum(counts) - counts
    bound = np.array([trial.arguments for trial in trials], dtype=np.int64).reshape(len(trials), -1)
    schema = Schema(SCHEMA.attributes, parameters)
    matrix = np.concatenate([trial.objects for trial in trials])
    return Scenes(schema, matrix, np.arange(len(matrix)), starts, counts, starts[:, np.newaxis] + bound)
