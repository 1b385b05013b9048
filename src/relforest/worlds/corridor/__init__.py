"""A 1-D corridor with rewards at both ends: the smallest world, for tests and pictures of learned policies.

One agent with one attribute walks left or right and earns a reward close to either end (Palmer (2015),
section 7.3). Create it with ``gymnasium.make("relforest/Corridor-v0")``. Read `state`, `dynamics`, `actions`,
`reward`, `scene` and `policies` in this order; `env` connects them, and `frames` are what there is to see.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
