from .learner import QLearner
from .settings import CurveSettings, ForestSettings, QSettings
from .value import QValue

__all__ = ["CurveSettings", "ForestSettings", "QLearner", "QSettings", "QValue"]
