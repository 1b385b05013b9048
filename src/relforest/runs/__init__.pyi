from .learner import Learner, Row, Run, Snapshot, advance
from .manifest import Manifest
from .store import Checkpoint, RunStore, read_checkpoint

__all__ = [
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
