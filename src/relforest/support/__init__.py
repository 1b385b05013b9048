"""The foundation of all other layers: errors, kernels, files, random streams, option checks, tasks and locks.

The package imports nothing else from relforest, so any module may use it. Import from its modules directly,
for example ``from relforest.support.files import write_json``. Start with `relforest.support.errors` for the
exceptions that users see and `relforest.support.rng` for how one seed becomes the independent streams of a
run.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
