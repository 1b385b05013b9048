"""Data and environments of others, as scenes and worlds.

`ObjectEnv` makes a world of any Gymnasium environment whose state is a list of objects, `highway_world` one
of highway-env, and `scenes_from_tracking` makes scenes of the positions that kloppy reads. Bags come from
sawmil, torchmil and padded arrays, scenes also from padded rows of numbers.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
