"""Prediction from Parquet to Parquet: time and memory of the command, for few and for many scenes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa
from bench_tree import ATTRIBUTES, example_tree
from pyarrow import parquet
from table import Cell, Table

from relforest.forests import SMRFForestClassifier
from relforest.models import Model, as_model, write_model
from relforest.scenes import Scenes
from relforest.scenes.batch import scenes_of
from relforest.scenes.frames import FrameLayout
from relforest.worlds.keepaway import keepaway_pass_scenes

SCENES = (1_000, 100_000, 1_000_000)
OF_FOREST = (100_000, 1_000_000)
PASSES = 500
OBJECTS = 10
FILES = 4
CHUNK = 5_000
NAMES = (("x", "y"), ("r", "g", "b"))


def write_scenes(folder: Path, n_scenes: int) -> None:
    """Write scenes of 10 objects as four files, in pieces: a command begins with the memory of its parent."""
    rng = np.random.default_rng(0)
    folder.mkdir()
    for number in range(FILES):
        first, last = number * n_scenes // FILES, (number + 1) * n_scenes // FILES
        with parquet.ParquetWriter(
            folder / f"part-{number}.parquet", scene_table(rng, 0, 1).schema
        ) as writer:
            for begin in range(first, last, CHUNK):
                writer.write_table(scene_table(rng, begin, min(begin + CHUNK, last)))


def scene_table(rng: np.random.Generator, begin: int, end: int) -> pa.Table:
    """Return some scenes, one row per object."""
    columns = {
        "scene": np.repeat(np.arange(begin, end), OBJECTS),
        "object": [f"object {i}" for i in range(OBJECTS)] * (end - begin),
        "A": ["object 0"] * (OBJECTS * (end - begin)),
    }
    numbers = {name: rng.uniform(0.0, 1.0, OBJECTS * (end - begin)) for names in NAMES for name in names}
    return pa.table(columns | numbers)


def learn_forest(path: Path) -> Scenes:
    """Learn a forest of 100 trees from passes, and return these."""
    scenes, labels = keepaway_pass_scenes(np.random.default_rng(0), PASSES)
    write_model(path, as_model(SMRFForestClassifier(n_trees=100, random_state=0).fit(scenes, labels)))
    return scenes


def write_passes(folder: Path, scenes: Scenes, n_scenes: int) -> None:
    """Write passes again and again as four files."""
    folder.mkdir()
    for number in range(FILES):
        numbers = np.arange(number * n_scenes // FILES, (number + 1) * n_scenes // FILES)
        parts = scenes.take(numbers % PASSES).parts._replace(scene_ids=numbers)
        scenes_of(parts).to_parquet(folder / f"part-{number}.parquet")


def spent(arguments: list[str]) -> tuple[float, float, float]:
    """Return wall and CPU time in seconds and the peak of memory in MB of a command."""
    begin = time.perf_counter()
    process = subprocess.Popen([sys.executable, "-m", "relforest", *arguments])  # noqa: S603 - our own
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit("the command has failed")
    return time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def run() -> Table:
    """Predict ever more scenes with two threads."""
    rows: list[tuple[Cell, ...]] = []
    columns = FrameLayout("scene", "object", tuple(zip(ATTRIBUTES, NAMES, strict=True)), ("A",))
    tree = example_tree(error_probability=0.1)

    def predict(name: str, model: Path, n_scenes: int) -> None:
        out = folder / f"{model.stem}-out-{n_scenes}"
        arguments = ["predict", str(model), f"{folder}/{model.stem}-{n_scenes}/*.parquet", "--out", f"{out}"]
        rows.append((name, n_scenes, *spent([*arguments, "--jobs", "2"])))

    with TemporaryDirectory() as place:
        folder = Path(place)
        write_model(folder / "tree.json", Model(tree, "tree", "label", (False, True), columns))
        for n_scenes in SCENES:
            write_scenes(folder / f"tree-{n_scenes}", n_scenes)
            predict("a tree", folder / "tree.json", n_scenes)
        passes = learn_forest(folder / "forest.json")
        for n_scenes in OF_FOREST:
            write_passes(folder / f"forest-{n_scenes}", passes, n_scenes)
            predict("100 trees", folder / "forest.json", n_scenes)
    return Table(
        "stream",
        f"Scenes of {OBJECTS} objects and a tree of 3 variables and 5 questions; passes of 5 players and a "
        "forest of 100 trees of conditions; two threads. At most 60 s for the tree, 300 CPU s for the "
        "forest, and flat memory: a batch, 8 bytes per scene and what allocators keep.",
        ("model", "scenes", "wall s", "CPU s", "MB"),
        tuple(rows),
    )


if __name__ == "__main__":
    run().report()
