"""Fitted Q iteration on vectors of a fixed length, to compare with: curves, trees and networks.

Nothing here knows of objects: a `VectorMap` of the world turns each action of a state into a vector. How
values of vectors are learned is a value, an `Approximator`; start with `learner`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
