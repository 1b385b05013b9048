from .checks import check_decision, check_refined
from .decisions import NO_LIMIT, UNBOUND, Action, ActionType, Decision, Decisions
from .worlds import Lockstep, LockstepWorld, Outcomes, RefiningWorld, World

__all__ = [
    "NO_LIMIT",
    "UNBOUND",
    "Action",
    "ActionType",
    "Decision",
    "Decisions",
    "Lockstep",
    "LockstepWorld",
    "Outcomes",
    "RefiningWorld",
    "World",
    "check_decision",
    "check_refined",
]
