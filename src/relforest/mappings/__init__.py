"""Mapping functions: from bound objects to a point in a metric space (Palmer 2015, section 4.3).

A question node of a SMRF tree never looks at objects directly: it maps some of the objects bound
so far to a vector (or an angle) and asks whether that point lies in a decision volume. Start with
`catalogue`, which lists every mapping function that a schema allows; `Mapping` is one of them.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
