"""Multiple-instance classifiers in the scikit-learn manner: fit bags of points, predict labels.

A bag is positive if at least one of its instances is. `CovAggClassifier` looks for one ellipsoid
that tells which; `VolumeCommitteeClassifier` weighs the evidence of many, for concepts of several parts or of
many features. `BagScaler` prepares features for methods that depend on their units; classifiers by others are
in `relforest.mil.peers`.
"""

from __future__ import annotations

from relforest.mil.covagg import CovAggClassifier
from relforest.mil.scaling import BagScaler
from relforest.mil.volume_committee import VolumeCommitteeClassifier

__all__ = ["BagScaler", "CovAggClassifier", "VolumeCommitteeClassifier"]
