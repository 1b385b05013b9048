"""Multiple-instance classifiers in the scikit-learn manner: fit bags of points, predict labels.

A bag is positive if at least one of its instances is. `CovAggClassifier` looks for one ellipsoid
that tells which; `VolumeCommitteeClassifier` weighs the evidence of many, for concepts of several parts or of
many features. `BagScaler` prepares features for methods that depend on their units; classifiers by others are
in `relforest.mil.peers`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
