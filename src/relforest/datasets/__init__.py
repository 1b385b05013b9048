"""Bags of points, synthetic and published, and synthetic scenes for concept recovery.

Generators (`color`, `covariant1`, `between_scenes`, ...) take a `numpy.random.Generator` and return values
drawn from the distribution that their docstring states. `fetch_musk1` and its like return the published data
sets that multiple-instance learners are compared on; `read_csv`, `read_arff` and `read_c45` read your own.
Bags always come as a `BagSet`: start there.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
