"""Unit tests of what was learned: situations that people write down, and what must hold in them."""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
