from .apr import APRClassifier
from .diverse_density import DiverseDensityClassifier
from .em_dd import EMDDClassifier
from .kernel_classifier import SingleInstanceSVMClassifier
from .margin_svms import BagMarginSVMClassifier, InstanceMarginSVMClassifier
from .miles import MILESClassifier
from .optimal_ball import OptimalBallClassifier
from .tuning import svm_grid, tuned

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
