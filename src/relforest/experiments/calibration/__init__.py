"""How often does each test accept a question about noise?

`settings` holds the sizes of the scene sets, `run` grows trees on shuffled labels, `analysis` turns the table
into false-positive rates and a figure. The command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
