"""Does a run that is killed and restarted end with the same bytes?

`settings` holds the variants, `run` kills ``relforest learn`` and compares what it leaves behind, `analysis`
turns the table into findings. The command and the result are in ``README.md``.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
