"""Models that run without this library: as Python, as SQL, and as a page in which objects can be moved."""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
