from .curves import LSPI, LinearQ
from .learner import VectorLearner, VectorValue
from .networks import NetworkQ
from .trees import TreesQ

__all__ = ["LSPI", "LinearQ", "NetworkQ", "TreesQ", "VectorLearner", "VectorValue"]
