from .decision_map import DecisionMap, decision_map, row_named
from .explanation import PredictionExplanation, explain_prediction
from .moves import Move, smallest_move
from .page import explanation_page

__all__ = [
    "DecisionMap",
    "Move",
    "PredictionExplanation",
    "decision_map",
    "explain_prediction",
    "explanation_page",
    "row_named",
    "smallest_move",
]
