"""How often each test of an expansion accepts a question when there is nothing to learn.

`settings` holds the sizes of the scene sets, `run` grows trees on shuffled labels, `analysis` turns the table
into false-positive rates and a figure. The question, the command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
