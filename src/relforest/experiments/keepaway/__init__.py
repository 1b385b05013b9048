"""How well our keepaway matches the RoboCup 2-D server, whether it can be learned as there, and its speed.

`settings` lists what is played and what real games gave, `trajectories` reads recorded games, `run` makes one
measurement, `analysis` turns the table into findings and pictures. The question, the command and the result
are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
