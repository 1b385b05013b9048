from .apr import APRClassifier
from .bag_margin_svm import BagMarginSVMClassifier
from .diverse_density import DiverseDensityClassifier
from .em_dd import EMDDClassifier
from .instance_margin_svm import InstanceMarginSVMClassifier
from .miles import MILESClassifier
from .optimal_ball import OptimalBallClassifier
from .single_instance_svm import SingleInstanceSVMClassifier
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
