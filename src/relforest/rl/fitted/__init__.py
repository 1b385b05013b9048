"""Fitted Q iteration on relational features: the learner ``smrf-q``.

Where a task does not limit the number of actions, Q is the mean of a sum of curves of relational distances
(`relforest.rl.fitted.additive`) and of trees that compare them (`relforest.rl.fitted.voting`); where it does,
a forest for each number of actions that remain (`relforest.rl.fitted.horizon`). Both see objects through
`relforest.rl.fitted.view`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
