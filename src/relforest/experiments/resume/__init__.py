"""Whether a run that was killed at any moment and started again ends as if nothing had happened.

`settings` holds the variants, `run` kills ``relforest learn`` and compares what it leaves behind, `analysis`
turns the table into findings. The question, the command and the result seen stand in ``README.md``.
"""

from __future__ import annotations

from relforest.experiments.resume.analysis import figures, summarize
from relforest.experiments.resume.run import compute
from relforest.experiments.resume.settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "summarize"]
