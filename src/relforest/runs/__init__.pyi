from .learner import METRIC_NAMES, Learner, Row, Run, Snapshot, advance
from .manifest import Manifest
from .store import Checkpoint, RunStore, read_checkpoint

__all__ = [
    "METRIC_NAMES",
    "Checkpoint",
    "Learner",
    "Manifest",
    "Row",
    "Run",
    "RunStore",
    "Snapshot",
    "advance",
    "read_checkpoint",
]
