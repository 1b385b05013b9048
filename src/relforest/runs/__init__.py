"""Learning in iterations that can be interrupted at any moment, whatever learns.

`learner` is what a learner must offer, and one iteration of it; `store` is the folder of a run; `manifest`
decides who may write into a folder. Nothing here knows a particular learner or world.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
