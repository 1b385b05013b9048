"""Conformance checks that users can run on their own worlds and mapping functions.

A check returns nothing, or raises an `AssertionError` whose message begins with the violated clause; it needs
no test framework. Start with `check_world` and `check_mapping`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
