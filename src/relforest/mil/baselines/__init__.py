"""Published multiple-instance classifiers to compare with.

All accept bags and labels in the same forms as `relforest.mil.CovAggClassifier`, and set `classes_`,
`n_features_in_` and `feature_names_in_` as it does. `OptimalBallClassifier`, `APRClassifier`,
`DiverseDensityClassifier` and `EMDDClassifier` describe a region that contains positive instances: a ball, a
box, or an axis-parallel ellipsoid. The others are support vector machines:
`BagMarginSVMClassifier` (MI-SVM) and `InstanceMarginSVMClassifier` (mi-SVM) also label instances,
`MILESClassifier` labels only bags, and `SingleInstanceSVMClassifier` is the baseline that ignores bags;
`tuned` chooses their parameters by cross-validation. MI-SVM and mi-SVM are named after the margin they
maximise, since their published names differ only in capitals. Start with `OptimalBallClassifier`, which is
fast and needs no tuning.

Classifiers can be trained in several threads at once; the results are the same as one after another.

Examples
--------
>>> import numpy as np
>>> from relforest.mil import baselines
>>> rng = np.random.default_rng(0)
>>> bags = rng.uniform(-9, 9, size=(40, 3, 2))
>>> bags[:20, 0] = rng.normal([3, 3], 0.3, size=(20, 2))
>>> for name in [each for each in baselines.__all__ if each.endswith("Classifier")]:
...     model = getattr(baselines, name)().fit(bags, [1] * 20 + [0] * 20)
...     print(name, model.predict(bags[[0, 30]]))
APRClassifier [1 0]
BagMarginSVMClassifier [1 0]
DiverseDensityClassifier [1 0]
EMDDClassifier [1 0]
InstanceMarginSVMClassifier [1 0]
MILESClassifier [1 0]
OptimalBallClassifier [1 0]
SingleInstanceSVMClassifier [1 0]
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
