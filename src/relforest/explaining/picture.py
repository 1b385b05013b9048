"""A scene of a table as shapes: a disc per object where it is, arguments by name."""

from __future__ import annotations

from typing import Final

import numpy as np

from relforest.explaining.moves import location_of
from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Circle, Line, Polygon, Shape, Text
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray
from relforest.scenes.ids import plain
from relforest.support.errors import InputError
from relforest.worlds.blocks.scene import SCHEMA as BLOCKS

_RADIUS: Final = 0.016
_PIXELS: Final = 640
# Okabe and Ito's palette; categories beyond its end begin anew.
_CATEGORIES: Final = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")


def plane_of(schema: Schema) -> str:
    """Return the name of the two-dimensional location by which scenes are drawn.

    Raises
    ------
    InputError
        If there is none.
    """
    found = location_of(schema)
    if found.dim != 2:
        raise InputError(f"{found.name} has {found.dim} dimensions: only scenes in the plane are drawn")
    return found.name


def stage_of(scene: Scenes, region: FloatArray) -> Stage:
    """Return the stage for a single scene and a region (2, 2) in which its objects are moved."""
    low, high = region
    if scene.schema.attributes == BLOCKS.attributes:
        blocks = scene.matrix[scene.objects(0)]
        places = blocks[:, scene.schema.columns("location")]
        reach = np.linalg.norm(blocks[:, scene.schema.columns("extent")], axis=1, keepdims=True)
        low, high = np.nanmin([low, *(places - reach)], axis=0), np.nanmax([high, *(places + reach)], axis=0)
    return Stage((float(low[0]), float(high[0]), float(low[1]), float(high[1])), pixels=_PIXELS)


def frame_of(scene: Scenes, region: FloatArray) -> Frame:
    """Return a single scene as a frame: a thing for each object, whose key is its row.

    Objects have their color, or one for the first category that they have, and the blocks of the blocks world
    their shape. Arguments have their names, other objects their ids. Objects without a place are left out.
    """
    schema = scene.schema
    columns, span = schema.columns(plane_of(schema)), float((region[1] - region[0]).max())
    named = {int(row): name for name, row in zip(schema.parameters, scene.arguments[0], strict=True)}
    things = []
    for row in scene.objects(0).tolist():
        values = scene.matrix[row]
        place = values[columns]
        if np.isnan(place).any():
            continue
        shapes = [_body(schema, values, _RADIUS * span)]
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
        things.append(Thing(str(row), (*shapes, words), float(place[0]), float(place[1])))
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
            return _CATEGORIES[int(own[0]) % len(_CATEGORIES)]
    return "grey"
