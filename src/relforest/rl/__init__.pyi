from . import peers
from .rpi import SMRFRPI, Evaluation
from .settings import LSPISettings, RPISettings
from .value import ValueFunction

__all__ = ["SMRFRPI", "Evaluation", "LSPISettings", "RPISettings", "ValueFunction", "peers"]
