"""What a model predicts while one object of a scene stands elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.explaining.moves import check_plane, moved, region_of, single
from relforest.models import Model
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray
from relforest.scenes.ids import plain
from relforest.support.errors import InputError
from relforest.support.options import between
from relforest.support.progress import report

CELLS: Final = 61
_MOST_CELLS: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class DecisionMap:
    """What is predicted with an object at each point of a grid.

    Parameters
    ----------
    row : int
        Row of the object in the scene.
    x, y : (n,) float64
        Coordinates of the grid.
    values : (n, n) float64
        Probability of the last class, or the predicted number; rows are those of y.
    boundary : float
        The value from which on the last class is predicted; of numbers, what is predicted as it is.
    """

    row: int
    x: FloatArray
    y: FloatArray
    values: FloatArray
    boundary: float


def row_named(scene: Scenes, name: str) -> int:
    """Return the row of the object with an id, or that is an argument.

    Raises
    ------
    InputError
        If there is none.
    """
    for parameter, row in zip(scene.schema.parameters, scene.arguments[0].tolist(), strict=True):
        if parameter == name and row >= 0:
            return int(row)
    rows = scene.objects(0).tolist()
    ids = [str(plain(scene.object_ids[row])) for row in rows]
    if name not in ids:
        known = ", ".join(dict.fromkeys([*scene.schema.parameters, *ids]))
        raise InputError(f"the scene has no object {name!r}: choose one of {known}")
    return int(rows[ids.index(name)])


def decision_map(
    model: Model,
    scene: Scenes,
    row: int,
    *,
    within: Sequence[Sequence[float]] | FloatArray | None = None,
    cells: int = CELLS,
    n_jobs: int = 1,
) -> DecisionMap:
    """Return what is predicted while an object is moved over a grid (Figure 5.2 of the source).

    Parameters
    ----------
    model : Model
        For two classes, or numbers.
    scene : Scenes
        A single scene in the plane.
    row : int
        Row of the object among those of the scene, as by `row_named`.
    within : (2, 2), optional
        The least and the largest coordinates of the grid; see `region_of`.
    cells : int
        Points of the grid along each side, 2 to 1000.
    n_jobs : int
        Threads; they do not affect the result.

    Raises
    ------
    InputError
        If the model is for more than two classes, scenes are not in the plane, or the region does not fit.
    """
    if model.classes is not None and len(model.classes) != 2:
        raise InputError(
            f"maps are of two classes or of numbers, and the model has {len(model.classes)} classes"
        )
    between("cells", cells, 2, _MOST_CELLS)
    scene = single(scene)
    check_plane(scene.schema)
    region = region_of(scene, within)
    x, y = np.linspace(region[0], region[1], cells).T
    values = np.empty((cells, cells))
    for number, height in enumerate(y.tolist()):
        report("rows of the map", number, cells)
        line = moved(scene, np.full(cells, row), np.column_stack([x, np.full(cells, height)]))
        values[number] = value_of(model, line, n_jobs)
    boundary = model.threshold if model.classes else float(value_of(model, scene, n_jobs)[0])
    return DecisionMap(row, x, y, values, boundary)


def value_of(model: Model, scenes: Scenes, n_jobs: int = 1) -> NDArray[np.float64]:
    """Return the probability of the last class, or the predicted number, of every scene (n,)."""
    said = model.predictions(scenes, n_jobs=n_jobs)
    found = said.predicted if said.probability is None else said.probability[:, -1]
    return np.asarray(found, dtype=np.float64)
