from . import baselines
from .rpi import SMRFRPI, Evaluation
from .settings import LSPISettings, RPISettings
from .value import ValueFunction

__all__ = ["SMRFRPI", "Evaluation", "LSPISettings", "RPISettings", "ValueFunction", "baselines"]
