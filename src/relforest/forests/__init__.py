"""Forests, boosting and rule sets: sums of small trees whose questions are conditions on whole scenes.

A condition says that some objects exist of which several statements are true. Start with `Condition`, then
`SMRFBoostingClassifier`; `Ensemble` is what all estimators learn.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
