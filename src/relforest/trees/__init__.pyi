from .estimator import Explanation, SMRFTreeClassifier, explain
from .growth import Growth, grow
from .inference import Answers, query
from .nodes import Instantiation, Leaf, Node, Question
from .settings import TreeSettings
from .tree import Tree

__all__ = [
    "Answers",
    "Explanation",
    "Growth",
    "Instantiation",
    "Leaf",
    "Node",
    "Question",
    "SMRFTreeClassifier",
    "Tree",
    "TreeSettings",
    "explain",
    "grow",
    "query",
]
