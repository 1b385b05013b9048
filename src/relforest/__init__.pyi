from . import (
    datasets,
    experiments,
    explaining,
    forests,
    mappings,
    metrics,
    mil,
    models,
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
from .forests import (
    OutcomeForestClassifier,
    SMRFBoostingClassifier,
    SMRFBoostingRegressor,
    SMRFForestClassifier,
    SMRFForestRegressor,
    SMRFRuleSetClassifier,
)
from .mil import CovAggClassifier
from .models import load, save
from .rl import SMRFRPI
from .scenes import Attribute, Relation, Scenes, Schema, iter_scene_batches
from .support.progress import Stage, listening
from .trees import SMRFTreeClassifier, SMRFTreeRegressor, Tree
from .worlds import ENVIRONMENT_IDS

__version__: str

__all__ = [
    "ENVIRONMENT_IDS",
    "SMRFRPI",
    "Attribute",
    "CovAggClassifier",
    "OutcomeForestClassifier",
    "Relation",
    "SMRFBoostingClassifier",
    "SMRFBoostingRegressor",
    "SMRFForestClassifier",
    "SMRFForestRegressor",
    "SMRFRuleSetClassifier",
    "SMRFTreeClassifier",
    "SMRFTreeRegressor",
    "Scenes",
    "Schema",
    "Stage",
    "Tree",
    "datasets",
    "experiments",
    "explaining",
    "forests",
    "iter_scene_batches",
    "listening",
    "load",
    "mappings",
    "metrics",
    "mil",
    "models",
    "reports",
    "rl",
    "save",
    "scenes",
    "smdp",
    "support",
    "testing",
    "trees",
    "volumes",
    "worlds",
]
