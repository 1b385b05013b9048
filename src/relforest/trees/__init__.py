"""SMRF trees: probabilistic, existential decision trees over scenes (Palmer 2015, chapter 4).

`SMRFTreeClassifier` learns one; `Tree` is the learned value, made of the three kinds of nodes in
`nodes`; `query` asks it about scenes. Learning goes from `sequences` (instantiation sequences at a
leaf) over `expansions` (which questions may be asked there), `candidates` (their volumes),
`probabilities` and `significance` or `permutation` (what they are worth) to `growth`, the loop of
Algorithm 4.1.
"""

from __future__ import annotations

from relforest.trees.estimator import Explanation, SMRFTreeClassifier, explain
from relforest.trees.growth import Growth, TreeSettings, grow
from relforest.trees.inference import Answers, query
from relforest.trees.nodes import Instantiation, Leaf, Node, Question
from relforest.trees.tree import Tree

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
