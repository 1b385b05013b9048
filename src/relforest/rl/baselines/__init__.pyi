from .feature_map import DenseFeatures, FeatureMap, Features
from .sarsa import SarsaLambda
from .sarsa_file import read_team, write_team
from .settings import SarsaSettings
from .team import make_team
from .tile_coding import TileCoding

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
