"""Classical learners to compare with: tile coding and linear Sarsa(lambda) for SMDPs.

They learn online, from one decision to the next, and know no world: an observation is whatever the feature
map takes. `SarsaLambda` learns the weights of any `FeatureMap`: of a `TileCoding`, which is the peer of
Stone et al. (2006), or of any function that returns a row of numbers per action (`DenseFeatures`). Start with
`sarsa`; `make_team` makes several agents, with weights of their own or shared ones.
"""

from __future__ import annotations

from relforest.rl.peers.feature_map import DenseFeatures, FeatureMap, Features
from relforest.rl.peers.sarsa import SarsaLambda
from relforest.rl.peers.sarsa_file import read_team, write_team
from relforest.rl.peers.settings import SarsaSettings
from relforest.rl.peers.team import make_team
from relforest.rl.peers.tile_coding import TileCoding

__all__ = [
    "DenseFeatures",
    "FeatureMap",
    "Features",
    "SarsaLambda",
    "SarsaSettings",
    "TileCoding",
    "make_team",
    "read_team",
    "write_team",
]
