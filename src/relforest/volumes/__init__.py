"""Decision volumes and how they are learned from labelled bags of points (Palmer 2015, chapter 3).

`aggregate` is covariant aggregation, one implementation for bag classifiers and for the questions of SMRF
trees; it returns an `Ellipsoid`, an `Arc` where the points are angles, or a `Slab` if only one coordinate is
to count. The compiled parts are, in reading order: `bag_layout`, `conditioning`, `witnesses`, `models`,
`objectives`, `cuts`, `aggregation`, and another learner, `diverse_density`. In many dimensions,
`principal_axes` and `low_rank` save most of the arithmetic.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
