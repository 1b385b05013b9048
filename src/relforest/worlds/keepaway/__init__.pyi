from .durations import Played, episode_durations, play_episodes
from .options import KeepawayOptions
from .policies import HandCodedPolicy, HoldPolicy, RandomPolicy
from .scene import ACTION_TYPES, SCHEMA
from .variables import n_variables, state_variables, tile_widths, variable_names

__all__ = [
    "ACTION_TYPES",
    "SCHEMA",
    "HandCodedPolicy",
    "HoldPolicy",
    "KeepawayOptions",
    "Played",
    "RandomPolicy",
    "episode_durations",
    "n_variables",
    "play_episodes",
    "state_variables",
    "tile_widths",
    "variable_names",
]
