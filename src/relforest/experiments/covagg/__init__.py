"""Whether covariant aggregation reaches the scores of Palmer (2015), Table 3.2, on the synthetic bags.

`settings` holds the data sets and the scores to be reached, `run` turns a data set into rows, `analysis`
turns the table into findings and a figure. The question, the command and the result seen stand in
``README.md``.
"""

from __future__ import annotations

from relforest.experiments.covagg.analysis import figures, summarize
from relforest.experiments.covagg.run import compute
from relforest.experiments.covagg.settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "summarize"]
