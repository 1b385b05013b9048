from .claims import Claim, Findings
from .registry import STUDIES
from .run_config import RunConfig
from .runner import run_study
from .runs import learn_runs
from .study import Context, Study
from .table import Table
from .tasks import TASKS, Task, task_named

__all__ = [
    "STUDIES",
    "TASKS",
    "Claim",
    "Context",
    "Findings",
    "RunConfig",
    "Study",
    "Table",
    "Task",
    "learn_runs",
    "run_study",
    "task_named",
]
