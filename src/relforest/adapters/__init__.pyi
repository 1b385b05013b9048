from .containers import bags_from_padded, bags_from_sawmil, bags_from_torchmil, padded_bags, scenes_from_rows
from .highway import highway_world
from .object_env import ObjectEnv
from .tracking import scenes_from_tracking

__all__ = [
    "ObjectEnv",
    "bags_from_padded",
    "bags_from_sawmil",
    "bags_from_torchmil",
    "highway_world",
    "padded_bags",
    "scenes_from_rows",
    "scenes_from_tracking",
]
