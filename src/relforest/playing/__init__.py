"""Episodes to look at: a world gives frames, and whatever shows them is written once for all worlds.

Read `shapes` and `frames`, what a world gives, then `recorder`, which plays episodes. `painter` turns a frame
into a picture; `page` turns recorded episodes into a page that plays them, with `tracks`, its compact form.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
