"""Do trees, forests and rules recover known concepts, also in larger scenes?

`settings` holds the concepts and thresholds, `run` learns a model and tests it, `analysis` turns the table
into findings and a figure. The command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
