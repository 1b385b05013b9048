"""How often each test of an expansion accepts a question where there is nothing to learn.

`settings` holds the sizes of the scene sets, `run` grows trees on shuffled labels, `analysis` turns the table
into false-positive rates and a figure. The question, the command and the result seen stand in ``README.md``.
"""

from __future__ import annotations

from relforest.experiments.calibration.analysis import figures, summarize
from relforest.experiments.calibration.run import compute
from relforest.experiments.calibration.settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "summarize"]
