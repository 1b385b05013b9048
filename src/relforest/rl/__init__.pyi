from . import peers
from .lspi import LSPISettings
from .rpi import SMRFRPI, Evaluation
from .settings import RPISettings
from .value import ValueFunction

__all__ = ["SMRFRPI", "Evaluation", "LSPISettings", "RPISettings", "ValueFunction", "peers"]
