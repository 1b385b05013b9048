from .learner import QLearner
from .settings import CurveSettings, ForestSettings, QSettings, Source
from .value import QValue

__all__ = ["CurveSettings", "ForestSettings", "QLearner", "QSettings", "QValue", "Source"]
