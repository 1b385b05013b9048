"""Learned models as values and files: what was learned, and how to apply it to a table.

Start with `Model`; `load` and `save` are its files. `read_training_data` reads what estimators learn from.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
