"""Runs of the learner in folders that survive any interruption, and the studies that reproduce the source.

`learn_runs` is ``relforest learn``: a `RunConfig` of one of the `TASKS` into a run folder. `run_study` is
``relforest experiment``: one of the `STUDIES` into a folder of rows, findings and figures. A study is a
package of four files, settings, run, analysis and a README, and an entry in `registry`.
"""

from __future__ import annotations

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.registry import STUDIES
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runner import run_study
from relforest.experiments.runs import learn_runs
from relforest.experiments.study import Place, Study
from relforest.experiments.table import Table
from relforest.experiments.tasks import TASKS, Task, task_named

__all__ = [
    "STUDIES",
    "TASKS",
    "Claim",
    "Findings",
    "Place",
    "RunConfig",
    "Study",
    "Table",
    "Task",
    "learn_runs",
    "run_study",
    "task_named",
]
