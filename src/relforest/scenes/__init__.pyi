from .bags import Bags, as_bags
from .batch import Scenes
from .derived import extent_ratio
from .frames import scene_values
from .sampling import sample_scenes
from .scene_stream import iter_scene_batches
from .schema import OPERATION_NAMES, Attribute, Relation, Schema
from .tables import read_table

__all__ = [
    "OPERATION_NAMES",
    "Attribute",
    "Bags",
    "Relation",
    "Scenes",
    "Schema",
    "as_bags",
    "extent_ratio",
    "iter_scene_batches",
    "read_table",
    "sample_scenes",
    "scene_values",
]
