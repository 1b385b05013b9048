"""Accuracy on passes of a football match and tasks of zendo, and for a number among more objects.

docs/forests.md describes them. The options are the same for all; tables are measured if they are named:

    python benchmarks/bench_accuracy.py --passes first-half.csv --zendo zendo-trials-0-1.parquet
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from bench_growth import passes
from numpy.typing import NDArray
from scipy.spatial.distance import pdist
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin, clone
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import StratifiedKFold
from table import Cell, Table

from relforest import (
    Attribute,
    Scenes,
    Schema,
    SMRFBoostingClassifier,
    SMRFBoostingRegressor,
    SMRFForestClassifier,
    SMRFForestRegressor,
    SMRFRuleSetClassifier,
    SMRFTreeClassifier,
)
from relforest.forests import GrowthSettings
from relforest.support.parallel import one_blas_thread

_EIGHT = partial(SMRFBoostingClassifier, n_trees=8, learning_rate=0.5, max_scenes=100_000)
ON_PASSES: Mapping[str, ClassifierMixin] = {
    "boosting": SMRFBoostingClassifier(),
    "forest": SMRFForestClassifier(),
    "rules and boosting": SMRFRuleSetClassifier(),
    "boosting with 8 questions": _EIGHT(growth=GrowthSettings(max_statements=2, n_discs=0, min_scenes=10)),
    "the same, 3 statements": _EIGHT(growth=GrowthSettings(max_statements=3, n_discs=30, min_scenes=10)),
    "SMRF tree": SMRFTreeClassifier(),
}
ON_ZENDO: Mapping[str, ClassifierMixin] = {
    "boosting": SMRFBoostingClassifier(),
    "forest": SMRFForestClassifier(),
    "rules and boosting": SMRFRuleSetClassifier(),
    "one chain of rules": SMRFRuleSetClassifier(averaged=False),
    "SMRF tree": SMRFTreeClassifier(),
}
ON_DISTANCES: Mapping[str, RegressorMixin] = {
    "boosting": SMRFBoostingRegressor(),
    "forest": SMRFForestRegressor(),
}
SHUFFLES = 3
FOLDS = 5
SEEDS = 3


def on_passes(path: Path) -> Iterator[tuple[Cell, ...]]:
    """Yield the area under the ROC curve of each model for failed passes, mean of the folds of a shuffle."""
    problem = passes(path, Attribute("team", kind="category"))
    scenes, labels = problem.scenes, problem.labels
    for name, model in ON_PASSES.items():
        areas, seconds = [], []
        for seed in range(SHUFFLES):
            folds = StratifiedKFold(FOLDS, shuffle=True, random_state=seed)
            of_folds = []
            for train, test in folds.split(labels, labels):
                fitted, elapsed = _fitted(model, scenes.take(train), labels[train], seed)
                scores = fitted.predict_proba(scenes.take(test))[:, 1]
                of_folds.append(roc_auc_score(labels[test], scores))
                seconds.append(elapsed)
            areas.append(float(np.mean(of_folds)))
        yield _row("passes, AUC", name, areas, seconds)


def on_zendo(path: Path) -> Iterator[tuple[Cell, ...]]:
    """Yield the accuracy of each model in each task, over trials and seeds, and over all tasks."""
    table = pq.read_table(path)
    trials = range(1 + pc.max(table["trial"]).as_py())
    learned = [(name, model, False) for name, model in ON_ZENDO.items()]
    learned += [(f"{name}, relation", model, True) for name, model in ON_ZENDO.items() if name != "SMRF tree"]
    for name, model, given in learned:
        of_tasks, seconds = [], []
        for task in pc.unique(table["task"]).to_pylist():
            found = []
            for trial in trials:
                own = table.filter((pc.field("task") == task) & (pc.field("trial") == trial))
                train, test = (
                    _zendo(own.filter(pc.field("split") == split), given=given) for split in ("train", "test")
                )
                for seed in range(SEEDS):
                    fitted, elapsed = _fitted(model, *train, seed)
                    found.append(float((fitted.predict(test[0]) == test[1]).mean()))
                    seconds.append(elapsed)
            of_tasks.append(found)
            yield _row(f"zendo {task}, accuracy", name, found, seconds)
        means = np.mean(of_tasks, axis=0).tolist()
        yield _row("zendo, mean of tasks", name, means, seconds)


def on_distances() -> Iterator[tuple[Cell, ...]]:
    """Yield R2 of each model for the distance of the two nearest objects: learned among 3, tested among 6."""
    for name, model in ON_DISTANCES.items():
        found, seconds = [], []
        for seed in range(SEEDS):
            rng = np.random.default_rng(seed)
            train, test = _nearest(rng, 500, 3), _nearest(rng, 1000, 6)
            fitted, elapsed = _fitted(model, *train, seed)
            found.append(float(fitted.score(*test)))
            seconds.append(elapsed)
        yield _row("nearest two, R2", name, found, seconds)


def _nearest(rng: np.random.Generator, n: int, n_objects: int) -> tuple[Scenes, NDArray[np.float64]]:
    places = rng.uniform(0.0, 10.0, (n, n_objects, 2))
    starts = np.arange(n) * n_objects
    scenes = Scenes(
        Schema((Attribute("location", 2),)),
        places.reshape(-1, 2),
        np.arange(n * n_objects),
        starts,
        np.full(n, n_objects),
    )
    return scenes, np.array([pdist(each).min() for each in places])


def _zendo(table: pa.Table, *, given: bool) -> tuple[Scenes, NDArray[np.bool_]]:
    """Return scenes of pieces: which touch each other is a given relation, or an attribute made of it."""
    touched = {
        (scene, other)
        for scene, others in zip(table["scene"].to_pylist(), table["touches"].to_pylist(), strict=True)
        for other in (others or "").split(";")
    }
    is_touching = [
        "yes" if others or (scene, piece) in touched else "no"
        for scene, piece, others in zip(
            *(table[name].to_pylist() for name in ("scene", "piece", "touches")), strict=True
        )
    ]
    attributes: dict[str | Attribute, str | tuple[str, ...]] = {
        "location": ("x", "y"),
        "size": "size",
        "rotation": "rotation",
        Attribute("color", kind="category"): "color",
        Attribute("orientation", kind="category"): "orientation",
    }
    if not given:
        attributes[Attribute("touching", kind="category")] = "touching"
    scenes = Scenes.from_frame(
        table.append_column("touching", [is_touching]),
        scene="scene",
        object="piece",
        attributes=attributes,
        relations={"touches": "touches"} if given else {},
    )
    label_of = dict(zip(table["scene"].to_pylist(), table["label"].to_pylist(), strict=True))
    return scenes, np.array([label_of[scene] for scene in scenes.scene_ids.tolist()])


def _fitted(model: BaseEstimator, scenes: Scenes, y: NDArray[Any], seed: int) -> tuple[Any, float]:
    before = time.process_time()
    fitted = clone(model).set_params(random_state=seed).fit(scenes, y)
    return fitted, time.process_time() - before


def _row(table: str, model: str, found: Sequence[float], seconds: Sequence[float]) -> tuple[Cell, ...]:
    return table, model, float(np.mean(found)), min(found), max(found), float(np.mean(seconds))


def run(passes_table: Path | None, zendo_table: Path | None) -> Table:
    """Measure all models, on the tables that are given."""
    rows: list[tuple[Cell, ...]] = []
    with one_blas_thread():
        rows += on_distances()
        if passes_table is not None:
            rows += on_passes(passes_table)
        if zendo_table is not None:
            rows += on_zendo(zendo_table)
    note = (
        "Means, and the least and greatest shuffle (passes), trial and seed (others); CPU seconds a fit, of\n"
        "which the first may include compiling.\n"
        "Aim: .90 for boosting or forest and .87 for 8 questions on passes; .95 on zendo, .90 for one\n"
        "chain of rules; R2 .8."
    )
    return Table("accuracy", note, ("table", "model", "mean", "least", "greatest", "s a fit"), tuple(rows))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--passes", type=Path, default=os.environ.get("RELFOREST_PASSES"))
    parser.add_argument("--zendo", type=Path, default=os.environ.get("RELFOREST_ZENDO"))
    options = parser.parse_args()
    run(options.passes, options.zendo).report()
