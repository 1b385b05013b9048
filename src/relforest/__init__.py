"""Relational learning from scenes of objects: covariant aggregation, SMRF trees and SMRF-RPI.

Start with `Scenes` (your data), `SMRFTreeClassifier` (a readable predictor), `CovAggClassifier` (bags of
points) or `SMRFRPI` (a policy for a Gymnasium world). Importing the package registers its worlds; everything
else is loaded when it is first used.
"""

from __future__ import annotations

from relforest.support.front_door import attach
from relforest.worlds.registration import register_with_gymnasium

__version__ = "0.1.0"

register_with_gymnasium()

__getattr__, __dir__, __all__ = attach(__name__, __file__)
