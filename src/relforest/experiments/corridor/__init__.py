"""How fast SMRF-RPI learns the corridor, and what densities add (Palmer (2015), section 7.3).

`settings` holds the conditions and the rewards to be reached, `run` learns one run, `analysis` turns the
table into findings and Figures 7.2 to 7.4. The question, the command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
