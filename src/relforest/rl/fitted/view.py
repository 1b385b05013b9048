"""How a learner sees objects: what an attribute is for is found in its values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from relforest.rl.action_scenes import action_scenes
from relforest.rl.experience import Experience
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.scenes.color import srgb_to_lab
from relforest.scenes.schema import OPERATIONS_BY_KIND
from relforest.smdp import ActionType, Decisions
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.numerals import number

# What every attribute may be asked; a distance of single numbers is the size of their difference.
_BASIC: Final = ("identity", "distance", "difference")
_MOST_VALUES: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Attributes that have only a few values, such as the colors of two teams, seen as categories.

    Other colors are seen in CIE Lab, in which their distance is about what people see. All other attributes
    also take part in the operations identity, distance and difference.

    Parameters
    ----------
    world : Schema
        The attributes of the world, without parameters.
    values : tuple of (str, (k, dim) float64)
        The attributes that are categories, and their values in ascending order. An object belongs to the
        nearest one.
    colors : tuple of str
        The attributes that are seen in Lab; in the world, they are red, green and blue from 0 to 1.
    """

    world: Schema
    values: tuple[tuple[str, FloatArray], ...]
    colors: tuple[str, ...] = ()

    @classmethod
    def of(cls, world: Schema, matrix: FloatArray, most: int) -> View:
        """Return the view of attributes of which objects (n, width) have 2 to `most` different values."""
        found, colors = [], []
        for attribute in world.attributes:
            own = matrix[:, world.columns(attribute.name)]
            distinct = np.unique(own[~np.isnan(own).any(axis=1)], axis=0)
            if attribute.kind != "category" and 2 <= len(distinct) <= most:
                found.append((attribute.name, distinct))
            elif _is_rgb(attribute) and len(distinct) and distinct.min() >= 0.0 and distinct.max() <= 1.0:
                colors.append(attribute.name)
        return cls(world, tuple(found), tuple(colors))

    @property
    def attributes(self) -> tuple[Attribute, ...]:
        """The attributes as the learner sees them, in the order of the world."""
        few = dict(self.values)
        return tuple(
            _category(attribute.name, few[attribute.name]) if attribute.name in few else _widened(attribute)
            for attribute in self.world.attributes
        )

    def schemas(self, action_types: tuple[ActionType, ...]) -> tuple[Schema, ...]:
        """Return the schema of the scenes of each action type."""
        attributes = self.attributes
        return tuple(Schema(attributes, action_type.parameters) for action_type in action_types)

    def seen(self, matrix: FloatArray) -> FloatArray:
        """Return objects (n, width of the world) as the learner sees them."""
        if not self.values and not self.colors:
            return matrix
        few = dict(self.values)
        columns = []
        for attribute in self.world.attributes:
            own = matrix[:, self.world.columns(attribute.name)]
            if attribute.name in few:
                away = ((own[:, None, :] - few[attribute.name]) ** 2).sum(axis=2)
                own = np.where(np.isnan(away[:, :1]), np.nan, np.argmin(away, axis=1)[:, None])
            elif attribute.name in self.colors:
                own = srgb_to_lab(own)
            columns.append(own)
        return np.hstack(columns)

    def scenes(
        self, experience: Experience | Decisions, candidates: IntArray, schema: Schema, seen: FloatArray
    ) -> Scenes:
        """Return the scenes of candidate actions of one type; `seen` are all objects as seen."""
        found = action_scenes(experience, candidates, Schema(self.world.attributes, schema.parameters))
        return Scenes(schema, seen, found.rows, found.starts, found.counts, found.arguments)

    def to_dict(self) -> dict[str, Any]:
        """Return the view as plain JSON values."""
        values = {name: distinct.tolist() for name, distinct in self.values}
        return {"schema": self.world.to_dict(), "values": values, "colors": list(self.colors)}

    @classmethod
    def from_dict(cls, document: Any) -> View:  # noqa: ANN401 - not checked yet
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If it is not such a document.
        """
        with well_formed("malformed view"):
            world = Schema.from_dict(document["schema"])
            values = []
            for name, rows in document["values"].items():
                distinct = np.array(rows, dtype=np.float64)
                shape = (len(distinct), world[name].dim)
                if distinct.shape != shape or not 1 <= len(distinct) <= _MOST_VALUES:
                    raise ModelFormatError(f"the values of {name!r} must be 1 to {_MOST_VALUES} vectors")
                if not np.isfinite(distinct).all():
                    raise ModelFormatError(f"the values of {name!r} must be finite")
                values.append((str(name), distinct))
            # Older policies see no colors in Lab.
            colors = tuple(str(name) for name in document.get("colors", ()))
            if not all(_is_rgb(world[name]) for name in colors):
                raise ModelFormatError("colors must be attributes of three numbers with the role of a color")
            return cls(world, tuple(values), colors)


def _is_rgb(attribute: Attribute) -> bool:
    return attribute.kind == "euclidean" and attribute.role == "color" and attribute.dim == 3


def _category(name: str, values: FloatArray) -> Attribute:
    """Return an attribute whose categories are named after the values."""
    names = [number(row[0]) if len(row) == 1 else f"({', '.join(map(number, row))})" for row in values]
    distinct = names if len(set(names)) == len(names) else [str(row.tolist()) for row in values]
    return Attribute(name, kind="category", categories=distinct)


def _widened(attribute: Attribute) -> Attribute:
    """Return an attribute that takes part in all basic operations of its kind."""
    possible = [
        operation
        for operation in _BASIC
        if operation in OPERATIONS_BY_KIND[attribute.kind] and (operation != "distance" or attribute.dim > 1)
    ]
    operations = dict.fromkeys((*attribute.operations, *possible))
    return Attribute(
        attribute.name, attribute.dim, attribute.kind, operations, attribute.categories, attribute.role
    )
