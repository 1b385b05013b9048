from . import (
    datasets,
    experiments,
    mappings,
    metrics,
    mil,
    reports,
    rl,
    scenes,
    smdp,
    support,
    testing,
    trees,
    volumes,
    worlds,
)
from .mil import CovAggClassifier
from .rl import SMRFRPI
from .scenes import Attribute, Scenes, Schema
from .support.progress import Stage, listening
from .trees import SMRFTreeClassifier, SMRFTreeRegressor, Tree
from .worlds import ENVIRONMENT_IDS

__version__: str

__all__ = [
    "ENVIRONMENT_IDS",
    "SMRFRPI",
    "Attribute",
    "CovAggClassifier",
    "SMRFTreeClassifier",
    "SMRFTreeRegressor",
    "Scenes",
    "Schema",
    "Stage",
    "Tree",
    "datasets",
    "experiments",
    "listening",
    "mappings",
    "metrics",
    "mil",
    "reports",
    "rl",
    "scenes",
    "smdp",
    "support",
    "testing",
    "trees",
    "volumes",
    "worlds",
]
