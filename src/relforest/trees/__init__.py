"""SMRF trees: probabilistic, existential decision trees over scenes (Palmer 2015, chapter 4).

`SMRFTreeClassifier` learns a `Tree`, a value made of the three types of nodes in `nodes`; `query` applies it
to scenes. Learning goes from `sequences` (instantiation sequences at a leaf) over `expansions` (the questions
that may be asked there), `candidates` (their volumes), `probabilities` and `significance` or `permutation`
(what they are worth) to `growth`, the loop of Algorithm 4.1.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
