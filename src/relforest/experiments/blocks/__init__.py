"""How well our blocks world matches the author's simulator, how good hand-made policies are, and its speed.

`settings` lists what is dropped, lifted and played and what the author's simulator gave, `run` makes one
measurement with the help of `episodes`, `samples` groups the rows of the table, `analysis` turns them into
findings and `pictures` into figures. The question, the command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
