from .bags import Bags, as_bags
from .batch import Scenes
from .derived import extent_ratio
from .frames import scene_values
from .schema import OPERATION_NAMES, Attribute, Schema
from .tables import read_table

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
