"""The input of learners: schemas, columnar batches of scenes, and bags of points.

A *scene* is a set of objects, some of which may be bound to the arguments of an action. An object has the
attributes of a `Schema`, any of which may be undefined (NaN). All data enter the library here and are checked
once. Start with `Scenes.from_frame`; `schema` defines attributes and `batch` how scenes are stored.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
