from .boosting_estimators import SMRFBoostingClassifier, SMRFBoostingRegressor
from .conditions import Condition
from .ensemble import Ensemble
from .explanations import Importance, Reason, ScoreExplanation
from .forest_estimators import SMRFForestClassifier, SMRFForestRegressor
from .outcome_estimator import OutcomeForestClassifier
from .rule_set_estimator import SMRFRuleSetClassifier
from .rule_sets import RuleSetSettings
from .scene_features import SceneFeatures
from .scene_tree import SceneTree, Split, Value
from .settings import GrowthSettings

__all__ = [
    "Condition",
    "Ensemble",
    "GrowthSettings",
    "Importance",
    "OutcomeForestClassifier",
    "Reason",
    "RuleSetSettings",
    "SMRFBoostingClassifier",
    "SMRFBoostingRegressor",
    "SMRFForestClassifier",
    "SMRFForestRegressor",
    "SMRFRuleSetClassifier",
    "SceneFeatures",
    "SceneTree",
    "ScoreExplanation",
    "Split",
    "Value",
]
