"""What a learner sees: schemas, columnar batches of scenes, and bags of points.

A *scene* is a set of objects, a few of which may be bound to the arguments of an action; an object has the
attributes of a `Schema`, any of them possibly undefined (NaN). All data enter the library here and are
checked once. Start with `Scenes.from_frame`; `schema` says what an attribute is and `batch` how a batch is
stored.
"""

from __future__ import annotations

from relforest.scenes.bags import Bags, as_bags
from relforest.scenes.batch import Scenes
from relforest.scenes.derived import extent_ratio
from relforest.scenes.frames import scene_values
from relforest.scenes.schema import OPERATION_NAMES, Attribute, Schema
from relforest.scenes.tables import read_table

__all__ = [
    "OPERATION_NAMES",
    "Attribute",
    "Bags",
    "Scenes",
    "Schema",
    "as_bags",
    "extent_ratio",
    "read_table",
    "scene_values",
]
