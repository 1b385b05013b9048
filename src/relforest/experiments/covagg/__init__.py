"""The scores of covariant aggregation on the synthetic bags, beside those of Palmer (2015), Table 3.2.

`settings` holds the data sets and the scores to be reached, `run` turns a data set into rows, `analysis`
turns the table into findings and a figure. The question, the command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
