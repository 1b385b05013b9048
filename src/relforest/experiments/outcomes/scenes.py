"""Scenes of the three tasks, small and large, and Parquet files of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import parquet

from relforest.experiments.outcomes.settings import BALANCE, DROP_ON, KEEPAWAY, LARGE, TASKS, OutcomeSetting
from relforest.experiments.study import Context
from relforest.scenes import Scenes
from relforest.support.rng import generator, seed_sequence, stream
from relforest.worlds.blocks import balance_scale_scenes, drop_on_scenes
from relforest.worlds.keepaway import keepaway_pass_scenes

TRAINING, TESTING = range(2)
_SETS: Final = ("training", "test")


class Labelled(NamedTuple):
    """Scenes, and in which of them the action succeeds."""

    scenes: Scenes
    labels: NDArray[np.bool_]  # (n,)


Draw = Callable[[np.random.Generator, int, bool], tuple[Scenes, NDArray[np.bool_]]]
"""A source of randomness, a number of scenes and whether they are large -> scenes and labels."""

_DRAWS: Final[Mapping[str, Draw]] = {
    BALANCE: lambda rng, n, large: balance_scale_scenes(rng, n, (5, 6) if large else (1, 4)),
    DROP_ON: lambda rng, n, large: drop_on_scenes(rng, n, (4, 5) if large else (0, 3)),
    KEEPAWAY: lambda rng, n, large: (
        keepaway_pass_scenes(rng, n, keepers=4, takers=3, size=25.0)
        if large
        else keepaway_pass_scenes(rng, n)
    ),
}


def drawn(setting: OutcomeSetting, context: Context, size: str, which: int) -> Labelled:
    """Draw the training or test scenes of a setting, and publish them in the folder of the study.

    They depend on task, draw, size and use only. The file ``scenes/TASK-SIZE-USE-DRAW.parquet`` is as written
    by `Scenes.to_parquet` with one more column, ``succeeds``.
    """
    place = (list(TASKS).index(setting.task), setting.draw, int(size == LARGE), which)
    n = (setting.n_scenes, setting.n_test)[which]
    rng = generator(stream(seed_sequence(context.seed), *place))
    found = Labelled(*_DRAWS[setting.task](rng, n, size == LARGE))
    name = f"{setting.task}-{size}-{_SETS[which]}-{setting.draw}.parquet"
    if setting.part == "models":
        write_labelled(context.folder / "scenes" / name, found)
    return found


def write_labelled(path: Path, known: Labelled) -> None:
    """Write scenes and their labels as one table."""
    path.parent.mkdir(parents=True, exist_ok=True)
    known.scenes.to_parquet(path)
    # A scene without objects has a row, too.
    rows = np.repeat(known.labels, np.maximum(known.scenes.counts, 1))
    parquet.write_table(parquet.read_table(path).append_column("succeeds", pa.array(rows)), path)
