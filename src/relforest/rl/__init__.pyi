from . import baselines
from .practice import Practice
from .refinement import BeamSearch
from .rpi import SMRFRPI, Evaluation
from .settings import LSPISettings, RPISettings
from .value import ValueFunction

__all__ = [
    "SMRFRPI",
    "BeamSearch",
    "Evaluation",
    "LSPISettings",
    "Practice",
    "RPISettings",
    "ValueFunction",
    "baselines",
]
