from .dynamics import ACTION_TYPES, LEFT, RIGHT
from .policies import OptimalPolicy, RandomPolicy
from .scene import SCHEMA
from .state import CorridorState

__all__ = ["ACTION_TYPES", "LEFT", "RIGHT", "SCHEMA", "CorridorState", "OptimalPolicy", "RandomPolicy"]
