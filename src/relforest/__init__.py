"""Relational learning from scenes of objects: covariant aggregation, SMRF trees and SMRF-RPI.

Start with `Scenes` (your data), `SMRFTreeClassifier` (a readable predictor), `CovAggClassifier` (bags of
points) or `SMRFRPI` (a policy for a Gymnasium world). Importing the package registers its worlds.
"""

from __future__ import annotations

from relforest import metrics
from relforest.mil import CovAggClassifier
from relforest.rl import SMRFRPI
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import SMRFTreeClassifier, Tree
from relforest.worlds import ENVIRONMENT_IDS

__version__ = "0.1.0"

__all__ = [
    "ENVIRONMENT_IDS",
    "SMRFRPI",
    "Attribute",
    "CovAggClassifier",
    "SMRFTreeClassifier",
    "Scenes",
    "Schema",
    "Tree",
    "metrics",
]
