"""Multiple-instance classifiers with scikit-learn's interface: fit bags of points, predict labels.

A bag is positive if at least one of its instances is. `CovAggClassifier` looks for a single ellipsoid that
contains the positive instances; `VolumeCommitteeClassifier` weighs the evidence of many ellipsoids, for
concepts with several parts or many features. `BagScaler` scales features for methods that depend on their
units. Published classifiers to compare with are in `relforest.mil.baselines`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
