"""Published multiple-instance classifiers to compare with.

All take bags and labels as `relforest.mil.CovAggClassifier` does. `OptimalBallClassifier`, `APRClassifier`,
`DiverseDensityClassifier` and `EMDDClassifier` describe one region of the space in which a positive instance
lies: a ball, a box, and two ellipsoids along the axes. The others are support vector machines:
`BagMarginSVMClassifier` (MI-SVM) and `InstanceMarginSVMClassifier` (mi-SVM) label instances too,
`MILESClassifier` labels bags only, and `SingleInstanceSVMClassifier` is the baseline that ignores the bags;
`tuned` chooses their parameters by cross-validation. MI-SVM and mi-SVM are named for the margin that they
maximise, since their published names differ only in case. Start with `OptimalBallClassifier`, which is fast
and needs no tuning.

Any number of them may be trained at the same time in threads, with the same results as one after the other.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
