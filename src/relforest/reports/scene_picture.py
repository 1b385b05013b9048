"""A scene of a table as shapes: a disc per object where it is, arguments by name."""

from __future__ import annotations

from typing import Final

import numpy as np

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Circle, Line, Polygon, Shape, Text
from relforest.reports.style import SERIES
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray
from relforest.scenes.ids import plain
from relforest.worlds.blocks.scene import SCHEMA as BLOCKS

_RADIUS: Final = 0.016
_PIXELS: Final = 640


def plane_of(schema: Schema) -> list[int]:
    """Return up to two columns to be drawn: those of the location, or else the first numbers."""
    numbers = [each for each in schema.attributes if each.kind == "euclidean"]
    chosen = [each for each in numbers if each.role == "location"][:1] or numbers
    return [at for each in chosen for at in range(schema.width)[schema.columns(each.name)]][:2]


def places_of(scenes: Scenes) -> FloatArray:
    """Return where each object is drawn, (n_objects, 2); a coordinate that does not exist is 0."""
    columns, places = plane_of(scenes.schema), np.zeros((len(scenes.matrix), 2))
    places[:, : len(columns)] = scenes.matrix[:, columns]
    return places


def window_of(scenes: Scenes) -> FloatArray:
    """Return the square region (2, 2) of all objects, and a tenth more."""
    places = places_of(scenes)
    known = places[~np.isnan(places).any(axis=1)]
    known = known if len(known) else np.zeros((1, 2))
    low, high = known.min(axis=0), known.max(axis=0)
    half = 0.55 * max(float((high - low).max()), 1e-9)
    return np.stack([(low + high) / 2 - half, (low + high) / 2 + half])


def stage_of(scene: Scenes, region: FloatArray, pixels: int = _PIXELS) -> Stage:
    """Return the stage for a single scene and a region (2, 2) that is to be seen."""
    low, high = region
    if scene.schema.attributes == BLOCKS.attributes:
        blocks, places = scene.matrix[scene.objects(0)], places_of(scene)[scene.objects(0)]
        reach = np.linalg.norm(blocks[:, scene.schema.columns("extent")], axis=1, keepdims=True)
        low, high = np.nanmin([low, *(places - reach)], axis=0), np.nanmax([high, *(places + reach)], axis=0)
    return Stage((float(low[0]), float(high[0]), float(low[1]), float(high[1])), pixels=pixels)


def frame_of(scene: Scenes, region: FloatArray) -> Frame:
    """Return a single scene as a frame: a thing for each object, whose key is its row.

    Objects have their color, or one for the first category that they have, and the blocks of the blocks world
    their shape. Arguments have their names, other objects their ids. Objects without a place are left out.
    """
    schema, places, span = scene.schema, places_of(scene), float((region[1] - region[0]).max())
    named = {int(row): name for name, row in zip(schema.parameters, scene.arguments[0], strict=True)}
    things = []
    for row in scene.objects(0).tolist():
        if np.isnan(places[row]).any():
            continue
        body = _body(schema, scene.matrix[row], _RADIUS * span)
        name = named.get(row, str(plain(scene.object_ids[row])))
        size = 0.026 * span
        words = Text(
            name,
            (0.0, 1.9 * _RADIUS * span),
            size,
            "ink" if row in named else "grey",
            "paper",
            bold=row in named,
        )
        things.append(Thing(str(row), (body, words), *places[row].tolist()))
    return Frame(0.0, tuple(things))


def arrow(start: FloatArray, end: FloatArray, region: FloatArray) -> tuple[Shape, ...]:
    """Return the arrow of a move, and a ring where it ends."""
    span = float((region[1] - region[0]).max())
    (x, y), (to_x, to_y) = start.tolist(), end.tolist()
    width = 0.005 * span
    return (
        Circle((to_x, to_y), _RADIUS * span, edge="choice", width=width),
        Line(((x, y), (to_x, to_y)), "choice", width, arrow=True),
    )


def _body(schema: Schema, values: FloatArray, radius: float) -> Shape:
    if schema.attributes == BLOCKS.attributes and not np.isnan(values).any():
        half = values[schema.columns("extent")]
        angle = values[schema.columns("orientation")][0] / 2
        along = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        corners = (np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half) @ along
        points = tuple((x, y) for x, y in corners.tolist())
        return Polygon(points, _color(schema, values), "ink", radius / 6)
    return Circle((0.0, 0.0), radius, _color(schema, values), "ink", radius / 5)


def _color(schema: Schema, values: FloatArray) -> str:
    for attribute in schema.attributes:
        own = values[schema.columns(attribute.name)]
        if np.isnan(own).any():
            continue
        if attribute.role == "color" and attribute.dim == 3 and (own >= 0.0).all() and (own <= 1.0).all():
            return "#" + "".join(f"{round(255 * part):02x}" for part in own.tolist())
        if attribute.kind == "category":
            return SERIES[int(own[0]) % len(SERIES)].lower()
    return "grey"
