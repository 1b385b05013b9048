"""Whether our keepaway is that of the RoboCup 2-D server, whether it can be learned, and how fast it is.

`settings` holds what is played and what real games gave, `trajectories` reads recorded ones, `run` makes one
measurement, `analysis` turns the table into findings and pictures. The question, the command and the result
seen stand in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
