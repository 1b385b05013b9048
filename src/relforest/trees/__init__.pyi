from .criterion import Target
from .estimator import Explanation, SMRFTreeClassifier, SMRFTreeRegressor, explain
from .growth import Growth, grow
from .inference import Answers, query
from .nodes import ClassLeaf, Instantiation, Leaf, MeanLeaf, Node, Question
from .settings import TreeSettings
from .tree import Tree

__all__ = [
    "Answers",
    "ClassLeaf",
    "Explanation",
    "Growth",
    "Instantiation",
    "Leaf",
    "MeanLeaf",
    "Node",
    "Question",
    "SMRFTreeClassifier",
    "SMRFTreeRegressor",
    "Target",
    "Tree",
    "TreeSettings",
    "explain",
    "grow",
    "query",
]
