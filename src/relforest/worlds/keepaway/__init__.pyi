from .decisions.policies import HandCodedPolicy, HoldPolicy, RandomPolicy
from .decisions.scene import ACTION_TYPES, SCHEMA
from .decisions.variables import n_variables, state_variables, tile_widths, variable_names
from .passes import keepaway_pass_scenes
from .play.durations import Played, episode_durations, play_episodes
from .server.options import KeepawayOptions

__all__ = [
    "ACTION_TYPES",
    "SCHEMA",
    "HandCodedPolicy",
    "HoldPolicy",
    "KeepawayOptions",
    "Played",
    "RandomPolicy",
    "episode_durations",
    "keepaway_pass_scenes",
    "n_variables",
    "play_episodes",
    "state_variables",
    "tile_widths",
    "variable_names",
]
