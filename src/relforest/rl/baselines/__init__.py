"""Classical learners to compare with: tile coding and linear Sarsa(lambda) for SMDPs.

They learn online, from one decision to the next, and are independent of the world: an observation is whatever
the feature map accepts. `SarsaLambda` learns the weights of any `FeatureMap`: of a `TileCoding`, which is the
peer of Stone et al. (2006), also with radial basis functions in place of tiles, or of a function that returns
a row of numbers per action (`DenseFeatures`). Start with `sarsa`; `make_team` creates several agents, with
separate or shared weights.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
