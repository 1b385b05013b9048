"""Classical learners to compare with: tile coding and linear Sarsa(lambda) for SMDPs.

These learn online, from one decision to the next, and are independent of any world: an observation is
whatever the feature map takes. `SarsaLambda` learns the weights of any `FeatureMap`: a `TileCoding`, as in
Stone et al. (2006), or any function that returns a row of numbers per action (`DenseFeatures`). Start with
`sarsa`; `make_team` makes several agents, with weights of their own or shared.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
