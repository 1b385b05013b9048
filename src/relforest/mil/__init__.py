"""Multiple-instance classifiers in the scikit-learn manner: fit bags of points, predict labels.

A bag is positive if at least one of its instances is. `CovAggClassifier` looks for one ellipsoid
that tells which.
"""

from __future__ import annotations

from relforest.mil.covagg import CovAggClassifier

__all__ = ["CovAggClassifier"]
