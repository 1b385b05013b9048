from .highway import highway_world
from .object_env import ObjectEnv
from .tracking import scenes_from_tracking

__all__ = ["ObjectEnv", "highway_world", "scenes_from_tracking"]
