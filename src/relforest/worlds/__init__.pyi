from . import blocks, corridor, keepaway
from .registry import ENVIRONMENT_IDS, environment_id, register_worlds

__all__ = ["ENVIRONMENT_IDS", "blocks", "corridor", "environment_id", "keepaway", "register_worlds"]
