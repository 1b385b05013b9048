"""Conformance checks that users can run on their own worlds and mapping functions.

A check raises an `AssertionError` whose message begins with the clause that is violated, or returns nothing;
it needs no test framework. Start with `check_world` and `check_mapping`.
"""

from __future__ import annotations

from relforest.testing.mappings import check_mapping
from relforest.testing.worlds import check_world

__all__ = ["check_mapping", "check_world"]
