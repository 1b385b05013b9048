"""Covariant aggregation beside other multiple-instance methods, on the data sets of Palmer (2015), chapter 3.

`data` and `methods` name what is compared, `settings` pairs them and sets the bounds, `published` holds the
source's tables. `run` turns a data set and a method into rows: `limited` starts a process for them
(`worker`), which computes the folds (`folds`) as numbered `steps`. `cells` groups the rows of the table,
`tables` lays them out, `bounds` checks them, and `analysis` and `pictures` put everything together. The
question, the command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
