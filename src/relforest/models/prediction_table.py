"""Predictions as a table, one row per scene."""

from __future__ import annotations

from typing import Any

import pyarrow as pa

from relforest.models.model import Label, Model
from relforest.scenes import Scenes
from relforest.scenes.arrow import ArrowArray, ArrowTable
from relforest.scenes.ids import IdArray


def prediction_table(model: Model, scenes: Scenes, *, n_jobs: int = 1) -> ArrowTable:
    """Return predictions as an arrow table.

    Parameters
    ----------
    model : Model
    scenes : Scenes
        Of its schema; there may be none.
    n_jobs : int
        Threads, -1 = one per core.

    Returns
    -------
    pyarrow.Table
        The id of each scene (``scene``). For two classes, the ``probability`` of the positive one and the
        more probable one (``predicted``); for several, the most probable one (``predicted``) and the
        probability of each (``probability_red``, ...); for numbers, the ``prediction``. For a tree the number
        of the ``leaf`` that decided, and the ids of the objects that led to it (``witness_A``, ...), null
        where there is none.
    """
    found = model.predictions(scenes, n_jobs=n_jobs)
    columns: dict[str, Any] = {"scene": _ids(scenes.scene_ids)}
    if model.classes is None or found.probability is None:
        columns["prediction"] = found.predicted
    elif len(model.classes) == 2:
        columns["probability"] = found.probability[:, 1]
        columns["predicted"] = _labels(found.predicted.tolist(), model.classes)
    else:
        columns["predicted"] = _labels(found.predicted.tolist(), model.classes)
        columns |= {
            f"probability_{each}": p for each, p in zip(model.classes, found.probability.T, strict=True)
        }
    if found.leaf is not None:
        columns["leaf"] = found.leaf
    object_ids = _ids(scenes.object_ids)
    for name, rows in found.witnesses.items():
        columns[f"witness_{name}"] = object_ids.take(pa.array(rows, mask=rows < 0))
    return pa.table(columns)


def _ids(ids: IdArray) -> ArrowArray:
    return pa.array(ids, pa.string() if ids.dtype == object else pa.int64())


def _labels(labels: list[Label], classes: tuple[Label, ...]) -> ArrowArray:
    """Return labels as they are if the classes have a common type, or else as they are printed."""
    try:
        return pa.array(labels, pa.array(list(classes)).type)
    except (pa.ArrowException, OverflowError):
        return pa.array([str(label) for label in labels], pa.string())
