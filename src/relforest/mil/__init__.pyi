from . import baselines
from .covagg import CovAggClassifier
from .scaling import BagScaler
from .volume_committee import VolumeCommitteeClassifier

__all__ = ["BagScaler", "CovAggClassifier", "VolumeCommitteeClassifier", "baselines"]
