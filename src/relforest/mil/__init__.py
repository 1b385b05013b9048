"""Multiple-instance classifiers in the style of scikit-learn: fit bags of points, predict labels.

A bag is positive if at least one of its instances is. `CovAggClassifier` looks for one ellipsoid that
contains such instances; `VolumeCommitteeClassifier` combines many, for concepts with several parts or many
features. `BagScaler` prepares features for methods that depend on their units. Classifiers by other authors
are in `relforest.mil.peers`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
