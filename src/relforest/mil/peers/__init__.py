"""Published multiple-instance classifiers to compare with.

All take bags and labels as `relforest.mil.CovAggClassifier` does. `OptimalBallClassifier`, `APRClassifier`,
`DiverseDensityClassifier` and `EMDDClassifier` describe one region of the space in which a positive instance
lies: a ball, a box, and two ellipsoids along the axes. The others are support vector machines:
`BagMarginSVMClassifier` (MI-SVM) and `InstanceMarginSVMClassifier` (mi-SVM) label instances too,
`MILESClassifier` labels bags only, and `SingleInstanceSVMClassifier` is the baseline that ignores the bags;
`tuned` chooses their parameters by cross-validation. MI-SVM and mi-SVM are called by the margin that they
maximise, as their published names differ in nothing but capitals. Start with `OptimalBallClassifier`, which
is fast and has nothing to tune.

Train support vector machines at the same time in several processes, not threads: their solvers' warning that
they did not converge is held back meanwhile, which `converged_` says, and Python's filters of warnings belong
to all threads.
"""

from __future__ import annotations

from relforest.mil.peers.apr import APRClassifier
from relforest.mil.peers.bag_margin_svm import BagMarginSVMClassifier
from relforest.mil.peers.diverse_density import DiverseDensityClassifier
from relforest.mil.peers.em_dd import EMDDClassifier
from relforest.mil.peers.instance_margin_svm import InstanceMarginSVMClassifier
from relforest.mil.peers.miles import MILESClassifier
from relforest.mil.peers.optimal_ball import OptimalBallClassifier
from relforest.mil.peers.single_instance_svm import SingleInstanceSVMClassifier
from relforest.mil.peers.tuning import svm_grid, tuned

__all__ = [
    "APRClassifier",
    "BagMarginSVMClassifier",
    "DiverseDensityClassifier",
    "EMDDClassifier",
    "InstanceMarginSVMClassifier",
    "MILESClassifier",
    "OptimalBallClassifier",
    "SingleInstanceSVMClassifier",
    "svm_grid",
    "tuned",
]
