"""Covariant aggregation beside other multiple-instance methods, on the data sets of Palmer (2015), chapter 3.

`data` and `methods` name what is compared, `settings` what with which bounds, `published` holds the source's
tables. `run` turns a data set and a method into rows: `limited` starts a process for them (`worker`), which
does the folds (`folds`) as numbered `steps`. `cells` groups the rows of the table, `tables` lays them out,
`bounds` holds them against what must be, `analysis` and `pictures` put all this together. The question, the
command and the result seen stand in ``README.md``.
"""

from __future__ import annotations

from relforest.experiments.mil.analysis import summarize
from relforest.experiments.mil.pictures import figures
from relforest.experiments.mil.run import compute, obstacles
from relforest.experiments.mil.settings import CHOICES, SETTINGS, SMOKE

__all__ = ["CHOICES", "SETTINGS", "SMOKE", "compute", "figures", "obstacles", "summarize"]
