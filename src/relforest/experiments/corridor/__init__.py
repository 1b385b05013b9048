"""How fast does SMRF-RPI learn, and what do densities add?

`settings` holds the conditions and the rewards to be reached, `run` learns one run, `analysis` turns the
table into findings and Figures 7.2 to 7.4. The command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
