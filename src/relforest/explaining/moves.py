"""A scene with an object elsewhere, and the least such change that turns what a model predicts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.models import Model
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.arrays import FloatArray, SceneArrays
from relforest.scenes.batch import scenes_of
from relforest.scenes.ids import plain
from relforest.support.errors import InputError
from relforest.support.progress import report

_ROOM: Final = 0.2
_RINGS: Final = 24
_NEAREST: Final = 0.01
_DIRECTIONS: Final = {1: 2, 2: 24, 3: 64}
_STEPS: Final = 16
_NARROWINGS: Final = 3
_TURNS: Final = 6
# Before the least move, there must be none on the same line that is shorter by this share.
SHORTER: Final = 0.95


@final
@dataclass(frozen=True, slots=True, eq=False)
class Move:
    """An object that is elsewhere, and what is predicted then.

    Parameters
    ----------
    row : int
        Row of the object in the scene.
    name : object
        Identifier of the object.
    start, end : (d,) float64
        Where it is, and where it would be.
    scene : Scenes
        The scene with the object at the end.
    predicted : label
        What the model predicts there.
    """

    row: int
    name: Any
    start: FloatArray
    end: FloatArray
    scene: Scenes
    predicted: Any

    @property
    def distance(self) -> float:
        """How far the object moves."""
        return float(np.linalg.norm(self.end - self.start))

    @property
    def shorter(self) -> FloatArray:
        """The end of a move in the same direction that is shorter by a twentieth, (d,)."""
        return self.start + SHORTER * (self.end - self.start)


def location_of(schema: Schema) -> Attribute:
    """Return the attribute that says where objects are.

    Raises
    ------
    InputError
        If there is none, or it has more than three dimensions.
    """
    found = next((each for each in schema.attributes if each.role == "location"), None)
    if found is None or found.kind != "euclidean":
        raise InputError(
            f"no attribute of {', '.join(each.name for each in schema.attributes)} is a location, so no "
            'object can be moved: declare it with Attribute(NAME, 2, role="location")'
        )
    if found.dim not in _DIRECTIONS:
        raise InputError(f"{found.name} has {found.dim} dimensions: objects are moved in at most three")
    return found


def check_plane(schema: Schema) -> None:
    """Raise an `InputError` unless the location of objects is two-dimensional."""
    found = location_of(schema)
    if found.dim != 2:
        raise InputError(f"{found.name} has {found.dim} dimensions: only scenes in the plane are drawn")


def single(scene: Scenes) -> Scenes:
    """Return a single scene without unused rows.

    Raises
    ------
    InputError
        If there is not exactly one.
    """
    if len(scene) != 1:
        raise InputError(f"expected a single scene, got {len(scene)}: select it with scenes.take([position])")
    return scene.compact()


def moved(scene: Scenes, rows: NDArray[np.int64], places: FloatArray) -> Scenes:
    """Return copies of a scene, in each of which another object, or the same one, is elsewhere.

    Given relations stay as they are, since nothing tells how they depend on places.

    The scene is compact, see `single`. Each copy moves the object of one of the rows (n,) to one of the
    places (n, d).
    """
    n, m = len(rows), len(scene.matrix)
    parts, schema = scene.parts, scene.schema
    matrix = np.tile(scene.matrix, (n, 1))
    matrix[np.arange(n) * m + rows, schema.columns(location_of(schema).name)] = places
    offsets = np.arange(n) * m
    pairs = np.tile(scene.pairs, (n, 1)) + np.repeat(offsets, len(scene.pairs))[:, None] * (0, 1, 1)
    return scenes_of(
        SceneArrays(
            schema,
            matrix,
            (scene.objects(0) + offsets[:, None]).ravel(),
            np.arange(n) * len(scene.objects(0)),
            np.full(n, len(scene.objects(0))),
            np.where(parts.arguments < 0, parts.arguments, parts.arguments + offsets[:, None]),
            np.arange(n),
            np.tile(parts.object_ids, n),
            pairs[np.argsort(pairs[:, 0], kind="stable")],
        )
    )


def region_of(scene: Scenes, within: Sequence[Sequence[float]] | FloatArray | None = None) -> FloatArray:
    """Return the least and the largest coordinates that objects may be moved to, (2, d).

    By default they are those of the scene's own objects, and a fifth of its longer side more on every side.

    Raises
    ------
    InputError
        If the region is of another shape, not finite or empty, or lies outside the scene; or there is none,
        because no object of the scene has a place.
    """
    attribute = location_of(scene.schema)
    places = scene.matrix[scene.objects(0)][:, scene.schema.columns(attribute.name)]
    places = places[~np.isnan(places).any(axis=1)]
    if not len(places):
        raise InputError("no object of the scene has a place, so none can be moved")
    low, high = places.min(axis=0), places.max(axis=0)
    if within is None:
        room = _ROOM * float((high - low).max()) or 1.0
        return np.stack([low - room, high + room])
    fits = [len(each) for each in within] == [attribute.dim, attribute.dim]
    region = np.array(within if fits else np.zeros((2, 1)), dtype=np.float64)
    if not np.isfinite(region).all() or (region[0] >= region[1]).any():
        raise InputError(
            f"a region has {attribute.dim} lower and then {attribute.dim} upper bounds, got {within!r:.100}"
        )
    if (region[1] < low).any() or (region[0] > high).any():
        raise InputError(
            f"the region from {region[0].tolist()} to {region[1].tolist()} lies outside the scene, whose "
            f"objects lie from {low.tolist()} to {high.tolist()}"
        )
    return region


def smallest_move(
    model: Model,
    scene: Scenes,
    *,
    within: Sequence[Sequence[float]] | FloatArray | None = None,
    n_jobs: int = 1,
) -> Move | None:
    """Return the smallest move of one object that turns the predicted class; None if there is none.

    Every object is tried at growing distances in directions all around it. The first distance at which a
    class is turned is shortened along the same line, and in directions closer and closer to it. So a region
    that is entered between two distances tried, and left again, may be missed; but on the line of the move,
    one that is shorter by a twentieth does not turn the class.

    Parameters
    ----------
    model : Model
        For classes.
    scene : Scenes
        A single scene.
    within : (2, d), optional
        The least and the largest coordinates of where an object may go; see `region_of`.
    n_jobs : int
        Threads; they do not affect the result.

    Raises
    ------
    InputError
        If the model predicts numbers, objects have no location, or the region does not fit.
    """
    if model.classes is None:
        raise InputError("the model predicts numbers, and only classes can be turned")
    scene = single(scene)
    return _Search(model, scene, region_of(scene, within), n_jobs).run()


@final
class _Search:
    """Looks for the smallest move in one scene."""

    def __init__(self, model: Model, scene: Scenes, region: FloatArray, n_jobs: int) -> None:
        self._model, self._scene, self._region, self._jobs = model, scene, region, n_jobs
        self._columns = scene.schema.columns(location_of(scene.schema).name)
        self._predicted = model.predictions(scene).predicted[0]

    def run(self) -> Move | None:
        places = self._scene.matrix[:, self._columns]
        rows = self._scene.objects(0)
        rows = rows[~np.isnan(places[rows]).any(axis=1)]
        longest = float(np.linalg.norm(self._region[1] - self._region[0]))
        radii = longest * np.geomspace(_NEAREST, 1.0, _RINGS)
        for number, radius in enumerate(radii.tolist()):
            report("distances tried", number, _RINGS)
            around = _directions(self._region.shape[1], number)
            who, ways = np.repeat(rows, len(around)), np.tile(around, (len(rows), 1))
            turned = self._turned(who, places[who] + radius * ways)
            if turned.any():
                # One direction for each object, the first one found.
                found = {
                    int(row): way for row, way in zip(who[turned][::-1], ways[turned][::-1], strict=True)
                }
                return self._shortest(found, radius)
        return None

    def _shortest(self, found: dict[int, FloatArray], radius: float) -> Move:
        """Return the shortest of moves that are known to turn the class, after shortening all of them."""
        radius, row, way = min(
            ((self._along(row, way, radius), row, way) for row, way in found.items()),
            key=lambda each: each[:2],
        )
        turn = np.pi / _DIRECTIONS[2]
        for _ in range(_TURNS):
            closer = _near(way, turn)
            shares = 1.0 - np.geomspace(0.4, 0.002, 10)
            ways, steps = np.repeat(closer, len(shares), axis=0), np.tile(shares * radius, len(closer))
            rows = np.full(len(steps), row)
            turned = np.flatnonzero(self._turned(rows, self._from(row) + steps[:, None] * ways))
            if len(turned):
                best = turned[steps[turned].argmin()]
                way = ways[best]
                radius = self._along(row, way, float(steps[best]))
            turn /= 2.0
        end = self._from(row) + radius * way
        scene = moved(self._scene, np.array([row]), end[None])
        name = plain(self._scene.object_ids[row])
        return Move(row, name, self._from(row), end, scene, self._model.predictions(scene).predicted[0])

    def _along(self, row: int, way: FloatArray, radius: float) -> float:
        """Return the length at which the class turns first on a line, as far as can be told by samples."""
        shortest = radius
        while True:
            low = 0.0
            for _ in range(_NARROWINGS):
                steps = np.linspace(low, shortest, _STEPS + 1)[1:]
                turned = self._turned(
                    np.full(_STEPS, row), self._from(row) + np.outer(steps, way), everywhere=True
                )
                first = int(turned.argmax()) if turned.any() else _STEPS - 1
                low, shortest = (low if first == 0 else float(steps[first - 1])), float(steps[first])
            before = self._from(row) + SHORTER * shortest * way
            if not self._turned(np.array([row]), before[None], everywhere=True)[0]:
                return shortest
            shortest *= SHORTER

    def _from(self, row: int) -> FloatArray:
        place: FloatArray = self._scene.matrix[row, self._columns]
        return place

    def _turned(
        self, rows: NDArray[np.int64], places: FloatArray, *, everywhere: bool = False
    ) -> NDArray[np.bool_]:
        """Return in which copies of the scene the class is another one; outside the region, in none."""
        out = np.zeros(len(rows), dtype=np.bool_)
        inside = ((places >= self._region[0]) & (places <= self._region[1])).all(axis=1) | everywhere
        if inside.any():
            copies = moved(self._scene, rows[inside], places[inside])
            out[inside] = self._model.predictions(copies, n_jobs=self._jobs).predicted != self._predicted
        return out


def _directions(dim: int, ring: int) -> FloatArray:
    """Return unit vectors all around, (k, dim); those of one ring lie between those of the one before."""
    k = _DIRECTIONS[dim]
    if dim == 1:
        return np.array([[1.0], [-1.0]])
    if dim == 2:
        angles = 2 * np.pi * (np.arange(k) + 0.5 * (ring % 2)) / k
        return np.column_stack([np.cos(angles), np.sin(angles)])
    heights = 1.0 - (2 * np.arange(k) + 1) / k
    turns = np.pi * (1 + 5**0.5) * (np.arange(k) + 0.5 * (ring % 2))
    wide = np.sqrt(1.0 - heights**2)
    return np.column_stack([wide * np.cos(turns), wide * np.sin(turns), heights])


def _near(way: FloatArray, angle: float) -> FloatArray:
    """Return unit vectors at an angle from another one, two for each direction across, (2 (d - 1), d)."""
    if len(way) == 1:
        return way[None]
    across = np.linalg.svd(way[None])[2][1:]
    return np.concatenate([np.cos(angle) * way + sign * np.sin(angle) * across for sign in (-1.0, 1.0)])
